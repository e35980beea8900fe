"""Parameters that follow a scheduling variable: tables, interpolated linearly."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: Fewer points make no table, more make one that nobody checks.
FEWEST_POINTS, MOST_POINTS = 2, 15
_VARIABLE, _FILTER_TIME = "schedule.variable", "schedule.filter_time"


@dataclass(frozen=True)
class Schedule:
    """Which input of a law its parameters follow, and over how many points.

    The input passes a filter of first order, and each parameter stands on the straight line
    between its values at the two points around it; beyond the first and the last point it keeps
    theirs. Where the input is no number, or its sensor has failed, the parameters stay.

    Parameters
    ----------
    variable : str
        The input of the law: pv of a measurement, or its sp.
    signal : Signal
        What it shows; lends unit and range.
    points : int
        2 to 15.

    Raises InputError: the input is neither a measurement nor a setpoint, or the points are too few
    or too many.
    """

    variable: str
    signal: Signal
    points: int

    def __post_init__(self) -> None:
        if self._input.part not in ("pv", "sp"):
            raise InputError(
                "schedule, variable",
                self.variable,
                "a measurement or a setpoint of the law",
                "write as in level_1.pv",
            )
        if not FEWEST_POINTS <= self.points <= MOST_POINTS:
            raise InputError(
                "schedule, points",
                self.points,
                f"{FEWEST_POINTS} to {MOST_POINTS} points",
                "choose fewer or more points",
            )

    def parameters(self) -> list[Signal]:
        """Return the points and filter_time of the schedule."""
        words = "time constant in which the scheduling variable follows"
        name = self.signal.name
        return [
            *(
                signals.gain(place, self.signal, float(k), f"{name} at point {k} of the schedule")
                for k, place in enumerate(self.places, start=1)
            ),
            signals.duration(_FILTER_TIME, f"{words} {self.shown}"),
        ]

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

    def tables(self, parameters: Iterable[Signal]) -> list[Signal]:
        """Return the parameters that stand for those that are scheduled: values at the points."""
        return [
            replace(
                parameter,
                name=name,
                matrix=parameter.matrix or parameter.part,
                description=f"{parameter.description}, at point {k} of the schedule",
            )
            for parameter in parameters
            for k, name in enumerate(self.values(parameter.name), start=1)
        ]

    @property
    def words(self) -> str:
        """What a law does by it, for its reader."""
        return (
            f"Gain scheduling: parameters by tables of {self.points} points over {self.shown}, "
            "filtered."
        )

    def state(self) -> list[Signal]:
        """Return the scheduling variable."""
        return [signals.like(self.signal, _VARIABLE, f"{self.shown}, filtered")]

    def followed(self, sample: Sample) -> ca.SX:
        """Write the filter of the scheduling variable, and return that of this sample.

        Parameters
        ----------
        sample : Sample
            With the input, its sensor, variable and filter_time of the schedule, and time_step.
        """
        given = {"asked": sample[self.variable]}
        if sensed := self._input.part == "pv":
            given["sensor"] = sample[path(self._input.owner, "good")]
        return sample.call(_schedule_filter(sensed), "schedule_filter", **given)["followed"]

    def interpolated(self, sample: Sample, at: ca.SX, names: Iterable[str]) -> dict[str, ca.SX]:
        """Return the scheduled parameters at a value of the scheduling variable.

        At a point of the schedule it is the value of the table in every digit. Points that do
        not rise are passed over, so that nothing is divided by zero.

        Parameters
        ----------
        sample : Sample
            With the points and the tables.
        names : iterable of str
            Of the scheduled parameters.

        Examples
        --------
        >>> schedule = Schedule("level_1.sp", Signal("level_1", "V"), 2)
        >>> numbers = {"schedule.point.1": 2.0, "schedule.point.2": 6.0, "gain.at.1": 10.0,
        ...            "gain.at.2": 20.0}
        >>> sample = Sample({name: ca.DM(value) for name, value in numbers.items()})
        >>> float(schedule.interpolated(sample, ca.DM(3.0), ["gain"])["gain"])
        12.5
        """
        block, found = _table(self.points), {}
        for name in names:
            values = [at, *(sample[each] for each in (*self.places, *self.values(name)))]
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
            *([truth("sensor", "its sensor is sound")] * sensed),
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
