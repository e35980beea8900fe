"""The margins of the loops at the gain that was designed and at the simulator's three times it.

The report gives no margins and no controllers, so that all of it is remarked.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from clepsydra.designs.loop_shaping.coprime_factors import coprime_factors
from clepsydra.designs.loop_shaping.precompensator import Precompensator, precompensator_of
from clepsydra.designs.loop_shaping.robust_controller import robust_controller
from clepsydra.designs.loop_shaping.shaped_plant import shaped_plant
from clepsydra.linear.static_gain import static_gain
from clepsydra.papers.comparison import remark
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_laboratory.closed_loop import Kind
from clepsydra.papers.four_tank_laboratory.controllers import (
    at_the_simulator,
    decentralised,
    dynamic_decoupling,
    robust,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    FULL_LEVEL,
    FULL_VOLTAGE,
    MINIMUM,
    PHASE_MARGIN,
    SENSOR_GAIN,
    SET_UPS,
    SetUp,
    Units,
    course_model,
    plant,
)
from clepsydra.papers.row import Row
from clepsydra.studies.warnings.loop_response import LoopResponse, loop_response

#: As designed, and as the simulator has it.
_UNITS: tuple[Units, ...] = ("volts", "percent")
_KINDS: tuple[Kind, ...] = ("decentralised", "robust")
_NAMES = {"decentralised": "PI", "robust": "Glover-McFarlane"}
_PLACES = {"decentralised": "Exercise 4.1.1", "robust": "Exercise 4.2.1"}


def run() -> Findings:
    """Compute both, since the simulator hands percent to a controller that was made for volts."""
    rows = [_gain_of_the_units()]
    figures = []
    for set_up in SET_UPS:
        rows.append(_designed(set_up))
        rows += [_three_times(set_up, kind) for kind in _KINDS]
        figures.append(_figure(set_up))
    rows.append(_guarantee())
    return Findings(tuple(rows), tuple(figures))


@cache
def _response(set_up: SetUp, kind: Kind, units: Units) -> LoopResponse:
    designed = decentralised(set_up) if kind == "decentralised" else robust(set_up)
    controller = at_the_simulator(designed, plant(set_up, units))
    return loop_response(controller, course_model(set_up, units))


def _gain_of_the_units() -> Row:
    volts = SENSOR_GAIN * FULL_LEVEL
    gains = {units: static_gain(course_model(MINIMUM, units))[0, 0] for units in _UNITS}
    found = gains["percent"] / gains["volts"]
    return remark(
        "Exercises 4.1.1 and 4.2.1", "controllers used in the simulator",
        "“previous designed” controllers are used", f"{found:.3g} times their gain",
        reason=f"The simulator subtracts levels in percent of {FULL_LEVEL:g} cm, {volts:g} V, and "
        f"sends the result to the pumps in percent of {FULL_VOLTAGE:g} V: 1 V/V becomes "
        f"{FULL_VOLTAGE / volts:g} V/V, and the static gain from pump 1 to level 1 in "
        "percent is three times that in volts. Both ranges are the course's and not in the report.",
    )  # fmt: skip


def _designed(set_up: SetUp) -> Row:
    """Ask of each PI loop by itself whether it has the margin that it was designed for."""
    model, controller = course_model(set_up), decentralised(set_up)
    shaped = shaped_plant(model, precompensator_of(controller, model))
    angles = np.geomspace(1e-5, 0.2, 4000)
    loops = np.diagonal(shaped.system.response(angles), axis1=1, axis2=2)
    margins = []
    for loop in loops.T:
        place = int(np.flatnonzero(np.abs(loop) > 1.0)[-1])
        share = math.log(abs(loop[place])) / math.log(abs(loop[place]) / abs(loop[place + 1]))
        angle = angles[place] * (angles[place + 1] / angles[place]) ** share
        turned = np.angle(loop[place]) + share * (np.angle(loop[place + 1] / loop[place]))
        margins.append((math.degrees(math.pi + turned), float(angle) / shaped.period))
    wanted = math.degrees(PHASE_MARGIN), set_up.crossover
    return remark(
        "Exercise 4.1.1", f"PI in volts, {set_up.phase}, each loop by itself",
        "the design is not printed",
        " and ".join(f"{phase:.1f}° at {omega:.3g} rad/s" for phase, omega in margins),
        reason="Sampled loop at the course's levels, designed for the numbers of the course's "
        f"exercise, {wanted[0]:.0f}° at {wanted[1]:g} rad/s.",
    )  # fmt: skip


def _guarantee() -> Row:
    """Ask whether the robust controllers keep the norm that they promise."""
    found = {set_up: _norm(set_up) for set_up in SET_UPS}
    return remark(
        "Exercise 4.2.2", "Glover-McFarlane", "Glover-McFarlane guarantee robust stabilization",
        "; ".join(
            f"{set_up.phase}: γ_min = {smallest:.3f}, γ = {gamma:.3f}, norm {designed:.3f} in "
            f"volts and {tripled:.3g} at three times the gain"
            for set_up, (smallest, gamma, designed, tripled) in found.items()
        ),
        reason="The report's controllers are not printed; ours are designed by the rules of the "
        "course's exercise. It holds in volts: the norm stays below γ, and "
        + " and ".join(f"{100.0 / designed:.0f} %" for *_, designed, _ in found.values())
        + " of the normalised coprime factors of the shaped plant can be off. At the three times "
        "larger gain of the simulator's percent, for which the printed rise times speak, the norm "
        "with the shaped plant at three times its gain is above γ. Norms by a sweep over 4000 "
        "frequencies.",
    )  # fmt: skip


def _norm(set_up: SetUp) -> tuple[float, float, float, float]:
    """Return γ_min, γ, and the norm by a sweep as designed and at three times the gain."""
    model = course_model(set_up)
    shaping: Precompensator = (
        precompensator_of(decentralised(set_up), model)
        if set_up is MINIMUM
        else dynamic_decoupling(set_up)
    )
    shaped = shaped_plant(model, shaping)
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


def _three_times(set_up: SetUp, kind: Kind) -> Row:
    peaks, margins = {}, {}
    for units in _UNITS:
        response = _response(set_up, kind, units)
        peaks[units] = response.loop.maximum_sensitivity
        margins[units] = [response.channels[name].phase_margin for name in response.outputs]
    words = {
        units: f"M_s = {peaks[units]:.2f}, "
        + " and ".join(
            f"{math.degrees(margin.value):.0f}° at {margin.frequency:.3g} rad/s"
            for margin in margins[units]
        )
        for units in peaks
    }
    return remark(
        _PLACES[kind], f"{_NAMES[kind]}, {set_up.phase}, margins",
        "no margins are given",
        f"designed {words['volts']}; in the simulator {words['percent']}",
        reason="Phase margin of each level with the other loop closed, and M_s of both together, "
        "the largest singular value of S. The levels of the linear model, and the simulator's "
        "percent that make the gain three times the designed one, are the course's and not in the "
        "report.",
    )  # fmt: skip


def _figure(set_up: SetUp) -> Figure:
    found = {(kind, units): _response(set_up, kind, units) for kind in _KINDS for units in _UNITS}
    curves = tuple(
        Curve(
            f"{_NAMES[kind]}, {units}",
            response.frequencies,
            np.linalg.norm(response.at_output, 2, axis=(1, 2)),
            "line" if units == "volts" else "dashed",
        )
        for (kind, units), response in found.items()
    )
    return Figure(
        "",
        f"Sensitivity of both loops together, {set_up.phase}",
        (
            Panel(
                "", "largest singular value of S", curves, x_label="frequency [rad/s]",
                logarithmic_x=True, logarithmic_y=True,
            ),
        ),
        "As designed in volts, and in the simulator's percent.",
    )  # fmt: skip
