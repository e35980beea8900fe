"""Scores of averaging control against filters whose flows are known in closed form."""

import math

import numpy as np
import pytest

from clepsydra.scores.averaging import volume_used
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.plant import BufferTrajectories, PlantTrajectories
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.segment import Segment

PERIOD = 0.01
TIME = np.arange(-1.0, 100.0, PERIOD)
LOAD = [slice(100, TIME.size)]
STEP = np.where(TIME >= -PERIOD / 2, 3.0, 0.0)
SINCE = np.maximum(TIME, 0.0)


def scores(time, inflow, outflow, loads=(slice(None),)) -> dict[str, float]:
    """Return the scores of a tank through which water flows while loads act."""
    ends = np.append(time, 2.0 * time[-1] - time[-2])
    acts = [ends[: len(time) + 1][load] for load in loads]
    stops = [len(time) if load.stop is None else load.stop for load in loads]
    segments = [
        Segment("load", "", float(at[0]), float(ends[stop]), 1.0)
        for at, stop in zip(acts, stops, strict=True)
    ]
    buffer = BufferTrajectories(np.asarray(inflow), np.asarray(outflow), np.full(len(time), 0.5))
    plant = PlantTrajectories(buffers={"y": buffer})
    return score_run(ScoredRun(np.asarray(time), {}, {}, {}, {}, segments, plant=plant))


def of_plant(time, **values) -> dict[str, float]:
    """Return the scores of a pump and of a tank that spills."""
    values = {name: {"p": np.asarray(each, dtype=float)} for name, each in values.items()}
    plant = PlantTrajectories(**values)
    return score_run(ScoredRun(np.asarray(time, dtype=float), {}, {}, {}, {}, plant=plant))


def variance_ratio(time, inflow, outflow, loads=(slice(None),)) -> float | None:
    return scores(time, inflow, outflow, loads).get("variance_ratio[y]")


def largest_rate_of_change(time, outflow, loads=(slice(None),)) -> float:
    return scores(time, outflow, outflow, loads)["outflow_rate[y]"] / 3600.0**2


@pytest.mark.parametrize("time_constant", [2.0, 10.0, 50.0])
def test_a_step_through_a_first_order_lag(time_constant: float) -> None:
    """Proportional control of a level makes the tank a lag: q = 3 (1 - e^(-t/T))."""
    outflow = 3.0 * (1.0 - np.exp(-SINCE / time_constant))
    horizon, decay = 100.0, math.exp(-100.0 / time_constant)
    exact = (
        1.0
        - 2 * time_constant * (1 - decay) / horizon
        + time_constant * (1 - decay**2) / 2 / horizon
    )
    assert variance_ratio(TIME, STEP, outflow, LOAD) == pytest.approx(exact, abs=2 * PERIOD / 100)
    assert largest_rate_of_change(TIME, outflow, LOAD) == pytest.approx(
        3.0 / time_constant, rel=PERIOD / time_constant
    )


def test_sines_give_the_square_of_the_gain() -> None:
    time = np.arange(0.0, 40.0, 0.001)
    inflow = np.sin(2 * np.pi * time / 4.0)
    for gain in (0.0, 0.3, 1.0, 2.0):
        outflow = gain * np.sin(2 * np.pi * time / 4.0)
        assert variance_ratio(time, inflow, outflow) == pytest.approx(gain**2, abs=1e-9), gain
        assert largest_rate_of_change(time, outflow) == pytest.approx(
            gain * np.pi / 2, rel=1e-5, abs=1e-12
        ), gain


def test_a_pipe_smooths_nothing_and_a_constant_outflow_all() -> None:
    assert variance_ratio(TIME, STEP, STEP + 7.0, LOAD) == 1.0
    assert variance_ratio(TIME, STEP, np.full_like(TIME, 3.0), LOAD) == 0.0
    assert variance_ratio(TIME, np.full_like(TIME, 3.0), STEP, LOAD) is None


