"""A run on wires beside the simulation of its loop, in which every scan is in time and exact."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import path
from clepsydra.deploy.exportable import Exportable
from clepsydra.deploy.tagged import TaggedLaw
from clepsydra.engine.kernel import Kernel
from clepsydra.hil.disturbed import disturbed_inputs
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.scan_log import ScanLog
from clepsydra.hil.scanner import Wiring
from clepsydra.laboratory.rig import Station
from clepsydra.loop.closed_loop import TRUE
from clepsydra.loop.faults import APPLIED
from clepsydra.loop.loop import Loop
from clepsydra.rig.plant import PlantSettings
from clepsydra.rig.tag import Tag, Writer


@dataclass(frozen=True)
class Deviation:
    """How far a signal of a run on wires lies from that of the simulation.

    Parameters
    ----------
    tag : Tag
        Of a measurement, or of what moves the plant.
    largest : float
        Largest difference, in its unit.
    sample : int
        Where it is.
    """

    tag: Tag
    largest: float
    sample: int


def ideal_run(
    settings: PlantSettings, ready: Exportable, samples: int, given: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Simulate the loop of a rig and an exported controller, from rest.

    Parameters
    ----------
    settings : PlantSettings
        Of the plant.
    ready : Exportable
        In its plant shell, as the PLC has it.
    samples : int
    given : mapping
        Input of the loop to its values [SI] [samples]; what is left out rests.

    Returns
    -------
    dict
        Output of the loop's program to its values [SI] [samples].
    """
    station = settings.station
    loop = Station(Loop(ready.controller, station.loop.model), station.substeps)
    own, begin = loop.numbers, loop.numbers.starts["rest"]
    run = Kernel(loop.program, fuse=False).run(
        samples, inputs={**own.at_rest, **given}, parameters=own.parameters, state=begin.state,
        rings=begin.rings,
    )  # fmt: skip
    return {each.name: run.output(each.name)[0] for each in loop.program.outputs}


def as_operated(
    settings: PlantSettings,
    ready: Exportable,
    log: ScanLog,
    wiring: Wiring,
    rows: PlantRows,
    tags: Iterable[Tag],
) -> dict[str, np.ndarray]:
    """Return what a loop was given in a run on wires, as its controller and its process saw it.

    What an operator gave, and whether a sensor can be believed, is what the PLC read; a sample that
    it missed is as the one before. What an instructor did to what a sensor shows the PLC sees from
    the sample on that was told with it.

    Returns
    -------
    dict
        Input of the loop to its values [SI] [samples].
    """
    count, known = rows.last + 1, {tag.name: tag for tag in tags}
    found = disturbed_inputs(settings, rows, as_told=True)
    samples, came = log.column("sample").astype(int), log.column("read") == 1.0
    places = np.searchsorted(samples[came], np.arange(count), side="right") - 1
    law, named = ready.controller, TaggedLaw(ready.controller, ready.process).name
    loop_inputs = {named(port): wire for port, wire in law.input_wires.items()}
    for port, name in wiring.reads.items():
        tag = known[name]
        if tag.cell in rows.layout.written and came.any():
            read = np.array([tag.in_cell(value) for value in log.given()[port][came].tolist()])
            # Before its first scan everything rests.
            rest = settings.at_rest.get(tag.cell, 0.0)
            found[loop_inputs[port]] = np.where(places < 0, rest, read[np.maximum(places, 0)])
    return found


def deviations(
    ideal: Mapping[str, np.ndarray],
    rows: PlantRows,
    tags: Iterable[Tag],
    until: int | None = None,
) -> tuple[Deviation, ...]:
    """Return how far what a plant went through, and what moved it, lie from the simulation.

    Measurements are as they are, without noise or fault of their sensors.

    Parameters
    ----------
    ideal : mapping
        What `ideal_run` returns.
    rows : PlantRows
    tags : iterable of Tag
    until : int, optional
        The sample before which they are compared; all of them if left out.
    """
    found = []
    for tag in tags:
        is_measured = bool(tag.judged_by)
        is_moved = tag.cell.endswith(f".{APPLIED}") and tag.writer is Writer.PLANT
        if is_measured or is_moved:
            name = path(tag.cell, TRUE) if is_measured else tag.cell
            away = np.abs(rows.column(name) - ideal[name])[:until]
            place = int(np.argmax(away))
            by = abs(tag.on_wire(float(away[place])) - tag.on_wire(0.0))
            found.append(Deviation(tag, by, place))
    return tuple(found)
