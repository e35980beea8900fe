"""All scores of one run: which segments feed which score."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from clepsydra.base.errors import InputError
from clepsydra.scores.catalogue import SCORES
from clepsydra.scores.evaluate import score_run

PERIOD = 0.5
TIME = np.arange(0.0, 4000.0, PERIOD)


@dataclass(frozen=True)
class Stretch:
    kind: str
    signal: str
    start: float
    stop: float
    size: float


SEGMENTS = (
    Stretch("setpoint", "level_1", 100.0, 1000.0, 2.0),
    Stretch("setpoint", "level_1", 1000.0, 2000.0, -2.0),
    Stretch("load", "inflow_1", 2000.0, 3000.0, 1e-6),
    Stretch("noise", "", 3000.0, 4000.0, 0.0),
)


def since(start: float) -> np.ndarray:
    return np.maximum(TIME - start, 0.0)


def run() -> dict[str, dict]:
    """Return level_1 up with T = 50 s and down with T = 80 s, then off by 0.4 and back."""
    setpoint = 5.0 + 2.0 * ((TIME >= 100.0) & (TIME < 1000.0))
    up, down = np.exp(-since(100.0) / 50.0), np.exp(-since(1000.0) / 80.0)
    load = 0.4 * np.e * since(2000.0) / 40.0 * np.exp(-since(2000.0) / 40.0)
    level_1 = np.where(TIME < 1000.0, 5.0 + 2.0 * (1.0 - up), 5.0 + 2.0 * down) - load
    pump = np.where((TIME >= 100.0) & (TIME < 130.0), 10.0, 3.0)
    return {
        "setpoints": {"level_1": setpoint, "level_2": np.full_like(TIME, 4.0)},
        "outputs": {"level_1": level_1, "level_2": np.full_like(TIME, 4.0) + load / 2.0},
        "inputs": {"pump_1": pump},
        "input_limits": {"pump_1": (0.0, 10.0)},
    }


def test_each_score_takes_the_worst_of_its_segments() -> None:
    scores = score_run(TIME, **run(), segments=SEGMENTS)
    small = PERIOD**2 / 50.0  # what the lines between samples may miss [s]
    assert scores["rise_time[level_1]"] == pytest.approx(80.0 * math.log(9.0), abs=small)
    assert scores["settling_time[level_1]"] == pytest.approx(80.0 * math.log(20.0), abs=small)
    assert scores["overshoot[level_1]"] == 0.0
    assert scores["peak_deviation[level_1]"] == pytest.approx(0.4, rel=1e-4)
    assert scores["peak_deviation[level_2]"] == pytest.approx(0.2, rel=1e-4)
    assert scores["total_variation[pump_1]"] == 14.0
    assert scores["time_in_saturation[pump_1]"] == 30.0


def test_integrals_cover_the_whole_run() -> None:
    scores = score_run(TIME, **run(), segments=SEGMENTS)
    load = 0.4 * math.e * 40.0
    assert scores["iae[level_1]"] == pytest.approx(2.0 * 50.0 + 2.0 * 80.0 + load, rel=1e-4)
    load_squared = (0.4 * math.e) ** 2 * 40.0 / 4.0
    assert scores["ise[level_1]"] == pytest.approx(100.0 + 160.0 + load_squared, rel=1e-4)


def test_return_band_comes_from_the_setpoint_step_or_else_from_the_peak() -> None:
    from scipy.special import lambertw

    scores = score_run(TIME, **run(), segments=SEGMENTS)
    # Solve peak e (t/40) exp(-t/40) = band on the falling side.
    for name, share in (("level_1", 0.05 * 2.0 / 0.4), ("level_2", 0.05)):
        exact = -40.0 * float(lambertw(-share / math.e, k=-1).real)
        assert scores[f"return_time[{name}]"] == pytest.approx(exact, abs=0.01)


def test_overshoot_of_a_step_down_is_found_beside_a_step_up_without_any() -> None:
    parts = run()
    parts["outputs"]["level_1"] = parts["outputs"]["level_1"].copy()
    parts["outputs"]["level_1"][TIME == 1200.0] = 4.5
    assert score_run(TIME, **parts, segments=SEGMENTS)["overshoot[level_1]"] == 25.0


def test_scores_without_a_segment_are_left_out_and_all_names_are_described() -> None:
    scores = score_run(TIME, **run(), segments=SEGMENTS)
    assert {name.partition("[")[0] for name in scores} == set(SCORES)
    assert "overshoot[level_2]" not in scores
    without = score_run(TIME, **run(), segments=SEGMENTS[-1:])
    assert {name.partition("[")[0] for name in without} == {
        "iae",
        "ise",
        "total_variation",
        "time_in_saturation",
    }


def test_an_output_that_a_load_does_not_reach_has_no_deviation() -> None:
    parts = run()
    parts["outputs"]["level_2"] = np.full_like(TIME, 4.0)
    scores = score_run(TIME, **parts, segments=SEGMENTS)
    assert (scores["peak_deviation[level_2]"], scores["return_time[level_2]"]) == (0.0, 0.0)


def test_segment_limits_off_by_rounding_find_their_samples() -> None:
    exact = score_run(TIME, **run(), segments=SEGMENTS)
    shifted = tuple(
        replace(s, start=s.start * (1 + 1e-13), stop=s.stop * (1 - 1e-13)) for s in SEGMENTS
    )
    assert score_run(TIME, **run(), segments=shifted) == exact


def test_the_sample_at_the_stop_still_belongs_to_the_response() -> None:
    time, setpoint, output = np.arange(3.0), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    segments = [Stretch("setpoint", "y", 0.0, 1.0, 1.0), Stretch("setpoint", "y", 1.0, 2.0, -1.0)]
    scores = score_run(time, {"y": setpoint}, {"y": output}, {}, {}, segments)
    assert scores["rise_time[y]"] == pytest.approx(0.8, rel=1e-14)
    assert scores["iae[y]"] == 1.0


def test_a_run_that_broke_off_scores_infinity_in_the_signal_concerned() -> None:
    parts = run()
    parts["outputs"]["level_1"] = np.where(TIME > 1500.0, math.nan, parts["outputs"]["level_1"])
    scores = score_run(TIME, **parts, segments=SEGMENTS)
    for key in ("iae", "ise", "overshoot", "rise_time", "settling_time"):
        assert scores[f"{key}[level_1]"] == math.inf
    for key in ("peak_deviation", "return_time"):
        assert scores[f"{key}[level_1]"] == math.inf
        assert math.isfinite(scores[f"{key}[level_2]"])
    assert not any(math.isnan(value) for value in scores.values())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"outputs": {}}, "outputs: got 'nothing', expected exactly the signals level_1, level_2"),
        ({"input_limits": {}}, "input_limits: got 'nothing', expected exactly the signals pump_1"),
        (
            {"segments": [Stretch("setpoint", "level_9", 100.0, 200.0, 1.0)]},
            "segments: got 'level_9', expected one of the controlled variables level_1, level_2",
        ),
        (
            {"segments": [Stretch("load", "inflow_1", 5000.0, 6000.0, 1.0)]},
            "segments: got 'load segment from 5000.0 s to 6000.0 s', expected a segment of at",
        ),
    ],
)
def test_what_does_not_fit_together_is_refused(change: dict, message: str) -> None:
    with pytest.raises(InputError) as refusal:
        score_run(TIME, **({**run(), "segments": SEGMENTS} | change))
    assert str(refusal.value).startswith(message)
