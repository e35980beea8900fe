"""The keys of a loop in a study file make the form of PID that they name."""

import numpy as np
import pytest
from study_texts import loop

from clepsydra import PidForm
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.linear.linearise import linearise
from clepsydra.loop.loop import Loop
from clepsydra.studies.file.reader import read_study


@pytest.fixture
def made(tmp_path):
    def make(**keys):
        path = tmp_path / "study.toml"
        path.write_text(loop(**keys), encoding="utf-8")
        found = read_study(path)
        model = linearise(found.analysis.operating_point)
        return found.controllers[0].make(found.analysis, model), model, found.scenario

    return make


def form_of(controller):
    (found,) = (block.form for block in controller.law.blocks if isinstance(block, PidBlock))
    return found


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("keys", "form", "parameters"),
    [
        ({"error": '"gap"', "gap": '"5 %"', "gap_gain": 0.1}, PidForm(error="gap"),
         {"level.gap": 0.05, "level.gap_gain": 0.1}),
        ({"error": '"squared"', "squared_error_scale": '"10 %"'}, PidForm(error="squared"),
         {"level.squared_error_scale": 0.1}),
        ({"setpoint_ramp": '"6 %/h"'}, PidForm(setpoint_ramp=True),
         {"level.setpoint_ramp": 0.06 / 3600.0}),
        ({"algorithm": '"velocity"'}, PidForm(algorithm="velocity"),
         {"level.integral_time": 3600.0}),
        ({"remote_setpoint": "true"}, PidForm(remote_setpoint=True),
         {"level.integral_time": 3600.0}),
    ],
)  # fmt: skip
def test_forms_of_a_loop_are_at_rest_and_run(made, keys, form, parameters):
    controller, model, scenario = made(**keys)
    assert form_of(controller) == form
    for name, value in parameters.items():
        assert controller.values[name] == pytest.approx(value, rel=1e-14), name
    assert not any("does not begin at rest" in note for note in controller.notes)
    run = Loop(controller, model).run(scenario)
    assert run.values["outflow"][0] == pytest.approx(0.614, rel=1e-12)
    assert np.all(np.isfinite(run.values["basin.level"]))


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("keys", "form"),
    [
        ({}, PidForm("PID")),
        ({"algorithm": '"series"'}, PidForm("PID", "series")),
        ({"algorithm": '"velocity"'}, PidForm("PID", "velocity")),
        ({"derivative_on": '"error"'}, PidForm("PID", derivative_on="error")),
        ({"anti_windup": '"clamping"'}, PidForm("PID", anti_windup="clamping")),
        ({"remote_setpoint": "false"}, PidForm("PID")),
    ],
)
def test_forms_of_a_loop_with_derivative_action(made, keys, form):
    controller, _, _ = made(actions='"PID"', derivative_time='"6 min"', **keys)
    assert form_of(controller) == form


def test_the_source_chooses_the_setpoint_of_a_loop_that_may_be_remote(made):
    """PI with K = −2 and Ti = 1 h: only the error from the remote setpoint moves the integral."""
    controller, _, _ = made(remote_setpoint="true")
    law = controller.law
    given = {signal.name: signal.initial for signal in law.inputs}
    given |= {"level.sp": 0.5, "level.remote_setpoint": 0.55, "level.pv": 0.5, "time_step": 36.0}
    state = controller.initial_state | {"level.integral": 0.6, "outflow.last_output": 0.6}
    for source, integral in ((0.0, 0.6), (1.0, 0.6 - 2.0 * 36.0 / 3600.0 * 0.05)):
        state |= {
            "level.last_setpoint_source": source,
            "level.working_setpoint": 0.5 + 0.05 * source,
        }
        following, _, _ = law.function(
            [state[entry.name] for entry in law.state],
            [(given | {"level.setpoint_source": source})[signal.name] for signal in law.inputs],
            [controller.values[parameter.name] for parameter in law.parameters],
        )
        names = [entry.name for entry in law.state]
        found = dict(zip(names, np.array(following).ravel(), strict=True))
        assert found["level.integral"] == pytest.approx(integral, rel=1e-12), source
