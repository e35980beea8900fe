"""What a lesson measures of a run in its page is what scores say of it."""

import numpy as np
import pytest
from page_in_node import answered, source

from clepsydra.scores.step_response import overshoot, rise_time, settling_time

MEASURED = f"""
import {{ measured }} from "{source("lab/measures.ts")}";
const column = (values) => Float64Array.from(values);
answer(given.kinds.map((kind) => measured(
  {{ kind, signal: "y", target: given.target, band: given.band, after: 0, until: 1 }},
  column(given.output), column(given.setpoint), given.period)));
"""
KINDS = ("rise_time", "overshoot", "settling_time", "return_time", "mean")


@pytest.mark.parametrize("seed", range(4))
def test_measures_are_those_of_the_scores(seed, tmp_path):
    random, period = np.random.default_rng(seed), 0.5
    time = period * np.arange(80)
    damping = random.uniform(0.1, 0.4)
    output = 2.0 + 3.0 * (1.0 - np.exp(-damping * time) * np.cos(random.uniform(0.4, 1.0) * time))
    output[-5:] = 5.0
    given = {"kinds": KINDS, "target": "setpoint", "band": 0.05, "output": output.tolist(),
             "setpoint": [5.0] * 80, "period": period}  # fmt: skip
    found = dict(zip(KINDS, answered(MEASURED, given, tmp_path), strict=True))
    start, target = output[0], 5.0
    expected = {
        "rise_time": rise_time(time, output, start, target),
        "overshoot": overshoot(time, output, start, target) / 100.0,
        "settling_time": settling_time(time, output, start, target),
        # Back within 5 % of the target, whatever the step was.
        "return_time": settling_time(time, output, 0.0, target),
        "mean": output[-20:].mean(),
    }
    assert found == pytest.approx(expected, rel=1e-12)
    at_end = answered(MEASURED, given | {"target": "end", "setpoint": []}, tmp_path)
    assert at_end == pytest.approx(list(expected.values()), rel=1e-12)


def test_what_never_came_so_far_has_no_measure(tmp_path):
    given = {"kinds": KINDS, "target": "setpoint", "band": 0.05, "output": [0.0, 1.0, 2.0],
             "setpoint": [5.0] * 3, "period": 1.0}  # fmt: skip
    rise, over, settling, back, _ = answered(MEASURED, given, tmp_path)
    assert [rise, settling, back] == [np.inf] * 3 and over == 0.0
    gone = answered(MEASURED, given | {"output": [0.0, float("nan"), 2.0]}, tmp_path)
    assert all(np.isnan(gone))
