"""A virtual input: the PI controller of one output of a linearised process, and its windup."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import (
    AntiWindup,
    back_calculation,
    clamping,
    conditional_integration,
    tracking_share,
)
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.blocks.variable_structure import (
    share_of_excess,
    variable_structure,
    winds_up,
)
from clepsydra.program.step_law import Symbols

VirtualAntiWindup = Literal["variable_structure"] | AntiWindup
#: In which quantity α acts: in ν itself, or in the input of the process.
AlphaOn = Literal["virtual", "input"]

ANTI_WINDUPS: tuple[str, ...] = ("variable_structure", *get_args(AntiWindup))


def check_virtual_anti_windup(anti_windup: str, alpha_on: str) -> None:
    """Refuse names that stand for nothing.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_virtual_anti_windup("variable_structure", "volts")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: alpha_on: got 'volts', expected one of virtual, input; \
correct the name.
    """
    for place, name, known in (
        ("anti_windup", anti_windup, ANTI_WINDUPS),
        ("alpha_on", alpha_on, get_args(AlphaOn)),
    ):
        if name not in known:
            raise InputError(place, name, f"one of {', '.join(known)}", "correct the name")


def rate_unit(unit: str, order: int) -> str:
    """Return the unit of a derivative.

    Examples
    --------
    >>> rate_unit("V", 1), rate_unit("m", 3), rate_unit("1", 2)
    ('V/s', 'm/s^3', '1/s^2')
    """
    return f"{unit}/s" if order == 1 else f"{unit}/s^{order}"


@dataclass(frozen=True)
class Applied:
    """What became of a virtual input, as expressions.

    Parameters
    ----------
    virtual : casadi.SX
        L + E u with the inputs that were applied; the virtual input itself where all were.
    cut : casadi.SX
        Whether an input that it acts through was not applied as asked, or stands at a limit.
    middle, low, high : casadi.SX
        L + E u with the inputs half-way between their limits, and with its own input at the
        limits that make it lowest and highest.
    input_excess : casadi.SX
        What was asked of its own input above what was applied [input unit].
    in_force : casadi.SX
        Whether its own input is in automatic.

    Examples
    --------
    >>> numbers = [ca.DM(value) for value in (0.1, 1, 0.05, 0.0, 0.1, 2.0, 1)]
    >>> float(Applied(*numbers).high)
    0.1
    """

    virtual: ca.SX
    cut: ca.SX
    middle: ca.SX
    low: ca.SX
    high: ca.SX
    input_excess: ca.SX
    in_force: ca.SX


@dataclass(frozen=True)
class VirtualInput:
    """ν = Kp (b r − y) + I − Σ m_k dᵏy/dtᵏ, I′ = Ki (r − y): what d^r y/dt^r shall be.

    Parameters
    ----------
    measurement : Signal
        y
    degree : int
        r; there are r − 1 damping terms.
    anti_windup : str
    alpha_on : {"virtual", "input"}
        For variable structure.
    moved : Signal
        The input that it is paired with.

    Examples
    --------
    >>> level, pump = Signal("level", "V"), Signal("pump", "V")
    >>> found = VirtualInput(level, 2, "variable_structure", "virtual", pump)
    >>> [parameter.name for parameter in found.parameters()]
    ['level.virtual_gain', 'level.virtual_integral_gain', 'level.setpoint_weight', \
'level.virtual_damping.1', 'level.saturation_rate']
    """

    measurement: Signal
    degree: int
    anti_windup: str
    alpha_on: str
    moved: Signal

    def _named(self, what: str) -> str:
        return path(self.measurement, what)

    @property
    def _damping(self) -> list[str]:
        return elements(self._named("virtual_damping"), self.degree - 1)

    @property
    def quantity(self) -> Signal:
        """What has the units of ν."""
        y = self.measurement
        return signals.of_units(*(rate_unit(unit, self.degree) for unit in (y.unit, y.shown_unit)))

    def parameters(self) -> list[Signal]:
        """Return gains, setpoint weight, damping and what the anti-windup needs."""
        of, name = f"of {self.measurement.name}", self._named
        found = [
            signals.gain(name("virtual_gain"), rate_unit("1", self.degree), 1.0, f"Kp {of}"),
            Signal(
                name("virtual_integral_gain"),
                rate_unit("1", self.degree + 1),
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=1.0,
                description=f"Ki {of}",
            ),
            Signal(
                name("setpoint_weight"),
                low=0.0,
                high=1.0,
                initial=1.0,
                description=f"share of the setpoint {of} in the proportional part",
            ),
        ]
        for k, damping in enumerate(self._damping, start=1):
            unit = rate_unit("1", self.degree - k)
            found.append(signals.gain(damping, unit, 0.0, f"m_{k} {of}"))
        if self.anti_windup == "back_calculation":
            found.append(signals.tracking_time(self.measurement))
        if self.anti_windup == "variable_structure":
            found.append(self._alpha())
        return found

    def _alpha(self) -> Signal:
        words = f"α: rate at which an excess over what {self.moved.name} can do dies away"
        if self.alpha_on == "virtual":
            return Signal(
                self._named("saturation_rate"),
                "1/s",
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=1.0,
                description=words,
            )
        unit, name = signals.per(self.quantity, self.moved, "s"), self._named("saturation_feedback")
        words += f", per unit of {self.moved.name}"
        return replace(signals.gain(name, unit, 1.0, words), low=0.0)

    @property
    def _remembered(self) -> list[str]:
        return [self._named("virtual_gain"), self._named("setpoint_weight"), *self._damping]

    def state(self) -> list[Signal]:
        """Return the integral, whether it was in force, and the gains of the last sample."""
        known = {parameter.name: parameter for parameter in self.parameters()}
        return [
            Signal(
                self._named("virtual_integral"),
                self.quantity.unit,
                description=f"integral part of what {self.measurement.name} shall do",
            ),
            Signal(
                self._named("was_in_force"),
                low=0.0,
                high=1.0,
                initial=0.0,
                kind="boolean",
                description=f"{self.moved.name} was in automatic in the last sample",
            ),
            *(signals.like_parameter(known[name], _last(name)) for name in self._remembered),
        ]

    def nonintegral(
        self, symbols: Symbols, setpoint: ca.SX, derivatives: list[ca.SX], *, former: bool = False
    ) -> ca.SX:
        """Return Kp (b r − y) − Σ m_k dᵏy/dtᵏ, with the gains of the last sample if `former`.

        Parameters
        ----------
        symbols : mapping
        setpoint : casadi.SX
        derivatives : list of casadi.SX [r]
            y, dy/dt, …, of the degrees below r.
        former : bool
        """
        gain, weight, *damping = (
            symbols[_last(name) if former else name] for name in self._remembered
        )
        value = gain * (weight * setpoint - derivatives[0])
        for share, derivative in zip(damping, derivatives[1:], strict=True):
            value = value - share * derivative
        return value

    def integral(self, symbols: Symbols, now: ca.SX, former: ca.SX, standing: ca.SX) -> ca.SX:
        """Return the integral with which this sample goes on without a bump.

        Parameters
        ----------
        symbols : mapping
        now, former : casadi.SX
            What does not come from it, with the gains of this sample and of the last.
        standing : casadi.SX
            L + E u with the inputs of the last sample: where automatic takes over.
        """
        taken_up = symbols[self._named("virtual_integral")] + (former - now)
        return ca.if_else(symbols[self._named("was_in_force")], taken_up, standing - now)

    def next_state(
        self,
        symbols: Symbols,
        integral: ca.SX,
        increment: ca.SX,
        virtual: ca.SX,
        applied: Applied,
        time_step: ca.SX,
    ) -> dict[str, ca.SX]:
        """Return the state of the next sample.

        Parameters
        ----------
        symbols : mapping
        integral, increment : casadi.SX
            As used in this sample, and what it gains by the error.
        virtual : casadi.SX
            ν as asked.
        applied : Applied
        time_step : casadi.SX
            Above zero [s].
        """
        name = self._named
        limited = ca.if_else(applied.cut, applied.virtual, virtual)
        following = self._under_anti_windup(
            symbols, integral, increment, virtual, limited, applied, time_step
        )
        kept = symbols[name("virtual_integral")]
        # An increment beyond the range of numbers is not taken.
        safe = ca.if_else(is_number(following), following, integral)
        usable = ca.logic_and(applied.in_force, is_number(safe))
        state = {
            name("virtual_integral"): ca.if_else(usable, safe, kept),
            name("was_in_force"): usable,
        }
        for parameter in self._remembered:
            value, last = symbols[parameter], symbols[_last(parameter)]
            state[_last(parameter)] = ca.if_else(is_number(value), value, last)
        return state

    def _under_anti_windup(
        self,
        symbols: Symbols,
        integral: ca.SX,
        increment: ca.SX,
        virtual: ca.SX,
        limited: ca.SX,
        applied: Applied,
        time_step: ca.SX,
    ) -> ca.SX:
        asked = integral, increment, virtual, limited
        if self.anti_windup == "none":
            return integral + increment
        if self.anti_windup == "clamping":
            # The integral alone shall not ask for more than the input can do.
            return clamping(integral, increment, applied.low, applied.high)
        if self.anti_windup == "conditional_integration":
            return conditional_integration(*asked)
        if self.anti_windup == "back_calculation":
            share = tracking_share(time_step, symbols[self._named("tracking_time")])
            return back_calculation(*asked, share)
        if self.alpha_on == "virtual":
            share = share_of_excess(symbols[self._named("saturation_rate")], time_step)
            return variable_structure(*asked, applied.cut, applied.middle, share)
        # α takes back in proportion to the excess of the input, but never more than there is.
        excess = virtual - limited
        size = ca.fabs(symbols[self._named("saturation_feedback")] * applied.input_excess)
        taken = ca.fmin(size * time_step, ca.fabs(excess))
        back = ca.if_else(excess < 0, -taken, taken)
        winds = winds_up(increment, virtual, applied.cut, applied.middle)
        return ca.if_else(winds, integral - back, integral + increment)


def _last(parameter: str) -> str:
    """Return the name of the state that remembers a parameter."""
    found = Signal(parameter)
    return path(found.owner, f"last_{found.part}")
