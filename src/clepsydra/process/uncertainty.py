"""What is said of how uncertain the parameters of a plant are, whatever their values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.process.distribution import (
    Distribution,
    LogNormal,
    Measured,
    Normal,
    Scaled,
    Uniform,
    span_words,
)
from clepsydra.process.equations import Equations
from clepsydra.process.signal_values import beyond_range
from clepsydra.process.spread import Correlated, Spread

Shape = Literal["uniform", "normal", "log-normal", "values", "same as"]
#: By how much what is not named varies, as a share of its value.
SHARE = 0.1
#: How much of a distribution with tails may lie where its parameter cannot be.
_TAIL = 1e-3
#: What a bound may be missed by in rounding, as a share of it.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Rule:
    """How a parameter is distributed about its value.

    Parameters
    ----------
    shape : {"uniform", "normal", "log-normal", "values", "same as"}
    share : float or None
        How far a uniform distribution reaches from the value, or the standard deviation of a
        normal one, as a share of the value; that of the logarithm of a log-normal one.
    deviation : float or None
        The same in the unit of the parameter [SI].
    values : tuple of float
        The ends of a uniform distribution, or measured values [SI].
    weights : tuple of float
        Of measured values; none where all have the same.
    other : str
        Whose unit numbers it takes, with the same share of its own value.
    shared : bool
        It is said of several parameters at once: those whose value is 0 stay there.
    clipped : bool
        It is said of all that is not named: what cannot be is left out in silence.
    written, place : object and str
        As the user has it, and where, for a message.
    """

    shape: Shape = "uniform"
    share: float | None = None
    deviation: float | None = None
    values: tuple[float, ...] = ()
    weights: tuple[float, ...] = ()
    other: str = ""
    shared: bool = False
    clipped: bool = False
    written: object = field(default="", compare=False)
    place: str = field(default="uncertainty", compare=False)

    def about(self, signal: Signal) -> Distribution | None:
        """Return the distribution of a parameter; None where it stands at its value.

        Raises
        ------
        InputError
            It is a share of 0, or leads to where the parameter cannot be.
        """
        if self.share == 0.0 or (self.share and not signal.initial and self.shared):
            return None
        if self.share and not signal.initial:
            expected = f"no share of the value of {signal.name}, which is 0"
            raise InputError(self.place, self.written, expected, _ends_of(signal))
        return self.within(self._whole(signal), signal)

    def within(self, found: Distribution, signal: Signal) -> Distribution:
        """Return a distribution within the range of its parameter, or refuse it."""
        low, high = signal.low, signal.high
        if not self.clipped:
            self._check(found, signal)
        return found.truncated(low, high)

    def _check(self, found: Distribution, signal: Signal) -> None:
        slack = _ROUNDING * abs(signal.initial)
        outside = found.outside(signal.low - slack, signal.high + slack)
        if found.has_tails:
            if outside > _TAIL:
                span = span_words(signal, signal.low, signal.high)
                expected = f"at most 0.1 % outside of {span}, the range of {signal.name}, where "
                expected += f"it is {100.0 * outside:.2g} %"
                remedy = "make the deviation smaller"
                if self.shape == "normal" and signal.initial > 0.0 and found.below(0.0) > _TAIL:
                    remedy += ', or write distribution = "log-normal"'
                raise InputError(self.place, self.written, expected, remedy)
            return
        for end in found.ends:
            beyond = beyond_range(signal, end, "values")
            if beyond is not None and not signal.low - slack <= end <= signal.high + slack:
                value = f"{self.written}, which leads to {beyond[0]}"
                raise InputError(self.place, value, beyond[1], "stay inside the range")

    def _whole(self, signal: Signal) -> Distribution:
        if self.shape == "values":
            return Measured.of(self.values, self.weights)
        if self.values:
            return Uniform(*self.values)
        value = signal.initial
        if self.shape == "log-normal":
            return LogNormal(value, self.share or 0.0)
        size = self.deviation or abs(value) * (self.share or 0.0)
        return (
            Normal(value, size) if self.shape == "normal" else Uniform(value - size, value + size)
        )


_DEFAULT = Rule(share=SHARE, shared=True, clipped=True)


@dataclass(frozen=True)
class Uncertainty:
    """How the parameters of a plant are distributed about their values, whatever these are.

    Parameters
    ----------
    default : Rule
        Of every parameter of an element that is not named.
    named : mapping
        Parameter, "tank_1.area", or disturbance to its rule.
    correlated : tuple of Correlated

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> process.uncertainty == Uncertainty()
    True
    >>> process.uncertainty.about(process).words("splitter_1.tank_1")
    'uniform within 10 %, 0.63 to 0.77'
    """

    default: Rule = _DEFAULT
    named: Mapping[str, Rule] = field(default_factory=dict)
    correlated: tuple[Correlated, ...] = ()

    def about(self, plant: Equations) -> Spread:
        """Return how the parameters of a plant vary about the values that it has.

        What belongs to no element, gravity, and disturbances vary where they are named only.

        Raises
        ------
        InputError
            A distribution leads to where its parameter cannot be.
        """
        signals = {each.name: each for each in (*plant.parameters, *plant.disturbances)}
        own = dict(self._own(plant))
        found = {}
        for name, signal in signals.items():
            distribution = self._distribution(signal, signals, own)
            if distribution is not None:
                found[name] = distribution
        return Spread(
            signals={name: signals[name] for name in found},
            distributions=found,
            followed={name: self._stream(name) for name in found if self._other(name)},
            correlated=tuple(
                kept
                for kept in (each.among(frozenset(found)) for each in self.correlated)
                if len(kept.parameters) > 1
            ),
        )

    def _own(self, plant: Equations) -> Iterator[tuple[str, Rule]]:
        for signal in plant.parameters:
            if signal.owner:
                yield signal.name, self.default
        yield from self.named.items()

    def _distribution(
        self, signal: Signal, signals: Mapping[str, Signal], rules: Mapping[str, Rule]
    ) -> Distribution | None:
        rule = rules.get(signal.name)
        if rule is None:
            return None
        if not rule.other:
            return rule.about(signal)
        source = signals[rule.other]
        distribution = self._distribution(source, signals, rules)
        if distribution is None:
            expected = "a parameter that varies"
            raise InputError(rule.place, rule.other, expected, f"say how {rule.other} varies")
        for each in (source, signal):
            if not each.initial:
                expected = f"no share of the value of {each.name}, which is 0"
                raise InputError(rule.place, rule.other, expected, _ends_of(signal))
        scaled = Scaled(rule.other, distribution, source.initial, signal.initial)
        return rule.within(scaled, signal)

    def _other(self, name: str) -> str:
        return self.named[name].other if name in self.named else ""

    def _stream(self, name: str) -> str:
        """Return whose unit numbers a parameter takes, however many lie between."""
        while other := self._other(name):
            name = other
        return name


def _ends_of(signal: Signal) -> str:
    unit = "" if signal.shown_unit == "1" else f" {signal.shown_unit}"
    return f'give its ends, as in {{ from = "0{unit}", to = "1{unit}" }}'
