"""All scores of one run: which segments feed which score."""

import math
from dataclasses import replace

import numpy as np
import pytest

from clepsydra import InputError
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.plant import BufferTrajectories, PlantTrajectories
from clepsydra.scores.score import SCORES
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.segment import Segment

PERIOD = 0.5


def scores_of(time, **parts) -> dict[str, float]:
    return score_run(ScoredRun(time, **parts))


TIME = np.arange(0.0, 4000.0, PERIOD)


SEGMENTS = (
    Segment("setpoint", "level_1", 100.0, 1000.0, 2.0),
    Segment("setpoint", "level_1", 1000.0, 2000.0, -2.0),
    Segment("load", "inflow_1", 2000.0, 3000.0, 1e-6),
    Segment("noise", "", 3000.0, 4000.0, 0.0),
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


def plant() -> PlantTrajectories:
    """Return a pump at 5 l/s against 20 m that stops once, and a basin that lags by 100 s."""
    running = np.where((TIME >= 400.0) & (TIME < 1300.0), 0.0, 1.0)
    lag = 1.0 - np.exp(-since(2000.0) / 100.0)
    inflow = 0.01 + 2e-3 * (TIME >= 2000.0)
    return PlantTrajectories(
        pumped={"pump_1": 5e-3 * running},
        running={"pump_1": running},
        heads={"pump_1": np.full_like(TIME, 20.0)},
        spilt={"basin": 1e-3 * since(3000.0)},
        buffers={"level_2": BufferTrajectories(inflow, 0.01 + 2e-3 * lag, 0.5 + 0.1 * lag)},
        bands={"level_2": (4.0, 6.0)},
    )


def measured() -> dict[str, np.ndarray]:
    noise = np.where(TIME >= 3000.0, np.random.default_rng(5).normal(0.0, 0.1, TIME.size), 0.0)
    return {name: values + noise for name, values in run()["outputs"].items()}


def test_each_score_takes_the_worst_of_its_segments() -> None:
    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    small = PERIOD**2 / 50.0  # what the lines between samples may miss [s]
    assert scores["rise_time[level_1]"] == pytest.approx(80.0 * math.log(9.0), abs=small)
    assert scores["settling_time[level_1]"] == pytest.approx(80.0 * math.log(20.0), abs=small)
    assert scores["overshoot[level_1]"] == 0.0
    assert scores["peak_deviation[level_1]"] == pytest.approx(0.4, rel=1e-4)
    assert scores["peak_deviation[level_2]"] == pytest.approx(0.2, rel=1e-4)
    assert scores["total_variation[pump_1]"] == 14.0
    assert scores["time_in_saturation[pump_1]"] == 30.0


def test_integrals_cover_the_whole_run() -> None:
    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    load = 0.4 * math.e * 40.0
    assert scores["iae[level_1]"] == pytest.approx(2.0 * 50.0 + 2.0 * 80.0 + load, rel=1e-4)
    load_squared = (0.4 * math.e) ** 2 * 40.0 / 4.0
    assert scores["ise[level_1]"] == pytest.approx(100.0 + 160.0 + load_squared, rel=1e-4)


def test_setpoint_steps_and_loads_cost_apart_and_noise_in_neither() -> None:
    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    assert scores["iae_setpoint[level_1]"] == pytest.approx(100.0 + 160.0, rel=1e-4)
    load = 0.4 * math.e * 40.0
    assert scores["iae_load[level_1]"] == pytest.approx(load, rel=1e-4)
    assert scores["iae_load[level_2]"] == pytest.approx(load / 2, rel=1e-4)
    off = run()
    off["outputs"]["level_1"] = off["outputs"]["level_1"] + 1.0 * (TIME > 3000.0)
    noisy = scores_of(TIME, **off, segments=SEGMENTS)
    assert noisy["iae[level_1]"] == pytest.approx(scores["iae[level_1]"] + 1000.0, rel=1e-3)
    for key in ("ie", "iae_setpoint", "iae_load", "offset"):
        assert noisy[f"{key}[level_1]"] == scores[f"{key}[level_1]"], key


def test_the_integral_of_the_error_adds_magnitudes_of_opposite_steps() -> None:
    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    load = 0.4 * math.e * 40.0
    assert scores["ie[level_1]"] == pytest.approx(100.0 + 160.0 + load, rel=1e-4)


def test_time_counts_from_the_start_of_each_segment() -> None:
    """∫ t e^(-t/T) = T² for the steps; for the load ∫ t² e^(-t/T) = 2 T³."""
    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    load = 0.4 * math.e / 40.0 * 2 * 40.0**3
    itae = 2.0 * 50.0**2 + 2.0 * 80.0**2 + load
    assert scores["itae[level_1]"] == pytest.approx(itae, rel=1e-3)
    squared = (0.4 * math.e / 40.0) ** 2 * 6 * 20.0**4
    itse = 4.0 * 25.0**2 + 4.0 * 40.0**2 + squared
    assert scores["itse[level_1]"] == pytest.approx(itse, rel=1e-3)


def test_both_bands_of_settling_and_the_band_of_the_noise() -> None:
    """The noise of the last segment, σ = 0.1, widens the band from 5 % to 15 % of a step of 2."""
    scores = scores_of(TIME, **run(), segments=SEGMENTS, measured=measured())
    assert scores["settling_time_2[level_1]"] == pytest.approx(80.0 * math.log(50.0), abs=0.01)
    band = 3 * float(
        np.std(measured()["level_1"][TIME >= 3000.0] - run()["outputs"]["level_1"][TIME >= 3000.0])
    )
    assert band == pytest.approx(0.3, rel=0.1)
    exact = 80.0 * math.log(2.0 / band)
    assert exact <= scores["settling_time_noisy[level_1]"] <= exact + PERIOD
    quiet = scores_of(TIME, **run(), segments=SEGMENTS, measured=run()["outputs"])
    exact = 80.0 * math.log(20.0)
    assert exact <= quiet["settling_time_noisy[level_1]"] <= exact + PERIOD


def test_scores_of_the_plant() -> None:
    scores = scores_of(TIME, **run(), segments=SEGMENTS, plant=plant())
    assert scores["volume_pumped[pump_1]"] == pytest.approx(5e-3 * 3100.0, rel=1e-12)
    assert scores["starts_per_hour[pump_1]"] == pytest.approx(3600.0 / 4000.0, rel=1e-12)
    kilowatts = 1000 * 9.81 * 20.0 * 5e-3 / 1000
    assert scores["energy[pump_1]"] == pytest.approx(kilowatts * 3100.0 / 3600.0, rel=1e-12)
    assert scores["volume_spilt[basin]"] == pytest.approx(1.0, rel=1e-3)
    steepest = 2e-3 / 100.0 * 3600.0**2
    assert scores["outflow_rate[level_2]"] == pytest.approx(steepest, rel=PERIOD / 100.0)
    share = 1.0 - 2 * 100.0 / 1000.0 + 100.0 / 2 / 1000.0
    assert scores["variance_ratio[level_2]"] == pytest.approx(share, abs=1e-3)
    assert scores["volume_used[level_2]"] == pytest.approx(10.0, rel=1e-3)
    without_load = scores_of(TIME, **run(), segments=SEGMENTS[:2], plant=plant())
    assert "outflow_rate[level_2]" not in without_load
    assert "volume_pumped[pump_1]" in without_load


def test_the_wear_of_one_pulse_is_its_height_twice() -> None:
    """From 3 to 10 of a range of 10 and back, in 4000 s."""
    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    assert scores["peak_move[pump_1]"] == 7.0
    assert scores["reversals[pump_1]"] == 1.0
    assert scores["travel[pump_1]"] == pytest.approx(140.0 * 3600.0 / 4000.0, rel=1e-12)


def test_the_offset_is_what_is_left_at_the_end_of_the_worst_step() -> None:
    parts = run()
    parts["outputs"]["level_1"] = parts["outputs"]["level_1"] - 0.25 * (TIME > 1500.0)
    scores = scores_of(TIME, **parts, segments=SEGMENTS)
    assert scores["offset[level_1]"] == pytest.approx(0.25, rel=1e-3)
    assert scores["offset[level_2]"] == pytest.approx(0.0, abs=1e-6)


def test_return_band_comes_from_the_setpoint_step_or_else_from_the_peak() -> None:
    from scipy.special import lambertw

    scores = scores_of(TIME, **run(), segments=SEGMENTS)
    # Solve peak e (t/40) exp(-t/40) = band on the falling side.
    for name, share in (("level_1", 0.05 * 2.0 / 0.4), ("level_2", 0.05)):
        exact = -40.0 * float(lambertw(-share / math.e, k=-1).real)
        assert scores[f"return_time[{name}]"] == pytest.approx(exact, abs=0.01), name


def test_overshoot_of_a_step_down_is_found_beside_a_step_up_without_any() -> None:
    parts = run()
    parts["outputs"]["level_1"] = parts["outputs"]["level_1"].copy()
    parts["outputs"]["level_1"][TIME == 1200.0] = 4.5
    assert scores_of(TIME, **parts, segments=SEGMENTS)["overshoot[level_1]"] == 25.0


def test_scores_without_a_segment_are_left_out_and_all_names_are_described() -> None:
    inner = {"flow_1": (np.where(TIME < 7.0, 0.5, 0.2), 0.2, 0.5), "flow_2": (TIME, 5.0, 8.0)}
    scores = scores_of(
        TIME, **run(), segments=SEGMENTS, measured=measured(), plant=plant(), inner=inner
    )
    assert scores["time_at_setpoint_limit[flow_1]"] == TIME.size * PERIOD
    assert scores["time_at_setpoint_limit[flow_2]"] == TIME.size * PERIOD - 2.5
    assert {name.partition("[")[0] for name in scores} == set(SCORES)
    assert "overshoot[level_2]" not in scores
    without = scores_of(TIME, **run(), segments=SEGMENTS[-1:])
    found = {name.partition("[")[0] for name in without}
    assert found >= {"iae", "ise", "total_variation", "travel", "noise_movement"}
    assert {SCORES[name].wants for name in found} == {"", "noise"}
    unlimited = run() | {"input_limits": {"pump_1": (0.0, math.inf)}}
    assert "travel[pump_1]" not in scores_of(TIME, **unlimited, segments=SEGMENTS)


def test_an_output_that_a_load_does_not_reach_has_no_deviation() -> None:
    parts = run()
    parts["outputs"]["level_2"] = np.full_like(TIME, 4.0)
    scores = scores_of(TIME, **parts, segments=SEGMENTS)
    assert (scores["peak_deviation[level_2]"], scores["return_time[level_2]"]) == (0.0, 0.0)


def test_segment_limits_off_by_rounding_find_their_samples() -> None:
    exact = scores_of(TIME, **run(), segments=SEGMENTS)
    shifted = tuple(
        replace(s, start=s.start * (1 + 1e-13), stop=s.stop * (1 - 1e-13)) for s in SEGMENTS
    )
    assert scores_of(TIME, **run(), segments=shifted) == exact


def test_the_sample_at_the_stop_still_belongs_to_the_response() -> None:
    time, setpoint, output = np.arange(3.0), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    segments = [Segment("setpoint", "y", 0.0, 1.0, 1.0), Segment("setpoint", "y", 1.0, 2.0, -1.0)]
    scores = score_run(ScoredRun(time, {"y": setpoint}, {"y": output}, {}, {}, segments))
    assert scores["rise_time[y]"] == pytest.approx(0.8, rel=1e-14)
    assert scores["iae[y]"] == 1.0


def test_a_run_that_broke_off_scores_infinity_in_the_signal_concerned() -> None:
    parts = run()
    parts["outputs"]["level_1"] = np.where(TIME > 1500.0, math.nan, parts["outputs"]["level_1"])
    scores = scores_of(TIME, **parts, segments=SEGMENTS)
    for key in SCORES:
        assert scores.get(f"{key}[level_1]", math.inf) == math.inf, key
    for key in ("iae", "ise", "overshoot", "rise_time", "settling_time"):
        assert scores[f"{key}[level_1]"] == math.inf, key
    for key in ("peak_deviation", "return_time"):
        assert scores[f"{key}[level_1]"] == math.inf, key
        assert math.isfinite(scores[f"{key}[level_2]"]), key
    assert not any(math.isnan(value) for value in scores.values())


def test_a_run_that_broke_off_after_its_last_step_has_no_good_score_either() -> None:
    parts = run()
    parts["outputs"]["level_1"] = np.where(TIME > 3500.0, math.nan, parts["outputs"]["level_1"])
    scores = scores_of(TIME, **parts, segments=SEGMENTS, measured=parts["outputs"])
    of_level_1 = [value for name, value in scores.items() if name.endswith("[level_1]")]
    whole = scores_of(TIME, **run(), segments=SEGMENTS, measured=measured())
    assert len(of_level_1) == len([name for name in whole if name.endswith("[level_1]")]) > 10
    assert set(of_level_1) == {math.inf}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"segments": [Segment("load", "inflow_1", 5000.0, 6000.0, 1.0)]},
            "segments: got 'load segment from 5000.0 s to 6000.0 s', expected a segment of at",
        ),
    ],
)
def test_what_does_not_fit_together_is_refused(change: dict, message: str) -> None:
    with pytest.raises(InputError) as refusal:
        scores_of(TIME, **({**run(), "segments": SEGMENTS} | change))
    assert str(refusal.value).startswith(message)


