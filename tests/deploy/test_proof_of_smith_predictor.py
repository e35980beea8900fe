"""Polynomial controllers and Smith predictors: engine, C and Structured Text in every bit."""

import numpy as np
import pytest
from deployed import all_bits, run_both
from plants import ONE_TANK, designed
from test_proof import simulated
from test_proof_of_structures import scans

from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.program.defaults import with_defaults
from clepsydra.program.delay_ring import DelayRing

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


def settings(program, seed):
    """Stable models and lively gains, none with a short binary form."""
    random = np.random.default_rng(seed)
    values = {}
    for parameter in program.parameters:
        name = parameter.name
        if name.startswith("model_feedback"):
            values[name] = float(random.uniform(-0.45, -0.2))
        elif name.startswith(("model_gain", "model_share", "error_feedback")):
            values[name] = float(random.uniform(0.05, 0.7))
        elif name.startswith(("bias", "reference")):
            values[name] = 4.7
        elif name.startswith("reference_gain"):
            values[name] = float(random.uniform(0.05, 0.3))
        elif "_gain_" in name:
            values[name] = float(random.uniform(-0.5, 0.5))
        else:
            values[name] = -2.0 if name.startswith("low") else 11.0
    return values


@pytest.mark.parametrize("name", LAWS)
def test_engine_c_and_structured_text_are_equal_in_every_bit(name, tmp_path):
    design, process, options = LAWS[name]
    program = designed(design, process, **options).program()
    program = with_defaults(program, settings(program, seed=len(name)))
    inputs = scans(program, seed=len(name) + 1)
    engine = simulated(program, inputs)
    in_c, in_text = run_both(program, tmp_path, inputs)
    # The engine shows what goes into a ring, the printed programs what the next scan reads.
    for column, entry in enumerate(program.state, start=len(program.outputs)):
        if isinstance(entry, DelayRing):
            written = np.concatenate([np.zeros(entry.length - 1), engine[:, column]])
            engine[:, column] = written[: len(engine)]
    assert np.max(np.abs(engine)) < 1e4
    assert np.array_equal(all_bits(engine), all_bits(in_c))
    assert np.array_equal(all_bits(engine), all_bits(in_text))
    # Nothing lay idle: every output and state moved, and every status bit but that of rates.
    names = [signal.name for signal in program.outputs]
    for column, output in enumerate(names):
        if output.startswith("status"):
            word = engine[:, column].astype(int)
            for bit in (1, 2, 4, 8, 16, 32, 64):
                assert np.any(word & bit) and not np.all(word & bit), (output, bit)
    for column in range(engine.shape[1]):
        if column >= len(names) or not names[column].startswith("status"):
            assert len(np.unique(engine[:, column])) > 50
