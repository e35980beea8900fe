"""What a study file says of tuned weights, and of scores of averaging."""

from pathlib import Path

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError
from clepsydra.linear.linearise import linearise
from clepsydra.studies.file.reader import read_study

VESSEL = Path(__file__).with_name("vessel.toml")
HEAD = """process = "{vessel}"
[scenario]
duration = "10 min"
noise = false
[[scenario.setpoint]]
signal = "level"
at = "10 s"
by = "5 cm"
[controllers.tuned]
design = "{design}"
{weights}
[controllers.tuned.tune]
objective = "ise"
"""
WEIGHTS = """weights = { states = { "vessel.level" = 100 }, inputs = { feed = 4e6 }, \
integrals = { level = 0.01 } }"""


def written(tmp_path, tail: str, design: str = "lqi_by_weights", weights: str = WEIGHTS):
    path = tmp_path / "study.toml"
    path.write_text(
        HEAD.format(vessel=VESSEL, design=design, weights=weights) + tail, encoding="utf-8"
    )
    return path


def made(path):
    study = read_study(path)
    return study.controllers[0].make(study.analysis, linearise(study.analysis.operating_point))


def test_a_study_file_tunes_weights_between_its_bounds(tmp_path):
    tail = """total_variation = { feed = "1000 %" }
[controllers.tuned.tune.parameters]
inputs.feed = [1e6, 1e8]
"""
    path = written(tmp_path, tail)
    (candidate,) = cl.study(path).ranking
    assert candidate.controller.name == "tuned"
    # Cheaper moves lower ISE: the lowest weight is the best.
    assert candidate.tuning.tuned == {"inputs.feed": pytest.approx(1e6)}
    assert candidate.tuning.objective < 1.0


@pytest.mark.thorough
def test_of_lqi_all_weights_are_tuned_with_at_most_twice_the_moves(tmp_path):
    (candidate,) = cl.study(written(tmp_path, "", "lqi", "")).ranking
    found = candidate.tuning
    assert list(found.tuned) == ["states.vessel.level", "inputs.feed"]
    wear = "total_variation[feed]"
    assert found.scores[wear] == pytest.approx(2.0 * found.start_scores[wear], rel=1e-4)
    assert found.objective < 1.0 and candidate.maximum_sensitivity < 2.0


@pytest.mark.thorough
def test_parameters_of_the_law_can_still_be_tuned(tmp_path):
    tail = """[controllers.tuned.tune.parameters]
feed.integral_gain.level = ["1e-7 m^3/(s^2 m)", "0.1 m^3/(s^2 m)"]
"""
    (candidate,) = cl.study(written(tmp_path, tail)).ranking
    assert list(candidate.tuning.tuned) == ["feed.integral_gain.level"]


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("inputs.feed = [5e6, 5e5]", "a low bound below the high bound"),
        ("inputs.feed = [0, 5e7]", "a weight above 0"),
        ("inputs.feed = [5e6, 5e7]", "a start within its bounds 5e"),
        ('inputs.feed = ["1 V", "5 V"]', "expected a number without a unit"),
        ("inputs.feed = 5", "a list of a low and a high bound"),
        ("inputs.fed = [0.1, 5]", "perhaps 'inputs.feed' was meant"),
        ("states.vessel.level = [0.1, 5]", "in quotes where a name has a dot"),
        ("inputs.feed = [1e6, 1e8]\nfeed.bias = [0.1, 0.9]", "weights alone"),
    ],
)
def test_wrong_bounds_of_weights_are_refused_with_their_line(tmp_path, line, said):
    path = written(tmp_path, f"[controllers.tuned.tune.parameters]\n{line}\n")
    with pytest.raises(InputError, match=said) as refusal:
        made(path)
    row = 15 + line.count("\n")
    assert f"study.toml, line {row}, controllers.tuned.tune.parameters" in str(refusal.value)


def test_scores_of_averaging_are_refused_where_nothing_averages(tmp_path):
    text = 'process = "quadruple-tank"\n[controllers.a]\ndesign = "simc"\n[controllers.a.tune]\n'
    path = tmp_path / "study.toml"
    path.write_text(text + 'objective = "outflow_rate"\n', encoding="utf-8")
    with refused(expected="it has no level that averages"):
        read_study(path)


@pytest.mark.thorough
def test_a_study_file_tunes_for_scores_of_averaging(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        """process = "equalisation-tank"
[scenario]
duration = "40 h"
noise = false
[[scenario.load]]
signal = "inflow"
at = "1 h"
by = "0.05 m^3/s"
[controllers.a]
design = "simc"
[controllers.a.tune]
objective = { outflow_rate = 1.0, variance_ratio = 0.5 }
""",
        encoding="utf-8",
    )
    (candidate,) = cl.study(path).ranking
    assert set(candidate.tuning.scores) == {"outflow_rate[level]", "variance_ratio[level]"}
    assert candidate.tuning.objective < 0.5 * candidate.tuning.start_objective
