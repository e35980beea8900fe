"""Polynomial controllers and Smith predictors: engine, C and Structured Text in every bit."""

import numpy as np
import pytest
from deployed import run_alike
from plants import ONE_TANK, designed
from test_proof_of_structures import scans

from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.program.defaults import with_defaults
from clepsydra.program.entries import signal_of

LAG = SampledModel((0.1,), (-0.9,), 0, 1.0)
LONG = SampledModel((0.1, 0.05), (-1.2, 0.3), 3, 1.0)
SHORT = SampledModel((0.1, 0.05, 0.01), (-1.2, 0.3), 1, 1.0)
INTEGRATING = SampledModel((0.1,), (-1.5, 0.5), 17, 1.0)
PRINTED = SampledModel((0.0309 * 60, 0.0286 * 60), (-1.777, 0.7964), 5, 60.0)
#: Design, plant and options; the models of the loops give the law its shape.
LAWS = {
    "plain": ("polynomial", ONE_TANK, {}),
    "increments, two loops": ("polynomial", "quadruple-tank", {"models": (LONG, LAG)}),
    "predictor of the document": (
        "smith_predictor", "eight-tanks",
        {"models": (PRINTED,), "penalty": 36_000.0, "assigned_poles": (0.5,)},
    ),
    "gains on the setpoint": (
        "smith_predictor", "quadruple-tank", {"models": (LAG, SHORT), "primary": "PI"},
    ),
    "error feedback": ("smith_predictor", "quadruple-tank", {"models": (INTEGRATING, SHORT)}),
}  # fmt: skip

pytestmark = pytest.mark.thorough


#: Stable models and lively gains, and what has one value.
RANGES = {
    "model_feedback": (-0.45, -0.2), "model_gain": (0.05, 0.7), "model_share": (0.05, 0.7),
    "error_feedback": (0.05, 0.7), "reference_gain": (0.05, 0.3), "measurement_gain": (-0.5, 0.5),
    "increment_gain": (-0.5, 0.5), "setpoint_gain": (-0.5, 0.5),
}  # fmt: skip
FIXED = {"bias": 4.7, "reference": 4.7, "low_limit": -2.0, "high_limit": 11.0}


def settings(program, seed):
    """Settings none of which has a short binary form, but for the fixed ones."""
    random = np.random.default_rng(seed)
    kinds = {parameter.name: parameter.name.split(".")[1] for parameter in program.parameters}
    return {
        name: FIXED[kind] if kind in FIXED else float(random.uniform(*RANGES[kind]))
        for name, kind in kinds.items()
    }


@pytest.mark.parametrize("name", LAWS)
def test_engine_c_and_structured_text_are_equal_in_every_bit(name, tmp_path):
    design, process, options = LAWS[name]
    program = designed(design, process, **options).program()
    program = with_defaults(program, settings(program, seed=len(name)))
    inputs = scans(program, seed=len(name) + 1)
    engine = run_alike(program, tmp_path, inputs)
    assert np.max(np.abs(engine)) < 1e4
    # Nothing lay idle: every output and state moved, and every status bit but that of rates.
    for column, signal in enumerate((*program.outputs, *map(signal_of, program.state))):
        if signal.part == "status":
            word = engine[:, column].astype(int)
            for bit in (1, 2, 4, 8, 16, 32, 64):
                assert np.any(word & bit) and not np.all(word & bit), (signal.name, bit)
        else:
            assert len(np.unique(engine[:, column])) > 50, signal.name
