"""The margins of the loops at the gain that was designed and at the simulator's three times it.

The report gives no margins; what it claims of robustness is judged by them.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from clepsydra.designs.loop_shaping.coprime_factors import coprime_factors
from clepsydra.designs.loop_shaping.robust_controller import robust_controller
from clepsydra.designs.loop_shaping.shaped_plant import shaped_plant
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Curve, CurveKind, Figure, Panel
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.controllers import (
    Kind,
    Lagged,
    at_the_simulator,
    shaping_of,
)
from clepsydra.papers.four_tank_laboratory.readings import LAGS_IN_WORDS
from clepsydra.papers.four_tank_laboratory.set_ups import (
    FULL_LEVEL,
    FULL_VOLTAGE,
    MINIMUM,
    NON_MINIMUM,
    SENSOR_GAIN,
    SET_UPS,
    SetUp,
    Units,
    course_model,
    plant,
)
from clepsydra.papers.four_tank_laboratory.words import AS_RUN, GIVEN, controllers
from clepsydra.papers.row import Row
from clepsydra.studies.warnings.loop_response import LoopResponse, loop_response

#: As designed, and as the simulator has it.
_UNITS: dict[Units, CurveKind] = {"volts": "line", "percent": "dashed"}
_AT_GAIN: dict[Units, str] = {"volts": "as designed", "percent": "at three times the gain"}
NAMES: dict[Kind, str] = {"decentralised": "PI", "robust": "Glover-McFarlane"}


def run() -> Found:
    """Compute both, since the simulator hands percent to a controller that was made for volts."""
    figures = tuple(_figure(set_up) for set_up in SET_UPS)
    return (_robustness("decentralised"), _robustness("robust"), _guarantee(), *figures)


@cache
def response(set_up: SetUp, kind: Kind, units: Units, lagged: Lagged = "all") -> LoopResponse:
    """Return what a loop does to a sine, as designed or in the simulator's percent."""
    controller = at_the_simulator(set_up, kind, plant(set_up, units), lagged)
    return loop_response(controller, course_model(set_up, units))


def _robustness(kind: Kind) -> Row:
    """Ask whether the non-minimum phase has the higher peak of the sensitivity."""
    lags = tuple(LAGS_IN_WORDS)[: 2 if kind == "robust" else 1]
    peaks = {
        units: (
            _peak(MINIMUM, kind, units),
            [_peak(NON_MINIMUM, kind, units, lagged) for lagged in lags],
        )
        for units in _UNITS
    }
    told = (
        f"M_s {one:.2f} in minimum phase and {' or '.join(f'{each:.2f}' for each in others)} in "
        f"non-minimum phase {_AT_GAIN[units]}"
        for units, (one, others) in peaks.items()
    )
    line = PRINTED["Exercise 4.1.2" if kind == "decentralised" else "Exercise 4.2.3", "robustness"]
    holds = all(one < min(others) for one, others in peaks.values())
    line = line.told(controllers=controllers(SET_UPS, (kind,)), gain=f"{AS_RUN}.", given=GIVEN)
    return line.claimed(holds, "; ".join(told))


def _peak(set_up: SetUp, kind: Kind, units: Units, lagged: Lagged = "all") -> float:
    return float(response(set_up, kind, units, lagged).loop.maximum_sensitivity)


def _guarantee() -> Row:
    """Ask whether the robust controllers keep the norm that they promise."""
    cases: dict[str, tuple[SetUp, Lagged]] = {
        MINIMUM.phase: (MINIMUM, "all"),
        NON_MINIMUM.phase: (NON_MINIMUM, "all"),
        "the same with a lag of W's diagonal alone": (NON_MINIMUM, "diagonal"),
    }
    found = {name: _norm(*case) for name, case in cases.items()}
    told = (
        f"{name}: γ_min = {smallest:.3f}, γ = {gamma:.3f}, norm {designed:.3f} in volts and "
        f"{tripled:.3g} at three times the gain"
        for name, (smallest, gamma, designed, tripled) in found.items()
    )
    line = PRINTED["Exercise 4.2.2", "Glover-McFarlane"]
    line = line.told(controllers=controllers(SET_UPS, ("robust",)), gain=f"{AS_RUN}.", given=GIVEN)
    assert all(designed < gamma < tripled for _, gamma, designed, tripled in found.values())
    loops = [response(case, "robust", "percent", lagged).loop for case, lagged in cases.values()]
    assert all(loop.is_stable for loop in loops)
    return line.remark("; ".join(told))


def _norm(set_up: SetUp, lagged: Lagged) -> tuple[float, float, float, float]:
    """Return γ_min, γ, and the norm by a sweep as designed and at three times the gain."""
    shaped = shaped_plant(course_model(set_up), shaping_of(set_up, lagged))
    factors = coprime_factors(shaped.system)
    controller = robust_controller(factors)
    angles = np.concatenate([np.geomspace(1e-6, math.pi, 4000), [math.pi]])
    K, one = controller.system.response(angles), np.eye(2)

    def norm(G: np.ndarray) -> float:
        sensitivity = np.linalg.inv(one - G @ K)
        inner = np.concatenate([np.broadcast_to(one, G.shape), G], axis=2)
        outer = np.concatenate([K, np.broadcast_to(one, K.shape)], axis=1)
        return float(np.linalg.norm(outer @ sensitivity @ inner, 2, axis=(1, 2)).max())

    plant_response = shaped.system.response(angles)
    tripled = FULL_VOLTAGE / (SENSOR_GAIN * FULL_LEVEL) * plant_response
    return factors.smallest_gamma, controller.gamma, norm(plant_response), norm(tripled)


def _figure(set_up: SetUp) -> Figure:
    shown = [
        Curve(f"{name}, {units}", each.frequencies, np.linalg.norm(each.at_output, 2, (1, 2)), look)
        for kind, name in NAMES.items()
        for units, look in _UNITS.items()
        for each in [response(set_up, kind, units)]
    ]
    label = "largest singular value of S"
    return Figure(
        "",
        f"Sensitivity of both loops together, {set_up.phase}",
        (Panel("", label, shown, "frequency [rad/s]", logarithmic_x=True, logarithmic_y=True),),
        "As designed in volts, and in the simulator's percent.",
    )
