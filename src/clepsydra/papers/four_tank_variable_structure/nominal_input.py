"""Section 4: the nominal control amount u_n of (14), and how far it stands from its range."""

from __future__ import annotations

from itertools import product

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.readings import (
    COMPARED,
    LANE,
    LIMITS,
    READING,
    SATURATED,
    decoupled,
)
from clepsydra.papers.four_tank_variable_structure.rig import (
    ALPHA,
    SETTINGS,
    VOLTS_PER_METRE,
    Filling,
    plant,
)
from clepsydra.papers.row import Row

_GRAVITY = 981.0  # [cm/s²]
#: The largest distance is told from here on [V].
_FROM = 6.0


def run() -> Found:
    """Return the rows on u_n."""
    return (_switch(), _distance())


def _switch() -> Row:
    """Ask on which side of its range e moves u_n, and whether the condition says the same."""
    low, high = 0.0, 10.0
    middle = 0.5 * (low + high)
    agrees = [
        (error * (nominal - middle) > 0.0)
        == (abs(_beyond(nominal + error, high)) > abs(_beyond(nominal, high)))
        for nominal, error in product((-40.0, -3.0, 13.0, 40.0), (-1.0, 1.0))
    ]
    return PRINTED["(14)", "condition of the switch"].stated(
        "e moves u_n away from its range", all(agrees)
    )


def _beyond(nominal: float, high: float) -> float:
    return float(nominal - np.clip(nominal, 0.0, high))


def distances(filling: Filling, rate: float, loop: int) -> np.ndarray:
    """Return how far u_n stands from its range [V], [lanes, samples], after decoupling.

    It is solved from levels and voltages of a run: u_n = (ν − L)/E, with ν by PI on the level and
    its integral by (14), whose α [1/s] is zero for conventional PID.
    """
    settings, step = SETTINGS[loop - 1], filling.time[1] - filling.time[0]
    process = plant()

    def of(name: str) -> float:
        return process.signal(name).initial

    # In centimetres; the pumps give cm³/(V s).
    area, upper = 1e4 * of(f"tank_{loop}.area"), loop + 2
    effect = 1e6 * of(f"splitter_{loop}.tank_{loop}") * of(f"pump_{loop}.gain") / area
    flows = (
        1e4 * of(f"outlet_{tank}.area") * np.sqrt(2.0 * _GRAVITY * filling.level(tank))
        for tank in (loop, upper)
    )
    out, into = flows
    drift = (into - out) / area / effect
    target = 100.0 * filling.target[loop - 1]
    errors = VOLTS_PER_METRE / 100.0 * (target - filling.level(loop))
    high = filling.limits
    integral, beyond = np.zeros(len(high)), np.empty_like(errors)
    for sample, error in enumerate(errors.T):
        nominal = settings.gain * error + integral - drift[:, sample]
        excess = nominal - np.clip(nominal, 0.0, high)
        beyond[:, sample] = excess
        is_back = (excess != 0.0) & (error * (nominal - 0.5 * high) > 0.0) & (rate > 0.0)
        ahead = settings.gain / settings.integral_time * error
        integral = integral + step * np.where(is_back, -rate * excess, ahead)
    return np.abs(beyond)


def _distance() -> Row:
    shares: dict[str, list[np.ndarray]] = {"sum": [], "max": []}
    means = []
    for pump in (1, 2):
        saturates = decoupled("none").saturated(pump) >= SATURATED
        new, old = (
            distances(decoupled(way), rate, pump)
            for way, rate in zip(COMPARED, (ALPHA, 0.0), strict=True)
        )
        for what, lanes in (("sum", saturates), ("max", saturates & (LIMITS >= _FROM))):
            one, other = (getattr(np, what)(each[lanes], axis=1) for each in (new, old))
            shares[what].append(one / other)
        found = (each[LANE][each[LANE] > 0.0].mean() for each in (new, old))
        means.append(" against ".join(f"{each:.2f}" for each in found))
    sums, largest = (np.concatenate(each) for each in shares.values())
    line = PRINTED["section 4, feature (3)", "distance of u_n from its limit"]
    return line.remark(
        f"{' and '.join(means)} V, mean over the time beyond it",
        least=sums.min(),
        most=sums.max(),
        largest=largest.min(),
        reading=READING,
    )
