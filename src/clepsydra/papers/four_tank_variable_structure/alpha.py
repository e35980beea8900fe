"""What α does to a filling."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.readings import Setting, filled_with
from clepsydra.papers.four_tank_variable_structure.rig import Filling, fill, in_nu, in_volts
from clepsydra.papers.row import Row

#: [1/s]
RATES = np.geomspace(1e-3, 10.0, 41)
LIMIT = 10.0
#: Td in Ti, the largest share of eighths with which pumps up to 10 V saturate after decoupling.
_DERIVATIVE = 0.125


def run() -> Found:
    """Fill the tanks with many an α."""
    lanes = {f"controller.level_{j}.saturation_rate": RATES for j in (1, 2)}
    volts = fill(in_volts("variable_structure"), LIMIT, parameters=lanes)
    nu = fill(in_nu("variable_structure"), LIMIT, parameters=lanes)
    differentiated = [Setting(derivative=_DERIVATIVE)] * len(RATES)
    damped = filled_with("variable_structure", differentiated, RATES)
    return (_adjusts(volts, nu, damped), _figure(volts, nu))


def _adjusts(volts: Filling, nu: Filling, damped: Filling) -> Row:
    runs = (volts, nu, damped)
    settled = [run.settling(1) for run in runs]
    ranges = [
        f"{each.min():.3g} (α = {RATES[int(np.argmin(each))]:.2g}) to {each.max():.3g} "
        f"(α = {RATES[int(np.argmax(each))]:.2g})"
        for each in settled
    ]
    return PRINTED["section 4, feature (2)", "settling time of h1 over α"].remark(
        f"without decoupling {ranges[0]}; after decoupling, α in ν {ranges[1]}, and with "
        f"derivative action, Td = Ti/{1 / _DERIVATIVE:g}, {ranges[2]}"
    )


def _figure(volts: Filling, nu: Filling) -> Figure:
    def panel(title: str, label: str, of: Callable[[Filling, int], np.ndarray]) -> Panel:
        found = {
            f"h{j}, {name}": of(run, j)
            for name, run in (("without decoupling", volts), ("after decoupling", nu))
            for j in (1, 2)
        }
        return Panel(title, label, curves(RATES, found), "α [1/s]", logarithmic_x=True)

    panels = (
        panel("Overshoot", "[%]", Filling.overshoot),
        panel("Settling time, 2 %", "[s]", Filling.settling),
        panel("Rise time", "[s]", Filling.rise),
    )
    words = (
        "A large α takes the overshoot away and makes the rise slow. After decoupling α is in ν."
    )
    return Figure("", "What α does, with pumps up to 10 V", panels, words)
