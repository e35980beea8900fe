"""The scores that the page tells between two cursors are those of `clepsydra.scores`."""

import numpy as np
import pytest
from page_in_node import answered, source

from clepsydra.scores.effort import TOTAL_VARIATION
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.iae import IAE
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.segment import Segment
from clepsydra.scores.step_response import overshoot, settling_time

SCRIPT = f"""
import {{ controlledScores, totalVariation }} from "{source("lab/scores_between.ts")}";
answer(given.stretches.map(({{ setpoint, output, before, touched, period }}) => {{
  const [r, y] = [Float64Array.from(setpoint), Float64Array.from(output)];
  return {{ ...controlledScores(r, y, before, touched, period), moved: totalVariation(y) }};
}}));
"""
PERIOD = 0.5


def response(random, events, samples):
    """Return setpoint and output of a loop after steps of a size at samples, or loads (None)."""
    setpoint, output = np.full(samples, 1.0), np.empty(samples)
    ends = [*(at for at, _ in events), samples]
    output[: ends[0]] = 1.0
    for (start, size), stop in zip(events, ends[1:], strict=True):
        before = output[start - 1] if start else 1.0
        if size is not None:
            setpoint[start:] += size
        time = np.arange(stop - start + 1)
        ringing = np.exp(-time / random.uniform(4, 40)) * np.cos(time / random.uniform(3, 30))
        load = random.uniform(-1, 1) if size is None else 0.0
        moved = setpoint[start] + (before - setpoint[start]) * ringing + load * ringing * time / 9
        output[start:stop] = moved[: stop - start]
    return setpoint, output


def segments(events, samples):
    """Return what a study would call these events: each lasts until the next one."""
    ends = [*(at for at, _ in events), samples - 1]
    return [
        Segment("load" if size is None else "setpoint", "d" if size is None else "y",
                start * PERIOD, stop * PERIOD, 1.0 if size is None else size)
        for (start, size), stop in zip(events, ends[1:], strict=True)
    ]  # fmt: skip


def page_scores(stretches, folder):
    return answered(SCRIPT, {"stretches": stretches}, folder)


def test_steps_and_loads_are_judged_as_in_a_study(tmp_path):
    random = np.random.default_rng(2)
    events = [
        [(0, 0.5)],
        [(0, 0.5), (150, -1.25)],
        [(30, -0.5), (90, None), (200, 0.25)],
        [(7, None), (140, 2.0), (165, None)],
        [(40, 0.5), (61, 0.5), (82, -0.5)],
    ]
    found = [(each, *response(random, each, 300)) for each in events]
    stretches = [
        {"setpoint": r.tolist(), "output": y.tolist(), "before": 1.0, "period": PERIOD,
         "touched": [at for at, _ in each]}
        for each, r, y in found
    ]  # fmt: skip
    time = PERIOD * np.arange(300)
    kinds = set()
    for told, (each, r, y) in zip(page_scores(stretches, tmp_path), found, strict=True):
        run = ScoredRun(time, {"y": r}, {"y": y}, {"u": y}, {"u": (-9.0, 9.0)},
                        segments(each, 300))  # fmt: skip
        scores = score_run(run)
        assert told["iae"] == pytest.approx(scores["iae[y]"], rel=1e-13)
        assert told["moved"] == pytest.approx(scores["total_variation[u]"], rel=1e-13)
        assert told["overshoot"] == pytest.approx(scores["overshoot[y]"], rel=1e-12)
        assert told["settling"] == pytest.approx(scores["settling_time[y]"], rel=1e-12)
        kinds.add(np.isfinite(told["settling"]))
    assert kinds == {True, False}


def test_a_setpoint_that_is_dragged_is_one_step(tmp_path):
    random = np.random.default_rng(5)
    setpoint, output = response(random, [(40, 2.0)], 250)
    setpoint[40:60] = np.linspace(1.1, 3.0, 20)
    stretch = {"setpoint": setpoint.tolist(), "output": output.tolist(), "before": 1.0,
               "touched": list(range(40, 60)), "period": PERIOD}  # fmt: skip
    (told,) = page_scores([stretch], tmp_path)
    time, tail = PERIOD * np.arange(250), slice(40, None)
    assert told["iae"] == pytest.approx(IAE.along(time, setpoint, output), rel=1e-13)
    assert told["moved"] == pytest.approx(TOTAL_VARIATION.along(time, output), rel=1e-13)
    seen = time[tail], output[tail], 1.0, 3.0
    assert told["overshoot"] == pytest.approx(overshoot(*seen), rel=1e-12)
    assert told["settling"] == pytest.approx(settling_time(*seen), rel=1e-12)


def test_a_setpoint_that_stands_has_no_step_and_what_is_broken_is_infinite(tmp_path):
    still = {"setpoint": [1.0] * 9, "output": [0.5] * 9, "before": 1.0, "touched": [],
             "period": PERIOD}  # fmt: skip
    broken = still | {"output": [0.5, np.nan] * 4 + [0.5], "before": 0.0}
    calm, wild = page_scores([still, broken], tmp_path)
    assert np.isnan(calm["overshoot"]) and np.isnan(calm["settling"])
    assert calm["iae"] == pytest.approx(8 * PERIOD * 0.5)
    assert {wild[each] for each in ("iae", "overshoot", "settling", "moved")} == {np.inf}
