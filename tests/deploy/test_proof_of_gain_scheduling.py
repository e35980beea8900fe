"""Scheduled, recomputed and observed LQI: engine, C and Structured Text equal in every bit."""

import re

import numpy as np
import pytest
from deployed import no_output_lay_idle, run_alike
from plants import designed, plant
from test_proof_of_structures import scans as wild_scans

pytestmark = pytest.mark.thorough


#: Design, plant and options.
CASES = {
    "scheduled PI of averaging-tank": (
        "gain_scheduled_pid", "averaging-tank", {"over": "volume", "points": (1.0, 2.0, 3.0)},
    ),
    "scheduled LQI of quadruple-tank": (
        "gain_scheduled_lqi", "quadruple-tank",
        {"over": "level_1", "points": (3.0, 6.0, 8.0), "follows": "setpoint"},
    ),
    "recomputed LQI of averaging-tank": ("recomputed_lqi", "averaging-tank", {}),
    "recomputed and estimated LQI of quadruple-tank": (
        "recomputed_lqi", "quadruple-tank", {"measurements": ("level_1", "level_2"), "steps": 2},
    ),
    "observed LQI of three-tanks": ("lqi_extended_kalman", "three-tanks", {}),
    "observed LQI of wet-well": ("lqi_extended_kalman", "wet-well", {}),
}  # fmt: skip


def scans(program, period, seed):
    """A plant of the process's own ranges that goes wrong in every way that inputs can express."""
    inputs = wild_scans(program, seed)
    for signal in program.inputs:
        if signal.name == "time_step":
            inputs[signal.name] = inputs[signal.name] * period
        elif np.isfinite(signal.span) and signal.kind == "real":
            # What is drawn between 0 and 10 falls into the range of the signal.
            inputs[signal.name] = signal.low + signal.span * inputs[signal.name] / 10.0
    return inputs


@pytest.mark.parametrize("name", CASES)
def test_engine_c_and_structured_text_are_equal_in_every_bit(name, tmp_path):
    design, process, options = CASES[name]
    program = designed(design, process, **options).program()
    inputs = scans(program, plant(process).process.sampling_period, seed=len(name))
    engine = run_alike(program, tmp_path, inputs)
    # Each status bit was set and clear, and each state moved: no part of the law lay idle.
    no_output_lay_idle(program, engine, (1, 2, 16, 32, 64), 100)
    moved = {
        entry.name: len(np.unique(engine[:, column])) > 20
        for column, entry in enumerate(program.state, start=len(program.outputs))
    }
    moving = re.compile(r"(\.integral|\.(feedback|integral_gain|cost)\..*|schedule\.variable)$")
    always = {name: moves for name, moves in moved.items() if moving.search(name)}
    assert always and all(always.values()), always
    estimates = [moves for name, moves in moved.items()
                 if name.endswith(".estimate") or ".covariance." in name]  # fmt: skip
    # The standby pump of the wet well stands still.
    assert not estimates or np.mean(estimates) > 0.5
