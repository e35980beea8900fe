"""Scores of the band of an averaging level: paths by hand, and a tank under PI in closed form."""

import math

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.plant import PlantTrajectories
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.segment import Segment

BAND = (0.3, 0.7)
#: A tank of 10 m² and a flow step of 10 m³/h, either way.
AREA, STEP, MIDDLE = 10.0, 10.0 / 3600.0, 1.0
TANK = """
name = "tank"
sampling_period = "2 s"
controlled = ["level"]
averaging = ["level"]
manipulated = ["outflow"]
tanks.tank = {{ area = "10 m^2", height = "2 m" }}
[flows.feed]
destination = "tank"
range = ["0 m^3/h", "100 m^3/h"]
nominal = "50 m^3/h"
step = ["10 m^3/h", "-10 m^3/h"]
[flows.outflow]
source = "tank"
range = ["0 m^3/h", "100 m^3/h"]
nominal = "50 m^3/h"
[sensors.level]
tank = "tank"
range = ["0 m", "2 m"]
band = ["{} m", "{} m"]
[operating_point]
level = "1 m"
"""


def scores(path, segments, period=1.0):
    y = np.asarray(path, float)
    time = period * np.arange(y.size)
    plant = PlantTrajectories(bands={"y": BAND})
    found = score_run(ScoredRun(time, {"y": y}, {"y": y}, {}, {}, segments, plant=plant))
    return [found.get(f"{key}[y]") for key in ("time_outside_band", "above_band", "below_band")]


def test_time_and_depth_of_straight_lines_are_counted_between_the_samples():
    # 0.6 → 0.8 is outside half the time, 0.8 → 0.8 all of it, 0.8 → 0.2 for 0.1/0.6 + 0.1/0.6.
    path = [0.6, 0.8, 0.8, 0.2, 0.3]
    found = scores(path, [Segment("load", "d", 0.0, 8.0, 1.0)], period=2.0)
    assert found == pytest.approx([1.0 + 2.0 + 2.0 / 3.0 + 2.0, 0.1, 0.1])


def test_an_end_of_the_band_is_within_it():
    assert scores([0.3, 0.7, 0.3], [Segment("load", "d", 0.0, 2.0, 1.0)]) == [0.0, 0.0, 0.0]


def test_only_loads_count():
    segments = [Segment("setpoint", "y", 0.0, 2.0, 0.4), Segment("load", "d", 2.0, 5.0, 1.0)]
    assert scores([0.5, 0.9, 0.6, 0.65, 0.75, 0.6], segments) == pytest.approx([5.0 / 6, 0.05, 0.0])
    assert scores([0.5, 0.9, 0.6], segments[:1]) == [None] * 3


def test_a_value_that_is_not_finite_is_without_end():
    found = scores([0.5, math.nan, 0.6], [Segment("load", "d", 0.0, 2.0, 1.0)])
    assert found == [math.inf] * 3


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    def made(low, high):
        return plant_of(tmp_path_factory.mktemp("tank"), TANK.format(low, high))

    return made


def response(controller):
    """Return ω, ζ and y(t) of A ẏ = ΔF − kp y − kp/Ti ∫ y dt, whose PI moves the outflow."""
    values = controller.values
    kp = -values["level.proportional_gain"]  # [m³/s per m]
    omega = math.sqrt(kp / (AREA * values["level.integral_time"]))
    damping = kp / (2.0 * AREA * omega)
    root = math.sqrt(max(1.0 - damping**2, 1e-12))
    wave = omega * root

    def level(time):
        return STEP / AREA * np.exp(-damping * omega * time) * np.sin(wave * time) / wave

    return omega, damping, level, math.acos(min(damping, 1.0 - 1e-12)) / wave


@pytest.mark.parametrize("damping", [1.0, 0.7, 0.5])
def test_a_load_takes_the_level_to_the_end_of_the_band_and_the_flow_changes_as_slowly(
    damping, tank
):
    """Peak ΔF e^(−ζ a)/(A ω) is the way to the end of the band, but for a twentieth of it, and
    the fastest change of the outflow 2 ζ ω ΔF. Samples of 2 s in λ > 1100 s: errors below 0.3 %."""
    plant = tank(0.5, 1.4)
    controller = cl.design.arrest_time(plant, damping=damping)
    omega, found, level, peak = response(controller)
    assert found == pytest.approx(damping, rel=2e-3)
    # The worst direction is up, 0.4 m; at ζ = 1/2 the level swings back by 16 % of that, not more.
    assert level(peak) == pytest.approx(0.95 * 0.4, rel=3e-3)
    scored = cl.simulate(plant, controller).scores
    assert scored["peak_deviation[level]"] == pytest.approx(0.95 * 0.4, rel=3e-3)
    rate = 2.0 * damping * omega * STEP * 3600.0**2
    assert scored["outflow_rate[level]"] == pytest.approx(rate, rel=6e-3)
    factor = {1.0: 2.0 / math.e, 0.5: math.exp(-math.acos(0.5) * 0.5 / math.sqrt(0.75))}
    if damping in factor:  # 0.74 and 0.55 times ΔF²/(A y)
        assert rate == pytest.approx(
            factor[damping] * STEP**2 / (AREA * 0.38) * 3600.0**2, rel=6e-3
        )
    assert [scored[f"{s}[level]"] for s in ("time_outside_band", "above_band", "below_band")] == [
        0.0, 0.0, 0.0,
    ]  # fmt: skip


def test_a_band_that_is_left_is_left_for_as_long_and_as_far_as_the_closed_form_says(tank):
    """The second load comes when the level is not quite back: its motion adds to the rest of the
    first. Samples of 2 s move the peak by about 2 s in 3000 s."""
    plant = tank(0.9, 1.2)
    controller = cl.design.arrest_time(plant, arrest_time=3000.0)
    stop = 10_000.0
    loads = [cl.disturbance("feed", "10 m^3/h", at="0 s")]
    loads += [cl.disturbance("feed", "-10 m^3/h", at=f"{stop} s")]
    _, _, level, _ = response(controller)
    clock = np.linspace(0.0, stop, 100_001)
    first = level(clock)
    second = level(clock + stop) - level(clock)
    above, below = np.maximum(first, second) - 0.2, -0.1 - np.minimum(first, second)
    found = cl.simulate(plant, controller, loads, duration=f"{2 * stop} s").scores
    assert above.max() > 0.1 and below.max() > 0.15
    assert found["above_band[level]"] == pytest.approx(above.max(), abs=1e-3)
    assert found["below_band[level]"] == pytest.approx(below.max(), abs=1e-3)
    outside = np.mean(above > 0.0) + np.mean(below > 0.0)
    assert found["time_outside_band[level]"] == pytest.approx(outside * clock[-1], rel=3e-3)
