"""Figures 7 to 9 of the document: outputs and inputs of several runs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.figure import Curve, Figure, Panel

_PANELS = (
    ("C", "concentration", "C [kmol/m³]", KMOL),
    ("V", "volume", "V [m³]", 1.0),
    ("f_in", "inflow", "f_in [m³/s]", 1.0),
    ("f_out", "outflow", "f_out [m³/s]", 1.0),
    ("C_in", "inflow.impurity", "C_in [kmol/m³]", KMOL),
)
_POINTS = 1500


def trend_figure(
    number: str, title: str, runs: Mapping[str, Run], horizon: float, note: str = ""
) -> Figure:
    """Return outputs and inputs of runs by name over a horizon [s], thinned for a picture."""
    panels = []
    for name, signal, label, factor in _PANELS:
        curves = []
        for who, run in runs.items():
            last = int(np.searchsorted(run.time, horizon)) + 1
            step = max(1, last // _POINTS)
            # Where things happen fast, at the start, every sample is kept.
            places = np.unique(np.r_[: min(last, _POINTS), 0:last:step])
            values = run.values[signal][places] / factor
            kind = "line" if name in ("C", "V") else "held"
            curves.append(Curve(who, run.time[places], values, kind))  # type: ignore[arg-type]
        if name in ("C", "V"):
            run = next(iter(runs.values()))
            ends = np.array([0.0, horizon])
            target = np.full(2, run.values[f"{signal}.setpoint"][0] / factor)
            curves.append(Curve("", ends, target, "dashed"))
        panels.append(Panel(name, label, tuple(curves)))
    return Figure(number, title, tuple(panels), note)
