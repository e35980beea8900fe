"""Feedforward: terms of other signals added to what a loop asks for; decoupling too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.lead_lag import lead_lag
from clepsydra.controllers.blocks.validity import is_number, is_time_step, value_or_zero
from clepsydra.controllers.structure.block import Closed, Opened
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class FeedforwardTerm:
    """One signal that acts on a loop's output: gain (1 + lead s)/(1 + lag s) (x − x°).

    Parameters
    ----------
    label : str
        Last part of the names of its parameters: "1", or "1_2" for output 1 from output 2.
    signal : Signal
        The process signal.
    taken_from : str
        Where the law has it: "measurement_3", or "last_output_2" for decoupling.
    dynamic : bool
        Whether it has a lead and a lag; else it acts at once.

    Examples
    --------
    >>> term = FeedforwardTerm("1", Signal("inflow_meter", "l/s"), "measurement_2", False)
    >>> [parameter.name for parameter in term.parameters(Signal("pump", "%"))]
    ['feedforward_gain_1', 'feedforward_reference_1']
    """

    label: str
    signal: Signal
    taken_from: str
    dynamic: bool

    def parameters(self, moved: Signal) -> list[Signal]:
        """Gain and reference; lead and lag where dynamic."""
        name, unit = self.signal.name, signals.ratio_of_units(moved.unit, self.signal.unit)
        found = [
            signals.gain(
                f"feedforward_gain_{self.label}", unit, 0.0, f"gain from {name} to {moved.name}"
            ),
            signals.gain(
                f"feedforward_reference_{self.label}",
                self.signal.unit,
                self.signal.initial,
                f"{name} at which it adds nothing",
            ),
        ]
        if self.dynamic:
            found += [
                Signal(
                    f"feedforward_{what}_{self.label}",
                    "s",
                    low=0.0,
                    high=signals.LARGEST_PARAMETER,
                    description=f"{what} time from {name} to {moved.name}",
                )
                for what in ("lead", "lag")
            ]
        return found

    def state(self) -> list[Signal]:
        """The signal it went to at last, lagged where dynamic."""
        return [Signal(f"lagged_signal_{self.label}", self.signal.unit)]


@dataclass(frozen=True)
class FeedforwardBlock:
    """A sum: what a loop asks for, and feedforward from other signals.

    With the last outputs of the other loops as signals it is inverted decoupling. A signal that
    fails leaves its term where it went to at last, and the loop goes on.

    Parameters
    ----------
    name : str
    source : str
        The loop's port.
    moved : Signal
        What the sum moves: an output, or another loop's setpoint.
    terms : tuple of FeedforwardTerm

    References
    ----------
    H. L. Wade, Inverted decoupling: a neglected technique, ISA Transactions 36(1), 1997, 3-10.

    Examples
    --------
    >>> FeedforwardBlock("sum", "level", Signal("pump", "%"), ()).sources
    ('level',)
    """

    name: str
    source: str
    moved: Signal
    terms: tuple[FeedforwardTerm, ...]

    @property
    def sources(self) -> tuple[str, ...]:
        """The loop."""
        return (self.source,)

    @property
    def ports(self) -> tuple[str, ...]:
        """The sum."""
        return (self.name,)

    def parameters(self) -> list[Signal]:
        """Those of all terms."""
        return [parameter for term in self.terms for parameter in term.parameters(self.moved)]

    def state(self) -> list[Signal]:
        """Those of all terms."""
        return [state for term in self.terms for state in term.state()]

    def inputs(self) -> list[Signal]:
        """None."""
        return []

    def outputs(self) -> list[Signal]:
        """None."""
        return []

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those after it: they bound the loop's part loosely."""
        return (after[0],)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Add the terms."""
        (source,) = asked
        added, following = ca.SX(0), {}
        sensors = source.sensors
        time_step_good = is_time_step(symbols["time_step"])
        for term in self.terms:
            raw = symbols[term.taken_from]
            good = is_number(raw)
            if term.taken_from.startswith("measurement_"):
                sound = symbols[term.taken_from.replace("measurement", "sensor")]
                good = ca.logic_and(good, sound)
                sensors = ca.logic_and(sensors, sound)
            deviation = value_or_zero(raw, good) - symbols[f"feedforward_reference_{term.label}"]
            good = ca.logic_and(good, is_number(deviation))
            gain = symbols[f"feedforward_gain_{term.label}"]
            lagged = symbols[f"lagged_signal_{term.label}"]
            if not term.dynamic:
                following[f"lagged_signal_{term.label}"] = ca.if_else(good, deviation, lagged)
                added = added + gain * ca.if_else(good, deviation, lagged)
                continue
            filtered = lead_lag(
                ca.if_else(good, deviation, lagged),
                lagged,
                symbols[f"feedforward_lead_{term.label}"],
                symbols[f"feedforward_lag_{term.label}"],
                ca.if_else(time_step_good, symbols["time_step"], 1),
            )
            kept = ca.logic_and(time_step_good, is_number(filtered.lagged))
            following[f"lagged_signal_{term.label}"] = ca.if_else(kept, filtered.lagged, lagged)
            added = added + gain * filtered.value
        value = source.value + added

        def close(applied: Sequence[Applied]) -> Closed:
            (result,) = applied
            # What was applied as asked is told to the last bit: no rounding looks like a limit.
            got = ca.if_else(result.value == value, source.value, result.value - added)
            told = Applied(got, result.in_force, result.follows)
            return Closed(following, {}, (told,))

        return Opened((Asked(value, source.usable, source.numbers, sensors),), close)