def test_the_move_at_the_start_of_a_load_counts_and_what_is_outside_does_not() -> None:
    flow = np.array([0.0, 9.0, 9.0, 10.0, 10.5, 0.0, 99.0])
    time = 2.0 * np.arange(7.0)
    assert largest_rate_of_change(time, flow, [slice(3, 5)]) == 0.5
    assert largest_rate_of_change(time, flow, [slice(4, 5)]) == 0.25
    assert largest_rate_of_change(time, flow, [slice(3, 5), slice(5, 6)]) == 5.25
    filling = np.array([0.0, 0.4, 0.5, 0.6, 0.55, 1.0, 1.0])
    assert volume_used(time, filling, [slice(2, 5)]) == pytest.approx(10.0, rel=1e-12)
    assert volume_used(time, filling) == 100.0


def test_several_loads_are_weighed_together() -> None:
    """Squares 4 and 1 of the inflow, 1 and 1 of the outflow, over 2 s and 1 s."""
    time = np.arange(6.0)
    inflow = np.array([0.0, 2.0, 2.0, 2.0, 1.0, 9.0])
    outflow = np.array([0.0, 1.0, 1.0, 1.0, 2.0, 9.0])
    found = variance_ratio(time, inflow, outflow, [slice(1, 3), slice(4, 5)])
    assert found == pytest.approx((2 * 1 + 1) / (2 * 4 + 1), rel=1e-12)


def test_scores_scale_with_the_units() -> None:
    outflow = 3.0 * (1.0 - np.exp(-SINCE / 10.0))
    slower, litres = 60.0, 1000.0
    assert largest_rate_of_change(slower * TIME, litres * outflow, LOAD) == pytest.approx(
        litres / slower * largest_rate_of_change(TIME, outflow, LOAD), rel=1e-9
    )
    assert variance_ratio(slower * TIME, litres * STEP, litres * outflow, LOAD) == pytest.approx(
        variance_ratio(TIME, STEP, outflow, LOAD), rel=1e-9
    )


def test_a_run_that_broke_off_is_infinitely_bad() -> None:
    broken = np.array([1.0, math.nan, 1.0])
    time, good = np.arange(3.0), np.ones(3)
    assert largest_rate_of_change(time, broken) == math.inf
    assert variance_ratio(time, good, broken) == math.inf
    assert volume_used(time, broken) == math.inf
    assert of_plant(time, spilt=broken)["volume_spilt[p]"] == math.inf
    for pump in ((broken, good, good), (good, broken, good), (good, good, broken)):
        found = of_plant(time, **dict(zip(("pumped", "running", "heads"), pump, strict=True)))
        assert set(found.values()) == {math.inf} and len(found) == 3


def test_a_pump_that_cycles_starts_once_a_cycle() -> None:
    """A sump of volume V between its levels cycles in V/q + V/(Q - q)."""
    volume, inflow, rate = 6.0, 0.01, 0.04
    fill, empty = volume / inflow, volume / (rate - inflow)
    time = np.arange(0.0, 10 * (fill + empty), 1.0)
    running = (time % (fill + empty)) >= fill
    found = of_plant(time, pumped=rate * running, running=running)
    assert found["starts_per_hour[p]"] == pytest.approx(3600.0 / (fill + empty), rel=1e-12)
    assert found["volume_pumped[p]"] == pytest.approx(inflow * time.size, rel=1e-12)
    assert "energy[p]" not in found  # nothing is known of its head
    always = of_plant(time, pumped=np.ones_like(time), running=np.ones_like(time))
    assert always["starts_per_hour[p]"] == 0.0


def test_energy_is_the_weight_lifted() -> None:
    """A tonne lifted by 10 m needs 98.1 kJ, however long it takes and with whatever flow."""
    for period in (1.0, 60.0):
        time = period * np.arange(100.0)
        flow = np.full(100, 1.0 / (100 * period))
        found = of_plant(time, pumped=flow, running=np.ones(100), heads=np.full(100, 10.0))
        assert found["energy[p]"] == pytest.approx(98100.0 / 3.6e6, rel=1e-12), period
    found = of_plant([0.0, 1.0], pumped=[1.0, 1.0], running=[1.0, 1.0], heads=[-1.0, -1.0])
    assert found["energy[p]"] == 0.0
