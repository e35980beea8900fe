"""With sound signals and no settings a shell changes nothing, in any bit."""

from pathlib import Path

import numpy as np
import pytest
from scan_rig import designed

import clepsydra as cl
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.operation import EXACT

DEAD_TIME = Path(__file__).parents[2] / "dead-time.toml"
FAMILIES = [
    ("PI, SIMC", "quadruple-tank"),
    ("PI, SIMC, dynamic decoupling", "quadruple-tank"),
    ("PI, variable structure", "quadruple-tank"),
    ("PID, phase margin", "quadruple-tank"),
    ("LQI, Bryson", "quadruple-tank"),
    ("LQI with Kalman filter", "quadruple-tank"),
    ("2DOF polynomial, LQ", "quadruple-tank"),
    ("Feedback linearisation", "quadruple-tank"),
    ("One-step inverse", "averaging-tank"),
    ("Fuzzy PI", "quadruple-tank"),
    ("Glover-McFarlane on PI, SIMC", "quadruple-tank"),
    ("PI, gain scheduling", "averaging-tank"),
    ("Smith predictor, LQ", DEAD_TIME),
    ("Smith predictor, PI", DEAD_TIME),
    ("Start/stop levels", "wet-well:start-stop"),
]


@pytest.mark.sampled
@pytest.mark.parametrize(("name", "process"), FAMILIES)
def test_a_loop_with_the_shell_is_the_loop_without_it(name, process):
    controller, plant = designed(name, process)
    shelled = with_plant_shell(controller, plant.process.sampling_period)
    scenario = default_scenario(plant.linear)
    bare = Loop(controller, plant.linear).run(scenario)
    found = Loop(shelled, plant.linear).run(scenario)
    assert set(bare.values) == set(found.values)
    for signal, values in bare.values.items():
        assert np.array_equal(values.view(np.int64), found.values[signal].view(np.int64)), signal
    moved = [bare.values[u] for u in controller.manipulated]
    assert any(len(np.unique(column)) > 1 for column in moved)


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "process"), FAMILIES)
def test_the_shell_adds_only_what_every_target_computes_alike(name, process, tmp_path):
    controller, plant = designed(name, process)
    program = with_plant_shell(controller, 1.0).program()
    # Whole numbers that a target could not hold would be refused.
    cl.export(controller, plant, tmp_path, to="c")
    operations = list(program.block.operations())
    own = {operation.code for operation in controller.program().block.operations()}
    assert {operation.code for operation in operations} - own <= EXACT
    assert not any(operation.fused for operation in operations)
    names = [
        entry.name
        for group in (program.state, program.inputs, program.parameters, program.outputs)
        for entry in group
    ]
    assert len(names) == len(set(names))


def test_counted_loops_stay_loops_and_names_stay_names():
    controller, _ = designed("Fuzzy PI", "quadruple-tank")
    bare, shelled = controller.program(), with_plant_shell(controller, 1.0).program()
    assert "law" not in {call.instance for call in shelled.calls}  # it only joins blocks

    def loops(program):
        own = [s.name for s in program.block.statements if hasattr(s, "count")]
        return own + [name for call in program.calls for name in loops(call.program)]

    assert loops(bare) == loops(shelled) != []

    def names(program):
        # What a law tells of its bits goes into the status word of the shell.
        own = {name for name in program.names.values() if "status_" not in name}
        return own.union(*(names(call.program) for call in program.calls))

    assert set() != names(bare) <= names(shelled)


@pytest.mark.thorough
def test_the_reference_solver_runs_it_too():
    controller, plant = designed("PI, SIMC", "quadruple-tank")
    shelled = with_plant_shell(controller, 1.0)
    events = [cl.step("level_1", "+1 V", at=20), cl.disturbance("inflow_1", "+10 %", at=300)]
    fast, slow = (
        cl.simulate(plant, shelled, events, duration=600, solver=solver)
        for solver in ("kernel", "reference")
    )
    for name in shelled.manipulated:
        assert np.max(np.abs(fast.values[name] - slow.values[name])) < 1e-5
