"""Start and stop levels in C and Structured Text, equal to the engine in every bit."""

import numpy as np
from deployed import all_bits, run_both
from plants import designed

from clepsydra import Kernel

SCANS = 2000


def spoilt(random, values):
    """Replace some values by what a broken channel delivers."""
    wrong = random.choice([np.nan, np.inf, -np.inf, 1e301, -0.0], size=len(values))
    return np.where(random.random(len(values)) < 0.02, wrong, values)


def test_the_engine_c_and_structured_text_agree_in_every_bit(tmp_path):
    program = designed("start_stop_levels", "wet-well:start-stop").program()
    random = np.random.default_rng(3)
    level = 0.004 + np.cumsum(random.normal(0.0, 4e-4, SCANS)) % 0.016
    given = {
        "level.pv": spoilt(random, level),
        "level.good": (random.random(SCANS) > 0.03).astype(float),
        "time_step": spoilt(random, np.full(SCANS, 2.0)),
    }
    for pump in ("duty", "standby"):
        given[f"{pump}.mode"] = random.choice([0.0, 1.0, 1.0, 1.0, 2.0], SCANS)
        given[f"{pump}.manual"] = spoilt(random, random.choice([0.0, 0.5, 1.0], SCANS))
        given[f"{pump}.tracking"] = spoilt(random, random.random(SCANS))
    inputs = {signal.name: given[signal.name] for signal in program.inputs}
    run = Kernel(program).run(SCANS, inputs=inputs)
    engine = np.column_stack([run.output(signal.name)[0] for signal in program.outputs])
    assert len({tuple(row) for row in engine}) > 400
    for printed in run_both(program, tmp_path, inputs):
        outputs, state = printed[:, : engine.shape[1]], printed[-1, engine.shape[1] :]
        np.testing.assert_array_equal(all_bits(outputs), all_bits(engine))
        np.testing.assert_array_equal(state, run.final_state[:, 0])
