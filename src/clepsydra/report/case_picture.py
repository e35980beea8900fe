"""What one controller makes of the first events in each case of its study, as a still picture."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clepsydra.base.section import Picture
from clepsydra.loop.run import Run
from clepsydra.process.process import Process
from clepsydra.report.colours import PALETTE
from clepsydra.report.overlay import ShownSignal, event_windows, shown_signals
from clepsydra.report.overlay_picture import overlay_svg
from clepsydra.studies.result import Candidate, StudyResult


@dataclass(frozen=True, eq=False)
class FromRest(ShownSignal):
    """A row of charts in which every run begins at zero, wherever it rests."""

    @property
    def name(self) -> str:
        """What the reader knows it by, and that it is a change."""
        return f"Δ {super().name}"

    def values(self, run: Run) -> np.ndarray:
        """Return how far it is from where it began, in display units [samples]."""
        found = super().values(run)
        return found - found[0]

    def band(self, process: Process) -> None:
        """Return none: it lies elsewhere beside every rest."""

    def setpoint(self, run: Run) -> np.ndarray | None:
        """Return how far the setpoint is from where it began, in display units [samples]."""
        found = super().setpoint(run)
        return None if found is None else found - found[0]


def case_picture(result: StudyResult, candidate: Candidate) -> Picture | None:
    """Return what a controller does in each case, beside each other; None where it cannot be drawn.

    Cases that take their steps at other samples are left out.
    """
    here = [
        replace(each, controller=replace(each.controller, name=name, slowed=1.0))
        for name, each in candidate.cases.items()
        if each is not None and _alike(each, candidate)
    ][: len(PALETTE)]
    signals = [
        FromRest(each.signal, each.measurement, each.inner)
        for each in shown_signals(result)
        if not each.inner
    ]
    windows = event_windows(result, signals, here)
    if not windows:
        return None
    name = candidate.controller.title
    drawn = overlay_svg(windows, signals, here, f"What {name} makes of each event in each case")
    return Picture(drawn, f"{name} in each case; changes from where it rests there.")


def _alike(each: Candidate, candidate: Candidate) -> bool:
    one, other = each.run.scenario, candidate.run.scenario
    return one.sampling_period == other.sampling_period and one.samples == other.samples
