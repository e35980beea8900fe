"""Scores in the page, beside those of Python on the same runs."""

import math

import numpy as np
import pytest
from page_in_node import answered, source

from clepsydra.scores.averaging import outflow_overshoot, ratio, swings, volume_used
from clepsydra.scores.effort import deviation_of_moves
from clepsydra.scores.step_response import settling_time

RUNS = 1000
SCRIPT = f"""
import {{ Recorded }} from "{source("live/recorded.ts")}";
import {{ scoresOf }} from "{source("live/scores.ts")}";
answer(given.map((run) => scoresOf(
  run.scores, new Recorded(Float64Array.from(run.rows), run.outputs, run.samples),
  Float64Array.from(run.state), run.process, run.period)));
"""
#: Outputs of the runs here.
OUTPUT, OUTFLOW, INFLOW, FILLING = range(4)


def scored(runs, folder):
    """Return the scores of runs, each with its columns [samples, outputs]."""
    given = [
        {"state": [], "process": 0, **run, "rows": run["rows"].ravel().tolist(),
         "samples": len(run["rows"]), "outputs": run["rows"].shape[1]}
        for run in runs
    ]  # fmt: skip
    return answered(SCRIPT, given, folder)


def wandering(random, samples):
    """Return a signal that swings, drifts and comes to rest, now and then exactly."""
    time = np.arange(samples)
    decay = np.exp(-time / random.uniform(1, samples))
    swing = decay * np.cos(random.uniform(0, 1) * time + random.uniform(0, 6))
    signal = random.normal() + random.normal() * swing + 0.02 * random.normal(size=samples) * decay
    return np.round(signal, random.integers(1, 9))


def random_run(random):
    samples, period = int(random.integers(20, 200)), float(random.choice([0.1, 1.0, 7.0]))
    rows = np.column_stack([wandering(random, samples) for _ in range(4)])
    cuts = np.sort(random.choice(np.arange(1, samples), 3, replace=False))
    spans = [(int(a), int(b)) for a, b in zip(cuts, [*cuts[1:], samples], strict=True)]
    targets = [rows[b - 1, OUTPUT] + 0.02 * random.normal() for _, b in spans]
    steps = [(*span, y - random.normal(), y) for span, y in zip(spans, targets, strict=True)]
    if random.uniform() < 0.1:
        rows[random.integers(samples), random.integers(4)] = random.choice([np.nan, np.inf])
    return {
        "period": period,
        "rows": rows,
        "scores": [
            {"key": "settling_time[y]", "kind": "settling", "column": OUTPUT,
             "band": float(random.choice([0.02, 0.05])), "steps": steps},
            *({"key": f"{kind}[y]", "kind": kind, "columns": columns, "loads": spans}
              for kind, columns in (("outflow_overshoot", [OUTFLOW, INFLOW]),
                                    ("outflow_swings", [OUTFLOW, INFLOW]),
                                    ("volume_used", [FILLING]))),
        ],
    }  # fmt: skip


def by_python(run):
    settling, overshoot, _, _ = run["scores"]
    columns = run["rows"].T
    time = run["period"] * np.arange(len(run["rows"]))
    loads = [slice(*each) for each in overshoot["loads"]]
    complete = np.all(np.isfinite(columns[OUTPUT]))
    settled = [
        settling_time(time[a:b], columns[OUTPUT][a:b], start, target, settling["band"])
        if complete
        else math.inf
        for a, b, start, target in settling["steps"]
    ]
    flows = columns[OUTFLOW], columns[INFLOW]
    return [
        max(settled),
        outflow_overshoot(time, *flows, loads),
        swings(time, *flows, loads),
        volume_used(time, columns[FILLING], loads),
    ]


def test_those_found_over_a_run_are_those_of_python(tmp_path):
    random = np.random.default_rng(11)
    runs = [random_run(random) for _ in range(RUNS)]
    found, expected = np.array(scored(runs, tmp_path)), np.array([by_python(run) for run in runs])
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    # Each kind has all sorts of answers.
    assert np.isfinite(expected).any(axis=0).all() and np.isinf(expected).any(axis=0).all()
    assert all(len(np.unique(column)) > 5 for column in expected.T)


@pytest.mark.parametrize(
    ("finish", "folds"),
    [("ratio", (3.0, 4.0)), ("ratio", (3.0, 0.0)), ("deviation", (3.0, 5.0)),
     ("deviation", (0.0, 0.0))],
)  # fmt: skip
def test_folds_are_finished_as_in_python(finish, folds, tmp_path):
    expected = {"ratio": ratio, "deviation": deviation_of_moves}[finish](*folds)
    score = {"key": "a[y]", "kind": "fold", "states": [2, 1], "finish": finish}
    run = {"rows": np.zeros((1, 1)), "period": 1.0, "scores": [score], "process": 1}
    ((found,),) = scored([run | {"state": [7.0, folds[1], folds[0]]}], tmp_path)
    np.testing.assert_equal(found, float(expected))


def test_a_run_that_broke_off_has_no_finite_score(tmp_path):
    """So a state of the process that is not finite says; one of the law does not."""
    scores = [{"key": "a[y]", "kind": "fold", "states": [3], "finish": ""},
              {"key": "b[y]", "kind": "fold", "states": [4], "finish": ""}]  # fmt: skip
    run = {"rows": np.zeros((2, 1)), "period": 1.0, "scores": scores, "process": 2}
    states = [[1, 1, math.nan, 5.0, 6.0], [1, -math.inf, 1, 5.0, 6.0], [1, 1, 1, 5.0, math.nan]]
    found = scored([run | {"state": state} for state in states], tmp_path)
    assert found == [[5.0, 6.0], [math.inf, math.inf], [5.0, math.inf]]
