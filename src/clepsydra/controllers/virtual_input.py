"""A virtual input: the PI controller of one output of a linearised process, and its windup."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import AntiWindup, next_in_force, winds_up
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.program.step_law import Symbols

VirtualAntiWindup = Literal["variable_structure"] | AntiWindup
#: In which quantity α acts: in ν itself, or in the input of the process.
AlphaOn = Literal["virtual", "input"]

ANTI_WINDUPS: tuple[str, ...] = ("variable_structure", *get_args(AntiWindup))

_GAIN = signals.signed("virtual_gain", "{rate}", "Kp of {measurement}", 1.0)
_INTEGRAL_GAIN = signals.amount("virtual_integral_gain", "{rate}", "Ki of {measurement}", 1.0)
_SHARE = "share of the setpoint of {measurement} in the proportional part"
_WEIGHT = Key("setpoint_weight", "1", _SHARE, 0.0, 1.0, 1.0)
_DIES_AWAY = "α: rate at which an excess over what {moved} can do dies away"
_RATE = signals.amount("saturation_rate", "1/s", _DIES_AWAY, 1.0)
_PER_UNIT = f"{_DIES_AWAY}, per unit of {{moved}}"
_FEEDBACK = signals.amount("saturation_feedback", "{quantity}/({moved} s)", _PER_UNIT, 1.0)
_WAS_IN_FORCE = Key(
    "was_in_force", "1", "{moved} was in automatic in the last sample", 0.0, 1.0, kind="boolean"
)
_SMALLEST_EFFECT = signals.signed(
    "smallest_effect", "{quantity}/{moved}",
    "smallest effect of {moved} on {measurement} that is divided by", 1.0,
)  # fmt: skip


def rate_unit(unit: str, order: int) -> str:
    """Return the unit of a derivative."""
    return f"{unit}/s" if order == 1 else f"{unit}/s^{order}"


@dataclass(frozen=True)
class VirtualInput:
    """ν = Kp (b r − y) + I − Σ m_k dᵏy/dtᵏ, I′ = Ki (r − y): what d^r y/dt^r shall be.

    `measurement`: y; `degree`: r; there are r − 1 damping terms; `alpha_on`: for variable
    structure; `moved`: the input that it is paired with.
    """

    measurement: Signal
    degree: int
    anti_windup: str
    alpha_on: str
    moved: Signal

    @property
    def quantity(self) -> Signal:
        """What has the units of ν."""
        y = self.measurement
        return signals.of_units(*(rate_unit(unit, self.degree) for unit in (y.unit, y.shown_unit)))

    @property
    def _adjusted(self) -> list[Signal]:
        """Kp, b and m_k, of which a change makes no bump."""
        y, degree = self.measurement, self.degree
        damping = enumerate(elements(path(y, "virtual_damping"), degree - 1), start=1)
        gain = _GAIN.of(y, measurement=y, rate=Signal("", rate_unit("1", degree)))
        found = [*signals.growing([gain], degree), _WEIGHT.of(y, measurement=y)]
        for k, name in damping:
            order = degree - k
            term = signals.gain(name, rate_unit("1", order), 0.0, f"m_{k} of {y.name}")
            found += signals.growing([term], order)
        return found

    def parameters(self) -> list[Signal]:
        """Return gains, setpoint weight, damping, and what windup and the solution need."""
        y, (gain, *adjusted) = self.measurement, self._adjusted
        rate = Signal("", rate_unit("1", self.degree + 1))
        smallest = _SMALLEST_EFFECT.of(y, measurement=y, moved=self.moved, quantity=self.quantity)
        integral = _INTEGRAL_GAIN.of(y, measurement=y, rate=rate)
        # Poles that are all faster by a factor: each term grows by a power of its own.
        found = [gain, *signals.growing([integral], self.degree + 1), *adjusted, smallest]
        if self.anti_windup == "back_calculation":
            found.append(signals.TRACKING_TIME.of(y))
        if self.anti_windup == "variable_structure":
            alpha = _RATE if self.alpha_on == "virtual" else _FEEDBACK
            found.append(alpha.of(y, moved=self.moved, quantity=self.quantity))
        return found

    def asked(
        self, sample: Sample, setpoint: ca.SX, derivatives: list[ca.SX], standing: ca.SX
    ) -> tuple[ca.SX, ca.SX]:
        """Return Kp (b r − y) − Σ m_k dᵏy/dtᵏ, and the integral that makes no bump with it.

        `derivatives`: y, dy/dt, …, of the r degrees below r; `standing`: L + E u with the inputs of
        the last sample: where automatic takes over.
        """
        y, words = self.measurement, f"integral part of what {self.measurement.name} shall do"
        sample.parameters(*self.parameters())
        integral, in_force, *last = sample.memory(
            Signal(path(y, "virtual_integral"), self.quantity.unit, description=words),
            _WAS_IN_FORCE.of(y, moved=self.moved),
            *(replace(each, name=_last(each.name)) for each in self._adjusted),
        )
        now, former = (
            _nonintegral(gains, setpoint, derivatives)
            for gains in (sample.parameters(*self._adjusted), last)
        )
        return now, ca.if_else(in_force, integral + (former - now), standing - now)

    def integrate(self, sample: Sample, told: Symbols) -> None:
        """Write the state of the next sample.

        `told`: as for `next_in_force`: integral_used and proportional, the two parts of ν as asked;
        low_limit and high_limit, L + E u with its own input at the limits that make it lowest and
        highest, middle with all of them half-way, and cut; time_step. Also error, r − y; applied, L
        + E u with the inputs that were applied; in_force, whether its own input is in automatic;
        and input_excess, what was asked of that above what was applied.
        """
        y = self.measurement
        kept, gain = sample.of(y, "virtual_integral", "virtual_integral_gain")
        own = {signal.part: sample[signal.name] for signal in self.parameters()}
        increment = told["time_step"] * gain * told["error"]
        following = self._in_force({**own, **told, "increment": increment})
        # An increment beyond the range of numbers is not taken.
        safe = ca.if_else(is_number(following), following, told["integral_used"])
        usable = ca.logic_and(told["in_force"], is_number(safe))
        sample.next_state[path(y, "virtual_integral")] = ca.if_else(usable, safe, kept)
        sample.next_state[path(y, "was_in_force")] = usable
        for name in (signal.name for signal in self._adjusted):
            value, last = sample[name], sample[_last(name)]
            sample.next_state[_last(name)] = ca.if_else(is_number(value), value, last)

    def _in_force(self, s: Symbols) -> ca.SX:
        integral, increment, cut = s["integral_used"], s["increment"], s["cut"]
        virtual = s["proportional"] + integral
        limited = ca.if_else(cut, s["applied"], virtual)
        if self.anti_windup != "variable_structure" or self.alpha_on == "virtual":
            return next_in_force(self.anti_windup, s, limited)
        # α takes back in proportion to the excess of the input, but never more than there is.
        excess = virtual - limited
        size = ca.fabs(s["saturation_feedback"] * s["input_excess"])
        taken = ca.fmin(size * s["time_step"], ca.fabs(excess))
        back = ca.if_else(excess < 0, -taken, taken)
        winds = winds_up(increment, virtual, cut, s["middle"])
        return ca.if_else(winds, integral - back, integral + increment)


def _nonintegral(gains: list[ca.SX], setpoint: ca.SX, derivatives: list[ca.SX]) -> ca.SX:
    gain, weight, *damping = gains
    value = gain * (weight * setpoint - derivatives[0])
    for share, derivative in zip(damping, derivatives[1:], strict=True):
        value = value - share * derivative
    return value


def _last(parameter: str) -> str:
    """Return the name of the state that remembers a parameter."""
    found = Signal(parameter)
    return path(found.owner, f"last_{found.part}")
