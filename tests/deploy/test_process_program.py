"""A process as a printable program: bit for bit CasADi's own evaluation, and the loop's motion."""

from collections import Counter

import numpy as np
import pytest
from plants import STRUCTURES, every_variant, plant

from clepsydra import Kernel
from clepsydra.deploy.process_program import process_program
from clepsydra.loop.open_loop import simulate
from clepsydra.loop.step_size import substeps_for

SAMPLES = 300


def profiles(point, seed: int) -> dict[str, np.ndarray]:
    """Inputs and disturbances that step about their values at the point, within their ranges."""
    generator, at = np.random.default_rng(seed), point.as_dict()
    found = {}
    for signal in (*point.process.inputs, *point.process.disturbances):
        size = 0.3 * signal.span if np.isfinite(signal.span) else 0.2 * abs(at[signal.name])
        values = at[signal.name] + size * generator.uniform(-1, 1, SAMPLES // 20)
        found[signal.name] = np.clip(np.repeat(values, 20), signal.low, signal.high)
    return found


@pytest.mark.sampled
@pytest.mark.parametrize("name", STRUCTURES)
def test_it_moves_as_the_simulation_does(name):
    point, substeps = plant(name).point, substeps_for(plant(name).linear)
    program = process_program(point, substeps)
    assert not any(operation.fused for operation in program.block.operations())
    given = profiles(point, 3)
    run = simulate(point, given, substeps=substeps)
    found = Kernel(program).run(SAMPLES, inputs=given)
    for signal in program.outputs:
        expected = run.values[signal.name][1:]
        scale = max(float(np.max(np.abs(expected))), 1e-9)
        # A fused operation rounds once where an unfused one rounds twice; events repeat steps.
        assert found.output(signal.name)[0] == pytest.approx(expected, abs=1e-9 * scale)
        assert signal.initial == pytest.approx(run.values[signal.name][0], abs=1e-12 * scale)


@pytest.mark.sampled
@pytest.mark.parametrize("name", STRUCTURES)
def test_it_stays_at_rest(name):
    program = process_program(plant(name).point, substeps_for(plant(name).linear))
    found = Kernel(program).run(50)
    for signal in program.outputs:
        scale = max(abs(signal.initial), 1e-6)
        assert found.output(signal.name)[0] == pytest.approx(
            np.full(50, signal.initial), abs=1e-7 * scale
        )


@pytest.mark.thorough
@pytest.mark.parametrize("name", every_variant())
def test_every_variant_computes_what_one_that_is_tested_here_does(name):
    """Its program has the same operations, each as often."""

    def computed(name: str) -> Counter[str]:
        operations = process_program(plant(name).point, 2).block.operations()
        return Counter(operation.code for operation in operations)

    of_process = (each for each in STRUCTURES if name.startswith(each.partition(":")[0]))
    assert any(computed(name) == computed(each) for each in of_process)


def test_no_two_names_of_a_function_block_clash():
    program = process_program(plant("quadruple-tank").point, 2)
    groups = (program.state, program.inputs, program.parameters, program.outputs)
    names = [entry.name.replace(".", "_").lower() for group in groups for entry in group]
    assert len(names) == len(set(names))
