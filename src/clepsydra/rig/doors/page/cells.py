"""All that an operator and an instructor may set from the page of a rig."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from clepsydra.base.signal import Signal, path
from clepsydra.loop.alarms import acknowledging_inputs
from clepsydra.loop.faults import FORCED, READING, STICTION, STOPPED
from clepsydra.process.process import Process
from clepsydra.rig.doors.page.cell import Cell
from clepsydra.rig.tag import (
    DRIFT,
    LATEST_ANSWER,
    NOISE,
    WIRE_CUT,
    WIRE_DELAY,
    WIRE_LOSS,
    Tag,
    Writer,
)

#: What sticks for good has to be asked to go so many times its range.
_STUCK = 2.0


def cells_of(process: Process, tags: Iterable[Tag]) -> tuple[Cell, ...]:
    """Return what a page may set: what operators write on the wires, and what instructors do.

    Parameters
    ----------
    process : Process
        Without the hands of a laboratory.
    tags : iterable of Tag
        Those of its rig.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> point = cl.load("quadruple-tank").point
    >>> cells = {cell.name: cell for cell in cells_of(point.process, tags_of(point))}
    >>> cells["pump_1.stiction"].high, cells["level_1.forced"].whole, "pump_1.command" in cells
    (20.0, True, False)
    """
    return (
        *(_of_operator(tag) for tag in tags if tag.writer is Writer.OPERATOR),
        *(cell for y in process.measurements for cell in _of_sensor(y, process.sampling_period)),
        *(cell for u in process.inputs for cell in _of_actuator(u)),
        *(Cell(d.name, d.low, d.high) for d in process.disturbances),
        *(_switch(signal.name) for signal in acknowledging_inputs(process)),
        *(_switch(name) for name in (NOISE, WIRE_CUT)),
        Cell(WIRE_DELAY, 0.0, LATEST_ANSWER),
        Cell(WIRE_LOSS, 0.0, 1.0),
    )


def _of_operator(tag: Tag) -> Cell:
    return Cell(
        tag.cell, tag.in_cell(tag.lowest), tag.in_cell(tag.highest), tag.signal.kind != "real"
    )


def _of_sensor(measured: Signal, period: float) -> Iterator[Cell]:
    yield _switch(path(measured, "sensor"))
    yield _switch(path(measured, FORCED))
    span = measured.span if measured.has_range else math.inf
    yield Cell(path(measured, READING), measured.low - span, measured.high + span)
    yield Cell(path(measured, DRIFT), -span / period, span / period)


def _of_actuator(moved: Signal) -> Iterator[Cell]:
    yield _switch(path(moved, STOPPED))
    span = moved.span if moved.has_range else math.inf
    yield Cell(path(moved, STICTION), 0.0, _STUCK * span)


def _switch(name: str) -> Cell:
    return Cell(name, 0.0, 1.0, whole=True)
