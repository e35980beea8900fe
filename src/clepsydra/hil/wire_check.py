"""What the wires did between a PLC and a plant: every value, and whether it came in time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from clepsydra.hil.disturbed import changes_of_sensors
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.scan_log import ScanLog
from clepsydra.hil.scanner import Wiring
from clepsydra.rig.plant import PlantSettings
from clepsydra.rig.tag import Tag, Writer

#: A tag and a value, in its unit, to the value as it comes out of the wire.
Through = Callable[[Tag, float], float]


def as_it_is(tag: Tag, value: float) -> float:
    """Return a value as it comes out of a wire that carries numbers in double precision."""
    return value


@dataclass(frozen=True)
class WireCheck:
    """What came out of the wires.

    Parameters
    ----------
    read : int
        Values of the plant that the PLC read as they were told.
    straddled : int
        Values of the sample beside: the plant went on while the PLC read.
    misread : int
        Values that it read otherwise.
    in_time : int
        Commands that moved the plant in the sample in which the PLC had read it.
    late : int
        Samples in which an earlier command still stood.
    foreign : int
        Samples in which a command stood that no scan had written, from the first scan on. What a
        scan wrote without an answer it may have written.
    """

    read: int
    straddled: int
    misread: int
    in_time: int
    late: int
    foreign: int


def check_wires(
    settings: PlantSettings,
    log: ScanLog,
    wiring: Wiring,
    rows: PlantRows,
    tags: Iterable[Tag],
    through: Through = as_it_is,
) -> WireCheck:
    """Compare what a PLC read and wrote with what its plant told and was given, in every bit.

    A sample is left out in which something was done to a sensor after it was told, or in which a
    sensor could not be believed.

    Parameters
    ----------
    settings : PlantSettings
        Of the plant.
    log : ScanLog
    wiring : Wiring
        Of the PLC.
    rows : PlantRows
        Of the plant, from its first sample on.
    tags : iterable of Tag
    through : callable, optional
        What the wires make of a value.
    """
    known = {tag.name: tag for tag in tags}
    samples = log.column("sample").astype(int)
    # The last sample is not over when the rows are taken.
    whole = (samples >= 0) & (samples <= rows.last)
    came = whole & (log.column("read") == 1.0)
    came[whole] &= ~changes_of_sensors(settings, rows)[samples[whole]]
    read = straddled = misread = in_time = late = foreign = 0
    for port, name in wiring.reads.items():
        tag = known[name]
        if tag.writer is Writer.PLANT and tag.signal.kind == "real" and tag.judged_by:
            sound = came.copy()
            # OPC UA tells no value of a sensor that cannot be believed; what was read last stays.
            judged = rows.column(known[tag.judged_by].cell) != 0.0
            sound[whole] &= (judged & np.append(True, judged[:-1]))[samples[whole]]
            told = _on_wire(tag, rows.column(tag.cell), through)
            at, found = samples[sound], log.given()[port][sound]
            same = told[at] == found
            beside = (told[np.maximum(at - 1, 0)] == found) | (
                told[np.minimum(at + 1, rows.last)] == found
            )
            read, straddled = read + int(same.sum()), straddled + int((~same & beside).sum())
            misread += int((~same & ~beside).sum())
    for port, name in wiring.writes.items():
        tag = known[name]
        if tag.signal.kind != "real":
            continue
        stood = rows.column(tag.cell)
        wrote = log.column("written") == 1.0
        asked = _in_cell(tag, log.found()[port], through)
        last = np.full(len(stood), np.nan)
        # Of two scans in one sample the later one counts.
        for sample, value in zip(samples[wrote].tolist(), asked[wrote].tolist(), strict=True):
            if 0 <= sample < len(last):
                last[sample] = value
        prompt = stood == last
        begins = int(samples[wrote].min()) if wrote.any() else len(stood)
        # A write that was never answered may have arrived; the first one may have come late.
        earlier = ~prompt & np.isin(stood, [*asked, *stood[:begins]])
        begun = np.arange(len(stood)) >= begins
        in_time += int((prompt & begun).sum())
        late += int((earlier & begun).sum())
        foreign += int((~prompt & ~earlier & begun).sum())
    return WireCheck(read, straddled, misread, in_time, late, foreign)


def _on_wire(tag: Tag, values: np.ndarray, through: Through) -> np.ndarray:
    return np.array([through(tag, tag.on_wire(value)) for value in values.tolist()])


def _in_cell(tag: Tag, values: np.ndarray, through: Through) -> np.ndarray:
    return np.array([tag.in_cell(through(tag, value)) for value in values.tolist()])
