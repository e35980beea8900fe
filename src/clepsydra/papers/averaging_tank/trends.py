"""Figures 7 to 9 of the document: outputs and inputs of several runs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.figure import Curve, CurveKind, Figure, Panel

#: Name, signal, label, factor and kind of curve of each panel.
SIGNALS: tuple[tuple[str, str, str, float, CurveKind], ...] = (
    ("C", "concentration", "C [kmol/m³]", KMOL, "line"),
    ("V", "volume", "V [m³]", 1.0, "line"),
    ("f_in", "inflow", "f_in [m³/s]", 1.0, "held"),
    ("f_out", "outflow", "f_out [m³/s]", 1.0, "held"),
    ("C_in", "inflow.impurity", "C_in [kmol/m³]", KMOL, "held"),
)
_POINTS = 1500


def trend_figure(
    number: str, title: str, runs: Mapping[str, Run], horizon: float, note: str = ""
) -> Figure:
    """Return outputs and inputs of runs by name over a horizon [s], thinned for a picture."""
    panels = []
    for name, signal, label, factor, kind in SIGNALS:
        shown = []
        for who, run in runs.items():
            last = int(np.searchsorted(run.time, horizon)) + 1
            # Where things happen fast, at the start, every sample is kept.
            places = np.unique(np.r_[: min(last, _POINTS), 0 : last : max(1, last // _POINTS)])
            shown.append(Curve(who, run.time[places], run.values[signal][places] / factor, kind))
        if kind == "line":
            target = np.full(2, run.values[f"{signal}.setpoint"][0] / factor)
            shown.append(Curve("", np.array([0.0, horizon]), target, "dashed"))
        panels.append(Panel(name, label, shown))
    return Figure(number, title, panels, note)
