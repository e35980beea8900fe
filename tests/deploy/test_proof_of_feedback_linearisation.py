"""Engine, C and Structured Text of feedback linearisation, equal in every bit."""

from pathlib import Path

import numpy as np
import pytest
from deployed import all_bits, run_both
from plants import designed
from test_proof import simulated
from test_proof_of_structures import scans

#: What `anti_windup` may be.
ANTI_WINDUPS = (
    "variable_structure", "back_calculation", "conditional_integration", "clamping", "none",
)  # fmt: skip
FULL = Path(__file__).parents[1] / "controllers" / "full-effects.toml"

pytestmark = pytest.mark.thorough


def proven(controller, folder, seed):
    """Run the scans of a plant that goes wrong, with levels within the ranges of the sensors."""
    program = controller.program()
    inputs = scans(program, seed)
    for signal in program.inputs:
        if signal.part in ("pv", "sp", "manual", "tracking"):
            # They are made for ranges from 0 to 10.
            column, span = inputs[signal.name], controller.plant.process.signal(signal.owner).high
            inputs[signal.name] = np.where(np.abs(column) < 100.0, column * span / 10.0, column)
    engine = simulated(program, inputs)
    in_c, in_text = run_both(program, folder, inputs)
    assert np.isfinite(engine).all()
    assert np.array_equal(all_bits(engine), all_bits(in_c))
    assert np.array_equal(all_bits(engine), all_bits(in_text))
    for column, output in enumerate(program.outputs):
        if output.part == "status":
            word = engine[:, column].astype(int)
            for bit in (1, 2, 4, 8, 16, 32, 64):
                assert np.any(word & bit) and not np.all(word & bit), (output, bit)
        else:
            assert len(np.unique(engine[:, column])) > 100, output
    for column, entry in enumerate(program.state, start=len(program.outputs)):
        if entry.part == "was_in_force":
            assert set(engine[:, column]) == {0.0, 1.0}
        elif not entry.part.startswith("last_") or entry.part == "last_output":
            assert len(np.unique(engine[:, column])) > 50, entry.name


@pytest.mark.parametrize("anti_windup", ANTI_WINDUPS)
def test_every_anti_windup(anti_windup, tmp_path):
    controller = designed("feedback_linearisation", "quadruple-tank", anti_windup=anti_windup)
    proven(controller, tmp_path, seed=3)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("three-tanks", {}),
        ("quadruple-tank", {"alpha_on": "input"}),
        (FULL, {}),
    ],
    ids=["third-order", "alpha-in-volts", "full-decoupling-matrix"],
)
def test_every_shape(name, options, tmp_path):
    controller = designed("feedback_linearisation", name, **options)
    proven(controller, tmp_path, seed=4)


def test_with_an_observer_of_the_process(tmp_path):
    controller = designed(
        "feedback_linearisation", "quadruple-tank", measurements=("level_1", "level_2")
    )
    assert controller.measurements == ("level_1", "level_2")
    proven(controller, tmp_path, seed=5)
