"""One PLC on one kind of wires, taken through all cases, and all that it did computed again."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.deploy.exportable import Exportable
from clepsydra.hil.case import Case, Episode, Hands, Subject, Verdict
from clepsydra.hil.controller_image import ControllerImage
from clepsydra.hil.evidence import Evidence, evidence_of
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.scan_log import ScanLog
from clepsydra.hil.soft_plc import SoftPlc, SoftPlcSettings
from clepsydra.hil.wires import Wires
from clepsydra.hil.wiring import wiring_of
from clepsydra.rig.child import reports_of
from clepsydra.rig.report import Kind
from clepsydra.rig.running import RunningRig
from clepsydra.rig.settings import RigSettings
from clepsydra.rig.tag import LATENESS

#: Samples before the first case, and looks at the plant in a sample.
_BEFORE, _LOOKS = 10, 4
#: Where the hands were so many samples late the case is gone through again, so often in all.
_LATE_HANDS, _TRIES = 2, 3
#: A PLC has so long to begin [s].
_BEGINS = 60.0


@dataclass(frozen=True)
class Timing:
    """How well the clocks of a trial were met.

    Parameters
    ----------
    period : float
        Of the plant and of the PLC, by a real clock [s].
    lateness : tuple of float
        Of the plant's samples: median, 99th percentile and largest [s].
    late : int
        Scans that ended when the plant's next sample had begun, in the cases in which every scan
        has to be in time.
    unseen : int
        Samples of those cases that no scan read.
    samples : int
        Of those cases.
    """

    period: float
    lateness: tuple[float, float, float]
    late: int
    unseen: int
    samples: int

    @property
    def is_met(self) -> bool:
        """Whether at most two samples in a hundred went amiss."""
        return self.late + self.unseen <= self.samples / 50


@dataclass(frozen=True)
class Tried:
    """What came of a trial.

    Parameters
    ----------
    plc, wires : str
        What ran, and through what: "C in double by gcc", "Modbus TCP, float32".
    label : str
        Both in a few letters: "C, Modbus TCP".
    verdicts : dict
        Name of a case to how the loop took it.
    windows : dict
        Name of a case to its first sample, and the one behind its last.
    evidence : Evidence
        All of it computed again; its deviations are those of the cases in which every scan is in
        time.
    timing : Timing
    """

    plc: str
    wires: str
    label: str
    verdicts: dict[str, Verdict]
    windows: dict[str, tuple[int, int]]
    evidence: Evidence
    timing: Timing

    @property
    def holds(self) -> bool:
        """Whether all of it is as it has to be."""
        return self.evidence.holds and all(each.holds for each in self.verdicts.values())


def tried(
    settings: RigSettings,
    ready: Exportable,
    image: ControllerImage,
    wires_to: Callable[[RunningRig], Wires],
    subject: Subject,
    cases: Mapping[str, Case],
) -> Tried:
    """Take a PLC through cases.

    Parameters
    ----------
    settings : RigSettings
        Of a rig with one door.
    ready : Exportable
        What the PLC's program was printed from.
    image : ControllerImage
    wires_to : callable
        The rig at work to the PLC's way to it.
    subject : Subject
    cases : mapping

    Raises
    ------
    InputError
        The PLC does not begin, or ends by itself.
    """
    tags, wiring = settings.tags, wiring_of(ready, settings.tags)
    rows = PlantRows(settings.plant.layout)
    with RunningRig(settings) as rig:
        wires = wires_to(rig)
        period = settings.process.sampling_period
        plc = SoftPlc(SoftPlcSettings(image, wiring, wires.bus, period, settings.speed))
        try:
            plc.start()
            _await(plc)
            windows = _through(rig, plc, rows, subject, cases)
            log = plc.finish(at=max(last for _, last in windows.values()))
        finally:
            plc.end()
        rows.take(rig.image)
    if log is None:
        raise InputError(
            "hardware in the loop, soft PLC", Finding("a process that ended by itself"),
            "a PLC that scans to the end", "see what it printed, and try again",
        )  # fmt: skip
    verdicts = {
        name: case.judge(Episode(subject, rows, log, *windows[name]))
        for name, case in cases.items()
    }
    in_time = max((windows[n][1] for n, case in cases.items() if case.is_ideal), default=0)
    evidence = evidence_of(
        ready, image.precision, settings.plant, log, wiring, rows, tags, wires, in_time
    )
    timing = _timing(settings, log, rows, in_time)
    label = f"{image.label}, {wires.title.partition(',')[0]}"
    return Tried(image.title, wires.title, label, verdicts, windows, evidence, timing)


def _await(plc: SoftPlc) -> None:
    """Wait until a PLC scans."""
    until = time.monotonic() + _BEGINS
    while time.monotonic() < until:
        for _, report in reports_of([plc.child], 0.2):
            if report.error is not None:
                raise report.error
            if report.kind is Kind.READY:
                return
        if not plc.child.is_alive:
            break
    raise InputError(
        "hardware in the loop, soft PLC", Finding("nothing within a minute"), "a PLC that scans",
        "see what it printed, and try again",
    )  # fmt: skip


def _through(
    rig: RunningRig, plc: SoftPlc, rows: PlantRows, subject: Subject, cases: Mapping[str, Case]
) -> dict[str, tuple[int, int]]:
    """Do in each case what is to be done, and return the samples of each.

    On a busy machine it is these hands that may come late: what was done too late for its case
    says nothing of the loop.
    """
    hands = Hands(rig.table, rig.instructor, plc.send)
    first = rig.image.published().sample + _BEFORE
    windows = {}
    for name, case in cases.items():
        for _ in range(_TRIES):
            last = first + case.samples(subject)
            windows[name] = first, last
            late = 0
            for at, act in sorted(case.acts(subject).items()):
                late = max(late, _until(rig, rows, first + at) - first - at)
                act(hands)
            _until(rig, rows, last)
            first = last
            if late <= _LATE_HANDS:
                break
    _until(rig, rows, first + 1)
    return windows


def _until(rig: RunningRig, rows: PlantRows, sample: int) -> int:
    """Wait until a plant has told a sample; returns the one that it has told then."""
    settings = rig.settings
    pause = settings.process.sampling_period / settings.speed / _LOOKS
    while (told := rig.image.published().sample) < sample:
        rows.take(rig.image)
        # What the rig reports is in its history.
        for _ in rig.watch(pause):
            pass
    return told


def _timing(settings: RigSettings, log: ScanLog, rows: PlantRows, until: int) -> Timing:
    period = settings.process.sampling_period / settings.speed
    late, took, samples = rows.column(LATENESS)[1:], log.column("took"), log.column("sample")
    begins = int(samples.min(initial=until))
    own = (samples >= begins) & (samples < until)
    # What is written has to be there when the next sample of the plant begins.
    room = (1.0 - SoftPlcSettings.phase) * period
    median, most, largest = np.percentile(late, [50.0, 99.0, 100.0]).tolist()
    return Timing(
        period,
        (median, most, largest),
        int(np.sum((log.column("lateness") + took)[own] > room)),
        until - begins - len(set(samples[own].tolist())),
        max(until - begins, 1),
    )
