"""Static gains of one blending tank from a thimble to a reservoir: units and sizes decide nothing.

The analyser sits on a sample line: what it takes comes later, through a cell. Liquid balances by
hand: level L and strength c of an area A obey A dL/dt = s + w - q - p and
A L dc/dt = s (S - c) + w (W - c), with the feeds s of S = 90 and w of W = 10, the demand q and the
sample p. At rest s + w = q + p, so c answers to a feed by (S - c)/(q + p), and the cell shows c.
"""

from __future__ import annotations

import numpy as np
import pytest
from written_plants import plant_of

STRONG, WEAK, WANTED = 90.0, 10.0, 40.0
DEMAND, SAMPLE = 3.0, 0.01
GAINS = (0.05, 0.06)

#: Area [m²], strength [g/l], speed [1/s] and flow of the sample as multiples of the first plant's.
SIZES = [10.0**decade for decade in (-4.0, -2.3, -0.7, 0.0, 1.4, 3.1, 5.0)]


def sampled(size: float = 1.0, strength: float = 1.0, sample: float = 1.0, speed: float = 1.0):
    flow, taken = size * speed, sample * speed
    return f"""
name = "sampled"
sampling_period = "{5.0 / speed!r} s"
controlled = ["level", "strength"]
[components.A]
range = ["0 g/l", "{100.0 * strength!r} g/l"]
[reservoirs.brine]
concentration = {{ A = "{STRONG * strength!r} g/l" }}
[reservoirs.water]
concentration = {{ A = "{WEAK * strength!r} g/l" }}
[tanks.blender]
area = "{2.0 * size!r} m^2"
height = "2 m"
[pumps.strong]
source = "brine"
destination = "blender"
gain = "{GAINS[0] * flow!r} l/(s %)"
range = ["0 %", "100 %"]
[pumps.weak]
source = "water"
destination = "blender"
gain = "{GAINS[1] * flow!r} l/(s %)"
range = ["0 %", "100 %"]
[flows.demand]
source = "blender"
range = ["0 l/s", "{2.0 * DEMAND * flow!r} l/s"]
nominal = "{DEMAND * flow!r} l/s"
[flows.sample]
source = "blender"
destination = "line"
range = ["0 l/s", "{2.0 * SAMPLE * taken!r} l/s"]
nominal = "{SAMPLE * taken!r} l/s"
[delays.line]
destination = "cell"
time = "{40.0 / speed!r} s"
[tanks.cell]
area = "{4.0 * sample!r} cm^2"
height = "2 m"
[orifices.drain]
source = "cell"
destination = "brine"
area = "{0.101 * taken!r} cm^2"
[sensors.level]
tank = "blender"
range = ["0 m", "2 m"]
[sensors.strength]
tank = "cell"
component = "A"
range = ["0 g/l", "{100.0 * strength!r} g/l"]
[operating_point]
level = "1.2 m"
strength = "{WANTED * strength!r} g/l"
"""


def by_hand(size: float, strength: float, sample: float) -> np.ndarray:
    """Return what the strength answers to the two feeds [g/l per 1]."""
    out = DEMAND * size + SAMPLE * sample
    differences = (np.array([STRONG, WEAK]) - WANTED) * strength
    return 100.0 * np.array(GAINS) * size * differences / out


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("strength", [1e-4, 1.0, 1e5])
@pytest.mark.parametrize("size", SIZES)
def test_a_strength_behind_a_sample_line_settles_at_its_gain(tmp_path, size, strength, fixed):
    # A cell of one size for every tank takes as much as the smallest can give.
    sample = min(1.0, size) if fixed else size
    analysis = plant_of(tmp_path, sampled(size, strength, sample)).analysis
    np.testing.assert_allclose(analysis.static_gain[1], by_hand(size, strength, sample), rtol=1e-11)
    assert analysis.static_gain[0].tolist() == [np.inf, np.inf]
    # 1 / (1 - g12 g21 / (g11 g22)): the level gains by 5 and 6, the strength by 5 · 50 and -6 · 30.
    np.testing.assert_allclose(analysis.relative_gain_array[0], [0.375, 0.625], rtol=1e-9)


@pytest.mark.parametrize("speed", [1e-4, 1e2])
def test_a_fast_and_a_slow_station_have_the_gains_of_the_first(tmp_path, speed):
    analysis = plant_of(tmp_path, sampled(speed=speed)).analysis
    np.testing.assert_allclose(analysis.static_gain[1], by_hand(1.0, 1.0, 1.0), rtol=1e-11)


def test_the_first_station_answers_to_a_percent_by_0_831_g_per_litre(tmp_path):
    plant = plant_of(tmp_path, sampled())
    assert plant.analysis.static_gain[1, 0] / 100.0 == pytest.approx(0.831, abs=5e-4)
    words = " ".join(plant.analysis.words)
    assert "1 pole at the origin" in words


def test_a_leak_of_a_billionth_is_a_leak(tmp_path):
    # A level with an outlet of 1e-9 of the feed settles, however slowly: rounding is less.
    leak = """
[linear_outlets.leak]
source = "blender"
destination = "water"
coefficient = "3e-9 l/(s m)"
"""
    model = plant_of(tmp_path, sampled() + leak).analysis.model
    assert model.A[0, 0] == pytest.approx(-3e-12 / 2.0, rel=1e-9)  # [1/s], of 2 m²
