"""Pumps and outlets other than the controllers assume."""

from __future__ import annotations

import itertools

import numpy as np

from clepsydra.papers.comparison import claimed
from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_variable_structure.rig import Filling, fill, in_nu, in_volts, plant
from clepsydra.papers.row import Row

_VARIED = ("pump_1.gain", "pump_2.gain", "outlet_1.area", "outlet_2.area")
_SPREAD = 0.2


def robustness() -> Findings:
    """Fill the tanks of every corner of ±20 % with both controllers, in volts and linearised."""
    corners = np.array(list(itertools.product((1 - _SPREAD, 1 + _SPREAD), repeat=len(_VARIED))))
    parameters = {
        name: plant().signal(name).initial * corners[:, place] for place, name in enumerate(_VARIED)
    }
    rows = []
    for words, controllers in (
        ("in volts", (in_volts("clamping"), in_volts("variable_structure"))),
        ("linearised", (in_nu("clamping"), in_nu("variable_structure"))),
    ):
        old, new = (fill(controller, parameters=parameters) for controller in controllers)
        rows += [
            _row(f"worst overshoot, {words}", old, new, "overshoot", "%", len(corners)),
            _row(f"worst settling time, {words}", old, new, "settling", "s", len(corners)),
        ]
    return Findings(tuple(rows))


def _row(name: str, old: Filling, new: Filling, what: str, unit: str, count: int) -> Row:
    worst = [
        max(getattr(run, what)(j, lane) for j in (1, 2) for lane in range(count))
        for run in (old, new)
    ]
    return claimed(
        "section 6",
        name,
        "improves the robust performance with control constraints",
        worst[1] < worst[0],
        f"{worst[1]:.3g} against {worst[0]:.3g}",
        unit,
        reason="Pump gains and lower outlets each 20 % more or less than assumed, 16 corners, "
        "both levels; variable structure (α = 0.1) against clamping, pumps up to 10 V.",
    )
