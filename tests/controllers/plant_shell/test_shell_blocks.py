"""The shell in blocks computes what it computes in place, and keeps its state in them."""

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scan_rig import designed
from shell_rig import one_loop, scans, shelled_loop

from clepsydra import Kernel
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.plant_shell.status import SHELL_STATUS_BITS
from clepsydra.deploy.printing.whole_numbers import check_whole_results
from clepsydra.program.defaults import with_defaults
from clepsydra.program.owned_state import owned_by_calls, with_owned_state
from clepsydra.program.precision import in_precision
from clepsydra.program.reader import program_of, structured_program_of
from clepsydra.program.step_law import Equations, step_law

DEAD_TIME = Path(__file__).parents[2] / "dead-time.toml"


def shelled(name, process):
    controller, plant = designed(name, process)
    first, *_ = controller.measurements
    settings = PlantShell(sensor_delay={first: 3.0 * plant.process.sampling_period})
    return with_plant_shell(controller, plant.process.sampling_period, settings)


@pytest.mark.parametrize(
    ("name", "process"),
    [
        ("PI, SIMC", "quadruple-tank"),
        ("LQI, Bryson", "quadruple-tank"),
        ("Fuzzy PI", "quadruple-tank"),
        ("Smith predictor, LQ", DEAD_TIME),
        ("Start/stop levels", "wet-well:start-stop"),
    ],
)
def test_blocks_compute_the_bits_of_the_flat_law(name, process):
    controller = shelled(name, process)
    structured = structured_program_of(controller.law)
    owned = with_owned_state(structured)
    for precision in ("double", "single"):
        check_whole_results(in_precision(owned, precision), precision)
    start, inputs = {**controller.values, **controller.initial_state}, scans(controller, 600)
    flat, *kept = [
        Kernel(with_defaults(form, start)).run(600, inputs=inputs)
        for form in (program_of(controller.law), structured, owned)
    ]
    for signal in controller.law.outputs:
        (expected,) = flat.output(signal.name)
        owner, _, record = signal.owner.rpartition(".")
        if record == "conditions":
            (word,) = flat.output(f"{owner}.status")
            bit = word.astype(int) & SHELL_STATUS_BITS[signal.part].value
            np.testing.assert_array_equal(expected, bit > 0)
        else:
            assert len(np.unique(expected)) > 1
        for found in kept:
            (values,) = found.output(signal.name)
            np.testing.assert_array_equal(values.view(np.int64), expected.view(np.int64))


def test_the_state_of_the_shell_lives_in_instances_named_after_the_signals():
    program = with_owned_state(shelled("PI, SIMC", "quadruple-tank").program())
    instances = [call.identifier for call in program.calls]
    for name in ("level_1_check", "level_1_ramp", "pump_2_command", "pump_2_end"):
        assert instances.count(name) == 1
    owned = owned_by_calls(program)
    left = [entry.name for place, entry in enumerate(program.state) if place not in owned]
    # The law shares the last outputs, and a whole number starts with none but zero.
    assert left == ["pump_1.last_output", "pump_2.last_output", "valid_take_up_scans"]
    checks = [call.program for call in program.calls if call.identifier in
              ("level_1_check", "level_2_check")]  # fmt: skip
    assert len(checks) == 2 and checks[0] == checks[1]


def test_a_law_that_tells_its_bits_is_not_asked_for_its_word():
    bare = one_loop()

    def telling(symbols):
        found = bare.law.equations(symbols)
        word = found.outputs["pump_1.status"]
        told = {}
        for name, bit in STATUS_BITS.items():
            upper = ca.floor(word / (2 * bit.value))
            told[f"pump_1.status_{name}"] = ca.floor(word / bit.value) - 2 * upper == 1
        # A step of its own, so that the law is more than the blocks that it joins.
        out = {"pump_1.out": ca.fmin(1e9, found.outputs["pump_1.out"])}
        return Equations(found.next_state, found.outputs | out, {**found.intermediates, **told})

    law = bare.law
    told = step_law(
        law.name, inputs=law.inputs, parameters=law.parameters, state=law.state,
        outputs=law.outputs, equations=telling,
    )  # fmt: skip
    shelled = with_plant_shell(replace(bare, law=told), 1.0)
    (block,) = (
        call.program for call in structured_program_of(shelled.law).calls if call.instance == "law"
    )
    ports = {signal.name: signal.kind for signal in block.outputs}
    assert "pump_1.status" not in ports and ports["pump_1.status_invalid_input"] == "boolean"
    inputs, count = scans(shelled, 600), 600
    found, expected = (
        Kernel(each.program()).run(count, inputs=inputs).output("pump_1.status")[0]
        for each in (shelled, shelled_loop(1.0).controller)
    )
    assert len(np.unique(expected)) > 20
    np.testing.assert_array_equal(found, expected)
