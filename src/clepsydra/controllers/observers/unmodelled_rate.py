"""What a model does not say of an output: its rate beside the predicted one, by an observer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import all_of, is_number, time_step_of
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_TIME = signals.amount(
    "observer_time", "s", "time of the observer of {measurement}",
    1.0, low=signals.SHORTEST_TIME,
)  # fmt: skip
_EXPECTED = Key("expected", "{measurement}", "{measurement} as expected")
_RATE = Key("unmodelled_rate", "{measurement}/s", "rate of {measurement} that its model lacks")


def _corrected(s: Symbols) -> Equations:
    time, _ = time_step_of(s)
    share = time / (ca.fmax(s["observer_time"], 0) + time)
    expected = ca.if_else(s["lost"], s["measured"], s["expected"])
    surprise = ca.if_else(s["known"], s["measured"] - expected, 0)
    pole = 1 - share
    return Equations(
        {},
        {
            "corrected": expected + (1 - pole * pole) * surprise,
            "rate": s["unmodelled_rate"] + share * (share / time) * surprise,
        },
        {"pole": pole, "surprise": surprise},
    )


_CORRECTION = Block(
    "unmodelled_rate_correction",
    (
        Signal("expected", description="the output as expected"),
        Signal("unmodelled_rate", description="rate that the model lacks, as it was, per second"),
        Signal("measured", description="the output as measured"),
        truth("known", "the measurements are numbers from sound sensors"),
        truth("lost", "they were not in the last sample"),
        Signal("observer_time", "s", description="time in which the observer follows"),
        Signal("time_step", "s", description="time since the last sample"),
    ),
    (),
    (
        Signal("corrected", description="the output with the measurement of the sample"),
        Signal("rate", description="rate that the model lacks, per second"),
    ),
    _corrected,
    ("Both poles of the observer lie at T/(T + time step); T is the observer's time.",),
)


@dataclass(frozen=True)
class UnmodelledRate:
    """An observer of a measured output y and of the rate d that its model lacks.

    With p = T/(T + Δt) and the surprise e = y − ŷ of a sample::

        ŷc = ŷ + (1 − p²) e,    d⁺ = d + (1 − p)²/Δt e,    ŷ⁺ = ŷc + Δt d⁺ + Δy,

    where Δy is what the model says of the sample. Both poles of the observer lie at p, whatever the
    time step. Around a law that brings ŷc + Δt d + Δy to the setpoint, the sensitivity of a tank
    without a level of its own is ((z − 1)/(z − p))²: below 1 for slow observers, and 4/(1 + p)² at
    half the sampling frequency for fast ones.

    Where measurements are not known it waits, and then goes on from the first value with the d that
    it had.

    `measurement`: y.
    """

    measurement: Signal

    @cached_property
    def time(self) -> Signal:
        """T [s], a parameter."""
        (found,) = signals.growing([_TIME.of(self.measurement, measurement=self.measurement)], -1)
        return found

    def corrected(self, sample: Sample, measured: ca.SX, known: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Return ŷc and d⁺ by the measurement of this sample.

        `known`: whether all measurements of the law are; `lost`, of the law, whether they were not
        in the last sample.
        """
        y = self.measurement
        sample.parameters(self.time)
        sample.memory(*(key.of(y, measurement=y) for key in (_EXPECTED, _RATE)))
        found = sample.call(_CORRECTION, path(y, "correction"), y, measured=measured, known=known)
        return found["corrected"], found["rate"]

    def move_on(
        self, sample: Sample, goes_on: ca.SX, corrected: ca.SX, rate: ca.SX, increment: ca.SX
    ) -> None:
        """Write the state of the next sample.

        `goes_on`: whether it is to; `corrected`, `rate`: as found; `increment`: Δy under the inputs
        that were applied.
        """
        y, (time, _) = self.measurement, time_step_of(sample.symbols)
        following = {"expected": corrected + time * rate + increment, "unmodelled_rate": rate}
        holds = all_of([goes_on, *map(is_number, following.values())])
        for part, value in following.items():
            name = path(y, part)
            sample.next_state[name] = ca.if_else(holds, value, sample[name])
