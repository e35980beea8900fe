"""The blending tank of docs/examples, its sample line and cell, computed by SciPy alone.

Volume and acid of the blender, of 2 m², balance strong feed s, weak feed w, demand q and sample p:
dV/dt = s + w − q − p and dN/dt = 90 s + 10 w − (q + p) N/V. The sample comes to the cell, of 4 cm²,
as it was 40 s before, and a hole a lets out a √(2 g h).
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import clepsydra as cl

FILE = Path(__file__).parents[1] / "docs" / "examples" / "sample-line.toml"
BLENDER, CELL, HOLE, GRAVITY = 2.0, 4e-4, 0.101e-4, 9.81  # [m²], [m²], [m²], [m/s²]
FEEDS = np.array([0.005, 0.006])  # strong and weak at full speed [m³/s]
STRENGTHS = np.array([90.0, 10.0])  # of them [g/l]
LEVEL, STRENGTH, DEMAND, SAMPLE = 1.2, 40.0, 3e-3, 1e-5  # [m], [g/l], [m³/s], [m³/s]
PERIOD, LATE = 5.0, 8  # [s], samples
SHOWN = ("blender.level", "blender.acid", "cell.level", "strength")
#: Of levels [m] and strengths [g/l], in the order of what is shown.
NEAR = np.array([1e-7, 2e-6, 1e-7, 2e-6])


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


def at_rest():
    """Return both pumps [1]: s + w = q + p and 90 s + 10 w = 40 (q + p)."""
    taken = DEMAND + SAMPLE
    return np.linalg.solve([FEEDS, FEEDS * STRENGTHS], [taken, taken * STRENGTH])


class Vessels:
    """Blender, line and cell from rest, one sample after another (method of steps)."""

    def __init__(self):
        height = (SAMPLE / HOLE) ** 2 / (2 * GRAVITY)
        self.blender = BLENDER * LEVEL * np.array([1.0, STRENGTH])
        self.cell = CELL * height * np.array([1.0, STRENGTH])
        self.line = [(SAMPLE, lambda time: self._at_rest)] * LATE
        self._at_rest = self.blender

    def shown(self):
        (volume, acid), (inside, seen) = self.blender, self.cell
        return np.array([volume / BLENDER, acid / volume, inside / CELL, seen / inside])

    def go_on(self, pumps, demand=DEMAND, sample=SAMPLE):
        feeds, taken = FEEDS * pumps, demand + sample
        came, before = self.line.pop(0)

        def blender(time, state):
            volume, acid = state
            return feeds.sum() - taken, feeds @ STRENGTHS - taken * acid / volume

        def cell(time, state):
            volume, acid = state
            out = HOLE * np.sqrt(2 * GRAVITY * volume / CELL)
            held, within = before(time)
            return came - out, came * within / held - out * acid / volume

        over = {"t_span": (0.0, PERIOD), "method": "DOP853", "rtol": 1e-9}
        mixed = solve_ivp(blender, y0=self.blender, atol=1e-9, dense_output=True, **over)
        shown = solve_ivp(cell, y0=self.cell, atol=1e-13, **over)
        self.line.append((sample, mixed.sol))
        self.blender, self.cell = mixed.y[:, -1], shown.y[:, -1]


def compare(run, expected):
    found = np.array([run.values[name] for name in SHOWN])
    away = np.abs(found - np.array(expected).T).max(axis=1)
    assert np.all(away < NEAR), dict(zip(SHOWN, away, strict=True))


def test_the_strength_has_the_gain_of_what_flows_in_and_only_the_level_integrates(plant):
    """In the end c = (90 s + 10 w)/(s + w), so ∂c/∂s = (90 − c)/(s + w), whatever the level."""
    taken = DEMAND + SAMPLE
    strong, weak = (STRENGTHS - STRENGTH) * FEEDS / taken / 100.0  # [(g/l)/%]
    assert strong == pytest.approx(0.831, abs=5e-4)
    found = cl.analyse(plant)
    level, strength = found.static_gain
    assert strength / 100.0 == pytest.approx([strong, weak], rel=1e-6)
    assert np.isinf(level).all()
    assert sum(abs(pole) < 1e-12 for pole in found.poles) == 1
    said = " ".join(str(found).split())
    assert "strength by strong 0.831 (g/l)/%" in said and "level by weak integrates" in said
    words = " ".join(found.words)
    assert "level integrates" in words and "strength integrates" not in words


def test_it_rests_where_liquid_and_acid_balance(plant):
    point = plant.point.as_dict()
    assert [point["strong"], point["weak"]] == pytest.approx(at_rest(), rel=1e-9)
    assert point["cell.level"] == pytest.approx((SAMPLE / HOLE) ** 2 / (2 * GRAVITY), rel=1e-9)
    assert point["cell.acid"] == pytest.approx(STRENGTH, rel=1e-9)


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_it_answers_to_steps_as_scipy_says(plant, solver):
    """More strong feed, then less weak, then half as much again through the sample line."""
    more, less, faster = at_rest() + (0.05, 0.0), at_rest() + (0.05, -0.04), 1.5 * SAMPLE
    steps = [
        cl.step("strong", "5 %", at="30 s"),
        cl.step("weak", "-4 %", at="10 min"),
        cl.step("sample", to="0.015 l/s", at="20 min"),
    ]
    run = cl.simulate(plant, None, steps, duration="30 min", solver=solver)
    vessels, expected = Vessels(), []
    for k in range(len(run.time)):
        expected.append(vessels.shown())
        pumps = at_rest() if k < 6 else more if k < 120 else less
        vessels.go_on(pumps, sample=faster if k >= 240 else SAMPLE)
    compare(run, expected)
    # For 40 s after the pump has moved the analyser sees nothing of it.
    strength = run.values["strength"]
    assert np.abs(strength[: 6 + LATE + 1] - STRENGTH).max() < 1e-9
    assert strength[6 + LATE + 2] > STRENGTH + 1e-3 and np.ptp(run.values["cell.level"]) > 0.05


def test_a_step_of_the_strong_feed_ends_at_the_mean_of_what_flows_in(plant):
    run = cl.simulate(plant, None, [cl.step("strong", "1 %", at=0)], duration="4 h")
    feeds = FEEDS * (at_rest() + (0.01, 0.0))
    mean = feeds @ STRENGTHS / feeds.sum()
    assert run.values["strength"][-1] == pytest.approx(mean, abs=1e-4)
    assert mean - STRENGTH == pytest.approx(0.831, abs=0.02)  # a step of 1 %
    # The level goes on as what comes in too much says.
    risen = (feeds.sum() - DEMAND - SAMPLE) / BLENDER * run.time[-1]
    assert run.values["level"][-1] == pytest.approx(LEVEL + risen, abs=1e-6)


def test_two_pi_loops_move_it_as_computed_by_hand(plant):
    """u = K e + I and I goes on by K T/Ti e: the level by the weak feed, strength by the strong."""
    by_hand = {"level": {"K": "8 %/%", "Ti": "15 min"}, "strength": {"K": "2 %/%", "Ti": "10 min"}}
    loops = cl.design.simc(plant).with_values(by_hand)
    events = [cl.step("strength", "5 g/l", at="30 s"), cl.step("level", "5 cm", at="20 min"),
              cl.disturbance("demand", "0.3 l/s", at="35 min")]  # fmt: skip
    run = cl.simulate(plant, loops, events, duration="75 min")
    gain, time = np.array([2.0, 8.0]), np.array([600.0, 900.0])
    spans = np.array([100.0, 2.0])  # strength [g/l] and level [m]: as strong and weak
    vessels, integral, expected, moved = Vessels(), at_rest(), [], []
    for k in range(len(run.time)):
        expected.append(vessels.shown())
        setpoint = np.array([STRENGTH + 5.0 * (k >= 6), LEVEL + 0.05 * (k >= 240)])
        error = (setpoint - expected[-1][[3, 0]]) / spans
        pumps = gain * error + integral
        assert np.all((pumps > 0.0) & (pumps < 1.0))  # no limit, so that no anti-windup acts
        integral = integral + gain * PERIOD / time * error
        moved.append(pumps)
        vessels.go_on(pumps, demand=DEMAND + 3e-4 * (k >= 420))
    compare(run, expected)
    for place, name in enumerate(("strong", "weak")):
        assert np.abs(run.values[name] - np.array(moved)[:, place]).max() < 1e-7, name
    assert run.values["strength"].max() > STRENGTH + 5.0 and np.ptp(run.values["strong"]) > 0.1
    assert run.values["strength"][-1] == pytest.approx(STRENGTH + 5.0, abs=0.2)
