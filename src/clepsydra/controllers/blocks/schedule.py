"""Parameters that follow a scheduling variable: tables, interpolated linearly."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import called, truth
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: Fewer points make no table, more make one that nobody checks.
FEWEST_POINTS, MOST_POINTS = 2, 15


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

    Raises
    ------
    InputError
        The input is neither a measurement nor a setpoint, or the points are too few or too many.

    Examples
    --------
    >>> schedule = Schedule("level_1.pv", Signal("level_1", "V"), 2)
    >>> [parameter.name for parameter in schedule.parameters()]
    ['schedule.point.1', 'schedule.point.2', 'schedule.filter_time']
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
        return [
            *(
                signals.gain(
                    name, self.signal, float(k), f"{self.signal.name} at point {k} of the schedule"
                )
                for k, name in enumerate(self.places, start=1)
            ),
            signals.duration(
                "schedule.filter_time",
                f"time constant in which the scheduling variable follows {self.shown}",
            ),
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

    def table(self, parameter: Signal) -> list[Signal]:
        """Return the parameters that stand for one that is scheduled: its values at the points.

        Examples
        --------
        >>> schedule = Schedule("level_1.sp", Signal("level_1", "V"), 3)
        >>> [each.name for each in schedule.table(Signal("level_1.gain", "V/V"))]
        ['level_1.gain.at.1', 'level_1.gain.at.2', 'level_1.gain.at.3']
        """
        return [
            replace(
                parameter,
                name=name,
                matrix=parameter.matrix or parameter.part,
                description=f"{parameter.description}, at point {k} of the schedule",
            )
            for k, name in enumerate(self.values(parameter.name), start=1)
        ]

    def state(self) -> list[Signal]:
        """Return the scheduling variable."""
        return [signals.like(self.signal, "schedule.variable", f"{self.shown}, filtered")]

    def followed(self, symbols: Symbols) -> Equations:
        """Return the scheduling variable of this sample as the output followed.

        Parameters
        ----------
        symbols : mapping
            The input, its sensor, variable and filter_time of the schedule, and time_step.

        Examples
        --------
        >>> schedule = Schedule("level_1.sp", Signal("level_1", "V"), 2)
        >>> numbers = {"level_1.sp": 8.0, "schedule.variable": 4.0, "schedule.filter_time": 3.0,
        ...            "time_step": 1.0}
        >>> found = schedule.followed({name: ca.DM(value) for name, value in numbers.items()})
        >>> float(found.outputs["followed"])
        5.0
        """
        given = {**symbols, "asked": symbols[self.variable]}
        sensed = self._input.part == "pv"
        if sensed:
            given["sensor"] = symbols[path(self._input.owner, "good")]
        return called(_schedule_filter(sensed), "schedule_filter", given)

    def interpolated(self, symbols: Symbols, at: ca.SX, names: Sequence[str]) -> dict[str, ca.SX]:
        """Return the scheduled parameters at a value of the scheduling variable.

        At a point of the schedule it is the value of the table in every digit. Points that do
        not rise are passed over, so that nothing is divided by zero.

        Parameters
        ----------
        symbols : mapping
            schedule_point_k and the tables.
        at : casadi.SX
        names : sequence of str
            Of the scheduled parameters.

        Examples
        --------
        >>> schedule = Schedule("level_1.sp", Signal("level_1", "V"), 2)
        >>> numbers = {"schedule.point.1": 2.0, "schedule.point.2": 6.0, "gain.at.1": 10.0,
        ...            "gain.at.2": 20.0}
        >>> symbols = {name: ca.DM(value) for name, value in numbers.items()}
        >>> float(schedule.interpolated(symbols, ca.DM(3.0), ["gain"])["gain"])
        12.5
        """
        block, found = _table(self.points), {}
        for name in names:
            given = [at, *(symbols[each] for each in (*self.places, *self.values(name)))]
            ports = {port.name: value for port, value in zip(block.inputs, given, strict=True)}
            found[name] = called(block, path(name, "table"), ports).outputs["value"]
        return found


@cache
def _schedule_filter(sensed: bool) -> Block:
    """Return the block that follows a scheduling variable: one that is measured has a sensor."""

    def equations(s: Symbols) -> Equations:
        raw, last, time_step = s["asked"], s["schedule.variable"], s["time_step"]
        usable = ca.logic_and(is_number(raw), is_time_step(time_step))
        if sensed:
            usable = ca.logic_and(usable, s["sensor"])
        step = ca.if_else(usable, time_step, 1)
        filter_time = ca.fmax(s["schedule.filter_time"], 0)
        moved = last + (raw - last) * (step / (filter_time + step))
        taken = ca.logic_and(usable, is_number(moved))
        found = ca.if_else(taken, moved, last)
        return Equations({"schedule.variable": found}, {"followed": found})

    return Block(
        "measured_schedule_filter" if sensed else "schedule_filter",
        (
            Signal("asked", description="what the scheduling variable follows"),
            *([truth("sensor", "its sensor is sound")] if sensed else []),
            Signal("schedule.filter_time", "s"),
            Signal("time_step", "s"),
        ),
        (Signal("schedule.variable"),),
        (Signal("followed", description="the scheduling variable of this sample"),),
        equations,
        ("The scheduling variable, filtered; it stays where it is not known.",),
    )


@cache
def _table(count: int) -> Block:
    """Return the block of a table over so many points."""

    places, names = elements("point", count), elements("value", count)

    def equations(s: Symbols) -> Equations:
        points, values = ([s[name] for name in each] for each in (places, names))
        found = values[0]
        for (low, high), (first, last) in zip(
            itertools.pairwise(points), itertools.pairwise(values), strict=True
        ):
            rises = high > low
            share = (s["place"] - low) / ca.if_else(rises, high - low, 1)
            within = ca.logic_and(rises, s["place"] > low)
            here = ca.if_else(s["place"] >= high, last, first + share * (last - first))
            found = ca.if_else(within, here, found)
        return Equations({}, {"value": found})

    return Block(
        f"table_of_{count}_points",
        (
            Signal("place", description="where it is read"),
            *map(Signal, (*places, *names)),
        ),
        (),
        (Signal("value"),),
        equations,
        ("Straight lines between points, and the end values beyond.",),
    )
