"""What α does to a filling."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.controllers.virtual_input import AlphaOn
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.readings import Setting, filled_with
from clepsydra.papers.four_tank_variable_structure.rig import (
    Filling,
    fill,
    in_nu,
    in_volts,
)
from clepsydra.papers.row import Row
from clepsydra.papers.settling_bands import BANDS

#: [1/s]
RATES = np.geomspace(1e-3, 10.0, 41)
LIMIT = 10.0
_WIDER = BANDS[1]
#: Td in Ti, the largest share of eighths with which pumps up to 10 V saturate after decoupling.
_DERIVATIVE = 0.125
#: One with which α adjusts the settling nevertheless.
_LIGHT = _DERIVATIVE / 4.0


def run() -> Found:
    """Fill the tanks with many an α."""
    lanes = {f"controller.level_{j}.saturation_rate": RATES for j in (1, 2)}
    volts = fill(in_volts("variable_structure"), LIMIT, parameters=lanes)
    nu = fill(in_nu("variable_structure"), LIMIT, parameters=lanes)
    return (_adjusts(volts, nu), _figure(volts, nu))


def _adjusts(volts: Filling, nu: Filling) -> Row:
    damped, fraction = _differentiated(_DERIVATIVE), 1.0 / _DERIVATIVE
    return PRINTED["section 4, feature (2)", "settling time of h1 over α"].remark(
        f"without decoupling {_told(volts)}; after decoupling, α in ν {_told(nu)}, and with "
        f"derivative action, Td = Ti/{fraction:g}, {_told(damped)}",
        plain=_range(_differentiated(0.0, "input")),
        fraction=fraction,
        damped=_range(_differentiated(_DERIVATIVE, "input")),
        lighter=1.0 / _LIGHT,
        light=_range(_differentiated(_LIGHT)),
        wider=(
            f"without decoupling {_range(volts, _WIDER)}, after it {_range(nu, _WIDER)}, with Td = "
            f"Ti/{fraction:g} {_range(damped, _WIDER)} and with Ti/{1.0 / _LIGHT:g} "
            f"{_range(_differentiated(_LIGHT), _WIDER)} s"
        ),
    )


def _differentiated(share: float, alpha_on: AlphaOn = "virtual") -> Filling:
    """Fill the decoupled tanks with a derivative time, a share of Ti."""
    settings = [Setting(derivative=share)] * len(RATES)
    return filled_with("variable_structure", settings, RATES, alpha_on)


def _range(run: Filling, band: float = BANDS[0]) -> str:
    """Return the shortest and the longest settling of h1 to a band."""
    settled = run.settling(1, band)
    return f"{settled.min():.3g} to {settled.max():.3g}"


def _told(run: Filling) -> str:
    """Return the same with the rates at which it is found."""
    settled = run.settling(1)
    lanes = (int(np.argmin(settled)), int(np.argmax(settled)))
    return " to ".join(f"{settled[lane]:.3g} (α = {RATES[lane]:.2g})" for lane in lanes)


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