@pytest.mark.parametrize(
    ("kind", "signal", "length", "held"),
    [
        ("setpoint", "level_1", 0.0, False),  # its one sample is no response
        ("setpoint", "level_1", PERIOD, True),
        ("noise", "", 0.0, False),
    ],
)
def test_the_shortest_segment_has_two_samples_with_that_at_its_stop(kind, signal, length, held):
    segment = Segment(kind, signal, 1000.0, 1000.0 + length, -2.0)
    if held:
        assert scores_of(TIME, **run(), segments=[segment])
        return
    with pytest.raises(InputError) as refusal:
        scores_of(TIME, **run(), segments=[segment])
    assert refusal.value.place == "segments"
    assert refusal.value.value == f"{kind} segment from 1000.0 s to 1000.0 s"
    assert refusal.value.expected == "a segment of at least two samples within 0.0 s to 3999.5 s"


def test_time_in_saturation_is_that_at_the_limits_between_which_a_controller_moves():
    given = run()
    usual = scores_of(TIME, segments=SEGMENTS, **given)
    # The pump stands at 10 V for 30 s, and at 3 V else.
    assert usual["time_in_saturation[pump_1]"] == 30.0
    narrow = scores_of(TIME, segments=SEGMENTS, movable={"pump_1": (3.0, 11.0)}, **given)
    assert narrow["time_in_saturation[pump_1]"] == TIME.size * PERIOD - 30.0
    # The actuator's range stays what travel is a share of.
    assert narrow["travel[pump_1]"] == usual["travel[pump_1]"] > 0.0


def test_a_setpoint_that_nothing_follows_has_no_step_response():
    given = run()
    usual = scores_of(TIME, segments=SEGMENTS, **given)
    other = scores_of(TIME, segments=SEGMENTS, followed=("level_2",), **given)
    gone = {f"{score}[level_1]" for score in (
        "overshoot", "rise_time", "settling_time", "settling_time_2", "settling_time_noisy",
        "undershoot",
    )}  # fmt: skip
    assert gone & set(usual) == set(usual) - set(other) >= {"overshoot[level_1]"}
    assert all(other[name] == usual[name] for name in other)
