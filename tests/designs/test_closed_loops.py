"""Designed controllers on the nonlinear tanks: setpoints are reached, limits kept."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from clepsydra import PidForm
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.phase_margin import design_phase_margin
from clepsydra.designs.simc import design_simc

PAIRINGS = {
    "minimum_phase": [("level_1", "pump_1"), ("level_2", "pump_2")],
    "nonminimum_phase": [("level_1", "pump_2"), ("level_2", "pump_1")],
}
DESIGNS = {
    "simc": design_simc,
    "phase margin": design_phase_margin,
    "lqi": lambda model, pairing, **options: design_lqi(model, **options),
}


def run(tank, controller, steps):
    """Return controlled levels and inputs [samples, 2] by RK4, for (setpoints, samples) steps."""
    process, law = tank.process, controller.law
    x, memory, r = (
        ca.SX.sym("x", 4),
        ca.SX.sym("memory", law.function.numel_in(0)),
        ca.SX.sym("r", 2),
    )
    measured = dict(
        zip([s.name for s in process.measurements], ca.vertsplit(50.0 * x), strict=True)
    )
    inputs = {s.name: ca.SX(1.0) for s in law.inputs}
    for name in controller.measurements:
        inputs[f"{name}.pv"] = measured[name]
    for name in controller.setpoints:
        inputs[f"{name}.sp"] = r[("level_1", "level_2").index(name)]
    values = [controller.values[s.name] for s in law.parameters]
    kept, outputs, _ = law.function(
        memory, ca.vertcat(*(inputs[s.name] for s in law.inputs)), values
    )
    moved = dict(zip(controller.manipulated, (outputs[0], outputs[2]), strict=True))
    u = ca.vertcat(*(moved[s.name] for s in process.inputs))
    f, none = process.dynamics, ca.DM(0, 1)
    k1 = f(x, u, none, none)
    k2 = f(x + 0.5 * k1, u, none, none)
    k3 = f(x + 0.5 * k2, u, none, none)
    k4 = f(x + k3, u, none, none)
    after = ca.vertcat(x + (k1 + 2 * k2 + 2 * k3 + k4) / 6, kept)
    shown = ca.vertcat(measured["level_1"], measured["level_2"], u)
    sample = ca.Function("sample", [ca.vertcat(x, memory), r], [after, shown])

    setpoints = [
        [wanted["level_1"], wanted["level_2"]] for wanted, samples in steps for _ in range(samples)
    ]
    start = [*tank.model.point.state, *(controller.initial_state[s.name] for s in law.state)]
    _, found = sample.mapaccum(len(setpoints))(start, np.transpose(setpoints))
    found = np.array(found).T
    return found[:, :2], found[:, 2:]


@pytest.mark.parametrize("phase", list(PAIRINGS))
@pytest.mark.parametrize("name", list(DESIGNS))
def test_a_setpoint_step_is_reached_without_offset(phase, name, request):
    tank = request.getfixturevalue(phase)
    controller = DESIGNS[name](tank.model, PAIRINGS[phase])
    at = tank.model.point.as_dict()
    setpoints = {"level_1": at["level_1"] + 0.5, "level_2": at["level_2"]}
    samples = 1000 if phase == "minimum_phase" else 4000
    levels, moves = run(tank, controller, [(setpoints, samples)])
    assert levels[-1] == pytest.approx([setpoints["level_1"], setpoints["level_2"]], abs=2e-3)
    assert levels[:, 0].max() - setpoints["level_1"] < 0.5 * 0.5
    assert moves.min() >= 0.0
    assert moves.max() <= 10.0


@pytest.mark.parametrize("anti_windup", ["back_calculation", "conditional_integration"])
@pytest.mark.parametrize("name", list(DESIGNS))
def test_a_setpoint_out_of_reach_leaves_no_windup_behind(name, anti_windup, minimum_phase):
    tank = minimum_phase
    option = (
        {"anti_windup": anti_windup}
        if name == "lqi"
        else {"form": PidForm(anti_windup=anti_windup)}
    )
    controller = DESIGNS[name](tank.model, PAIRINGS["minimum_phase"], **option)
    weak_pumps = {f"pump_{i}.high_limit": 4.0 for i in (1, 2)}
    controller = dataclasses.replace(controller, values=controller.values | weak_pumps)
    at = tank.model.point.as_dict()
    rest = {"level_1": at["level_1"], "level_2": at["level_2"]}
    # 4 V in place of 3 V hold 16/9 of the levels, so twice the levels are out of reach.
    out_of_reach = {signal: 2.0 * level for signal, level in rest.items()}
    levels, moves = run(tank, controller, [(out_of_reach, 600), (rest, 1000)])
    assert levels[599] == pytest.approx([16 / 9 * level for level in rest.values()], rel=1e-2)
    # Clamping lets one increment of the integral go and takes it back.
    assert moves[50:600].min() > 3.5
    assert moves.min() >= 0.0
    assert moves.max() == 4.0
    # An error of 1.3 V for 600 s would wind up the LQI's integral by 80 V and the PI's by at
    # least as much, and keep the pumps on for minutes. These turn down within 20 s.
    assert np.all(moves[620] < 3.0)
    assert levels[-1] == pytest.approx([rest["level_1"], rest["level_2"]], abs=1e-3)
