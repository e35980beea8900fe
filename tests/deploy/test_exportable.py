"""A controller made ready for a plant: what its block does before anything is wired to it."""

from dataclasses import replace

import pytest

from clepsydra.base.errors import InputError
from clepsydra.deploy.exportable import exportable, exportable_name
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process
from clepsydra.study.designs import DESIGNS

CASES = [
    ("quadruple-tank", "PI, SIMC"),
    ("equalisation-tank", "PI, arrest time"),
    ("eight-tanks", "Smith predictor, LQ"),
    ("wet-well:start-stop", "Start/stop levels"),
    ("averaging-tank", "Fuzzy PI"),
]


@pytest.fixture(params=CASES, ids=lambda case: case[1])
def ready(request):
    process, name = request.param
    analysis = analyse(load_process(process))
    return exportable(DESIGNS[name](analysis), analysis.operating_point)


def test_a_block_that_nobody_wired_stands_in_manual_where_the_process_rests(ready):
    inputs = {signal.name: signal.initial for signal in ready.program.inputs}
    at = ready.point.as_dict()
    assert inputs["time_step"] == ready.process.sampling_period
    for number, name in enumerate(ready.controller.manipulated, start=1):
        assert inputs[f"mode_{number}"] == 0.0
        assert inputs[f"manual_{number}"] == inputs[f"tracking_{number}"] == at[name]
    for number, name in enumerate(ready.controller.measurements, start=1):
        assert inputs[f"measurement_{number}"] == at[name]
    for number, name in enumerate(ready.controller.setpoints, start=1):
        assert inputs[f"setpoint_{number}"] == at[name]


def test_its_outputs_begin_where_its_state_says(ready):
    outputs = {signal.name: signal.initial for signal in ready.program.outputs}
    state = {entry.name: entry for entry in ready.program.state}
    for number in range(1, len(ready.controller.manipulated) + 1):
        assert outputs[f"manipulated_{number}"] == state[f"last_output_{number}"].initial


def test_every_number_has_a_source(ready):
    for entry in (*ready.program.parameters, *ready.program.state):
        assert ready.origin.source_of(entry)


def test_a_name_of_which_no_letter_is_left_is_refused(ready):

    with pytest.raises(InputError, match="a name with a letter"):
        exportable_name(ready.process, replace(ready.controller, name="泵"))
