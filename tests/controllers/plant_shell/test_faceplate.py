"""What an operator sees of a loop: its signals, and the terms that make its output."""

from functools import cache

import numpy as np
import pytest
from pid_rig import forms, name_of
from scheme_rig import PUMP, cascade
from shell_rig import one_loop, scans

from clepsydra import Kernel, PidForm
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.program.defaults import with_defaults


def ran(controller):
    """All inputs and outputs of a controller in its shell, and where status is automatic alone."""
    soon = PlantShell(sensor_delay=dict.fromkeys(controller.measurements, 1.0))
    shelled = with_plant_shell(controller, 1.0, soon)
    program = with_defaults(shelled.program(), {**shelled.values, **shelled.initial_state})
    inputs = scans(shelled, 20_000)
    run = Kernel(program).run(20_000, inputs=inputs)
    found = {signal.name: run.output(signal.name)[0] for signal in program.outputs}
    free = found[f"{controller.manipulated[0]}.status"] == 1
    assert free.sum() > 100
    return inputs, found, free


@cache
def ran_loop(form):
    return ran(one_loop(form))


@pytest.mark.parametrize("form", [*forms(), *forms("gap")], ids=name_of)
def test_the_terms_add_up_to_what_the_loop_asks_for(form):
    _, found, free = ran_loop(form)
    terms = "" if form.algorithm == "velocity" else "pid" if form.has_derivative else "pi"
    parts = [f"level_1.faceplate.{term}_part" for term in terms]
    assert {name for name in found if name.endswith("_part")} == {*parts}
    if terms:
        total = sum(found[part] for part in parts)
        np.testing.assert_allclose(total[free], found["level_1.faceplate.op"][free], rtol=1e-9)


@pytest.mark.parametrize("form", [PidForm(), PidForm("PID", "velocity")], ids=name_of)
def test_the_output_shown_is_what_stands_at_the_actuator_whatever_fails(form):
    _, found, _ = ran_loop(form)
    np.testing.assert_array_equal(found["level_1.faceplate.op"], found["pump_1.out"])
    assert found["pump_1.conditions.failed_safe"].any()


def test_the_error_is_that_of_the_setpoint_shown():
    signals, found, free = ran_loop(PidForm())
    shown = {part: found[f"level_1.faceplate.{part}"][free] for part in ("pv", "sp", "error")}
    np.testing.assert_array_equal(shown["error"], shown["sp"] - shown["pv"])
    np.testing.assert_array_equal(shown["pv"], signals["level_1.pv"][free])


def test_the_outer_loop_shows_the_setpoint_that_the_inner_one_got():
    law = cascade()
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    state = {entry.name: entry.initial for entry in law.state}
    controller = Controller(
        "Cascade", "cascade", "Of a test.", law, values,
        {name: value for name, value in state.items() if name.replace("last_", "") not in values},
        ("level", "flow"), ("level",), (PUMP.name,),
        free_inputs={"flow.local_setpoint": 5.0, "flow.setpoint_source": 1.0},
    )  # fmt: skip
    signals, found, free = ran(controller)
    remote = free & (signals["flow.setpoint_source"] == 1)
    outer, inner = found["level.faceplate.op"], found["flow.faceplate.sp"]
    np.testing.assert_array_equal(outer[remote], inner[remote])
    assert remote.sum() > 100
