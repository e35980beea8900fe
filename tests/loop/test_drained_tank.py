"""A tank that drains through a hole, against Torricelli's closed form and the law of a film."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.interpolate import CubicSpline

import clepsydra as cl
from clepsydra.loop.open_loop import simulate

AREA, HOLE, HEIGHT, GRAVITY = 28e-4, 0.071e-4, 0.2, 9.81
LAMINAR = 1e-3


@pytest.fixture(scope="module")
def drained():
    """Return a function (step [s], samples) → levels, with the pump off, from a full tank."""
    plant = cl.load(Path(__file__).parents[1] / "one-tank.toml")

    def run(step: float, samples: int) -> np.ndarray:
        point = replace(plant.point, process=replace(plant.process, sampling_period=step))
        shut = {signal.name: np.zeros(samples - 1) for signal in plant.process.inputs}
        run = simulate(point, shut, substeps=1, state={"tank_1.level": HEIGHT})
        return run.values["tank_1.level"]

    return run


def closed_form(time: np.ndarray) -> np.ndarray:
    """h(t) = (√h0 - a/A √(g/2) t)² while the level is above 1 mm."""
    root = np.sqrt(HEIGHT) - HOLE / AREA * np.sqrt(GRAVITY / 2) * time
    assert np.all(root**2 >= LAMINAR)
    return root**2


def film(time: np.ndarray) -> np.ndarray:
    """h(t) below 1 mm, where the root is √δ (45 s - 18 s³ + 5 s⁵)/32 of s = h/δ.

    With y = ln s: dt/dy = -32 √δ / (k (45 - 18 e^2y + 5 e^4y)), k = a/A √(2 g), integrated from
    the moment at which the level passes 1 mm, and turned round.
    """
    k = HOLE / AREA * np.sqrt(2 * GRAVITY)
    passed = 2 / k * (np.sqrt(HEIGHT) - np.sqrt(LAMINAR))
    assert np.all(time >= passed)
    y = np.linspace(0.0, -80.0, 80001)
    slope = 32 * np.sqrt(LAMINAR) / (k * (45 - 18 * np.exp(2 * y) + 5 * np.exp(4 * y)))
    after = passed + cumulative_simpson(slope, dx=1e-3, initial=0.0)
    return LAMINAR * np.exp(CubicSpline(after, y)(time))


def test_a_draining_tank_follows_torricelli_while_there_is_liquid(drained):
    errors = []
    for step in (0.5, 0.25):
        samples = round(70 / step)
        exact = closed_form(step * np.arange(samples))
        errors.append(np.max(np.abs(drained(step, samples) - exact)) / HEIGHT)
    assert errors[0] < 1e-8
    assert 14 < errors[0] / errors[1] < 18


def test_the_last_film_runs_off_and_no_more(drained):
    """At 1 mm the law changes with equal value, slope and curvature: the order stays four."""
    errors = []
    for step in (0.5, 0.25, 0.125):
        time = step * np.arange(round(200 / step))
        level = drained(step, len(time))
        assert np.all(level > 0.0)
        assert np.all(np.diff(level) < 0.0)
        thin = time > 76.0
        assert level[thin][0] < LAMINAR / 2
        errors.append(np.max(np.abs(level[thin] - film(time[thin]))) / LAMINAR)
        assert level[-1] == pytest.approx(film(time[-1:])[0], rel=0.01 * step)
    assert errors[0] < 1e-5
    assert np.all(
        (np.divide(errors[:-1], errors[1:]) > 14) & (np.divide(errors[:-1], errors[1:]) < 19)
    )
