"""Engine, C and Structured Text of feedback linearisation, equal in every bit."""

from pathlib import Path

import numpy as np
import pytest
from deployed import no_output_lay_idle, run_alike
from plants import designed
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
    engine = run_alike(program, folder, inputs)
    no_output_lay_idle(program, engine, (1, 2, 4, 8, 16, 32, 64), 100)
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
