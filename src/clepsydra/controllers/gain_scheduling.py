"""Gain scheduling: parameters of a law that follow a scheduling variable by tables."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import casadi as ca

from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.sample import Reading, Sample, inner_equations, written_law
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step
from clepsydra.controllers.linear_quadratic_integral import varying_lqi
from clepsydra.controllers.observers.linear_state import LinearState
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, StepLaw, Symbols

#: Fewer points make no table, more make one that nobody checks.
FEWEST_POINTS, MOST_POINTS = 2, 15
_VARIABLE, _FILTER_TIME = "schedule.variable", "schedule.filter_time"


@dataclass(frozen=True)
class Schedule:
    """Which input of a law its parameters follow, and over how many points.

    The input passes a filter of first order, and each parameter stands on the straight line
    between its values at the two points around it; beyond the first and the last point it keeps
    theirs. Where the input is no number, or its sensor has failed, the parameters stay.

    `variable`: the input of the law: pv of a measurement, or its sp; `signal`: what it shows; lends
    unit and range; `points`: 2 to 15.
    """

    variable: str
    signal: Signal
    points: int

    @property
    def _input(self) -> Signal:
        return Signal(self.variable)

    @property
    def places(self) -> list[str]:
        """The parameters that say where its points are."""
        return elements("schedule.point", self.points)

    def values(self, name: str) -> list[str]:
        """Return the names of a table: the values at the points of what is scheduled."""
        return elements(path(name, "at"), self.points)

    @property
    def shown(self) -> str:
        """The scheduling variable in words."""
        name = self.signal.name
        return f"the setpoint of {name}" if self._input.part == "sp" else name

    @property
    def words(self) -> str:
        """What a law does by it, for its reader."""
        return (
            f"Gain scheduling: parameters by tables of {self.points} points over {self.shown}, "
            "filtered."
        )

    def followed(self, sample: Sample) -> ca.SX:
        """Write the filter of the scheduling variable, and return that of this sample."""
        sample.memory(signals.like(self.signal, _VARIABLE, f"{self.shown}, filtered"))
        words = f"time constant in which the scheduling variable follows {self.shown}"
        sample.parameters(signals.duration(_FILTER_TIME, words))
        given = {"asked": sample[self.variable]}
        if sensed := self._input.part == "pv":
            given["sensor"] = sample[path(self._input.owner, "good")]
        return sample.call(_schedule_filter(sensed), "schedule_filter", **given)["followed"]

    def interpolated(
        self, sample: Sample, at: ca.SX, scheduled: Iterable[Signal]
    ) -> dict[str, ca.SX]:
        """Return the scheduled parameters at a value of the scheduling variable.

        The law has points, and in the place of each such parameter its values there. At a point
        of the schedule it is the value of the table in every digit. Points that do not rise are
        passed over, so that nothing is divided by zero.

        Examples
        --------
        >>> schedule = Schedule("level_1.sp", Signal("level_1", "V"), 2)
        >>> numbers = {"schedule.point.1": 2.0, "schedule.point.2": 6.0, "gain.at.1": 10.0,
        ...            "gain.at.2": 20.0}
        >>> sample = Sample({name: ca.DM(value) for name, value in numbers.items()})
        >>> float(schedule.interpolated(sample, ca.DM(3.0), [Signal("gain")])["gain"])
        12.5
        """
        block, found, shown = _table(self.points), {}, "at point {} of the schedule"
        points = sample.parameters(
            *(
                signals.gain(place, self.signal, float(k), f"{self.signal.name} {shown.format(k)}")
                for k, place in enumerate(self.places, start=1)
            )
        )
        for parameter in scheduled:
            name, matrix = parameter.name, parameter.matrix or parameter.part
            table = (
                replace(
                    parameter,
                    name=place,
                    matrix=matrix,
                    description=f"{parameter.description}, {shown.format(k)}",
                )
                for k, place in enumerate(self.values(name), start=1)
            )
            values = [at, *points, *sample.parameters(*table)]
            given = {port.name: value for port, value in zip(block.inputs, values, strict=True)}
            found[name] = sample.call(block, path(name, "table"), **given)["value"]
            sample.name(name, {"used": found[name]})
        return found


@cache
def _schedule_filter(sensed: bool) -> Block:
    """Return the block that follows a scheduling variable: one that is measured has a sensor."""

    def equations(s: Symbols) -> Equations:
        raw, last, time_step = s["asked"], s[_VARIABLE], s["time_step"]
        sound = [s["sensor"]] if sensed else []
        usable = all_of([is_number(raw), is_time_step(time_step), *sound])
        step = ca.if_else(usable, time_step, 1)
        moved = last + (raw - last) * (step / (ca.fmax(s[_FILTER_TIME], 0) + step))
        found = ca.if_else(ca.logic_and(usable, is_number(moved)), moved, last)
        return Equations({_VARIABLE: found}, {"followed": found})

    return Block(
        "measured_schedule_filter" if sensed else "schedule_filter",
        (
            Signal("asked", description="what the scheduling variable follows"),
            *([truth("sensor", "its sensor is good")] * sensed),
            Signal(_FILTER_TIME, "s"),
            Signal("time_step", "s"),
        ),
        (Signal(_VARIABLE),),
        (Signal("followed", description="the scheduling variable of this sample"),),
        equations,
        ("The scheduling variable, filtered; it stays where it is not known.",),
    )


@cache
def _table(count: int) -> Block:
    """Return the block of a table over so many points."""

    places, names = elements("point", count), elements("value", count)

    def equations(s: Symbols) -> Equations:
        at, found = s["place"], s[names[0]]
        for ends in pairwise(zip(places, names, strict=True)):
            (low, first), (high, last) = ((s[place], s[name]) for place, name in ends)
            rises = high > low
            share = (at - low) / ca.if_else(rises, high - low, 1)
            here = ca.if_else(at >= high, last, first + share * (last - first))
            found = ca.if_else(ca.logic_and(rises, at > low), here, found)
        return Equations({}, {"value": found})

    return Block(
        f"table_of_{count}_points",
        (Signal("place", description="where it is read"), *map(Signal, (*places, *names))),
        (),
        (Signal("value"),),
        equations,
        ("Straight lines between points, and the end values beyond.",),
    )


FAMILY = "gain scheduling"


def scheduled_law(law: StepLaw, schedule: Schedule, names: Sequence[str]) -> StepLaw:
    """Return a law with some of its parameters replaced by tables over a scheduling variable.

    A table holds the values of parameter K at the points of the schedule, K.at.1, K.at.2, …; the
    law computes with the value interpolated in each sample. The law itself must bear a change
    of these parameters without a bump, as a multiloop PID does: its integral stands behind the
    gain and takes a change of it up.

    `names`: the parameters that are scheduled.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.
    """
    known = {parameter.name: parameter for parameter in law.parameters}
    scheduled = [known.pop(name) for name in names]

    def equations(sample: Sample) -> None:
        found = schedule.interpolated(sample, schedule.followed(sample), scheduled)
        sample.parameters(*known.values())
        sample.memory(*law.state)
        inner = inner_equations(law, {**sample.symbols, **found})
        sample.next_state |= inner.next_state
        sample.outputs |= inner.outputs
        sample.named |= inner.intermediates

    words = (*law.description, schedule.words)
    return written_law(f"scheduled_{law.name}", equations, law.inputs, law.outputs, words)


def scheduled_lqi_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    controlled: Sequence[str],
    schedule: Schedule,
    anti_windup: AntiWindup = "back_calculation",
) -> StepLaw:
    """Write the step law of LQI whose gains F and G follow a scheduling variable by tables.

    As `linear_quadratic_integral.lqi_law` without an observer; the integral takes up what a
    change of F makes (`linear_quadratic_integral.varying_lqi`).

    `measured`, `manipulated`: the measurements show the whole state; `controlled`: the measurements
    that have setpoints.

    Raises InputError: the anti-windup is unknown or clamping.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.
    """
    state = LinearState(measured, manipulated, controlled, None)
    scheduled = state.gains()
    if anti_windup == "back_calculation":
        scheduled += [signals.TRACKING_TIME.of(u) for u in state.manipulated]

    def gains(sample: Sample, reading: Reading, _: Sequence[ca.SX]) -> dict[str, ca.SX]:
        found = schedule.interpolated(sample, schedule.followed(sample), scheduled)
        # The gains change with what is known, so that the integral can take the change up.
        known = ca.logic_and(reading.numbers, reading.sensors)
        kept = state.feedback.last()
        for gain, last in zip(kept, sample.memory(*kept), strict=True):
            found[gain.name] = ca.if_else(known, found[gain.name], last)
            sample.next_state[gain.name] = found[gain.name]
        sample.symbols = ChainMap(sample.symbols, found)
        return found

    return varying_lqi("scheduled_lqi", state, anti_windup, gains=gains, words=[schedule.words])
