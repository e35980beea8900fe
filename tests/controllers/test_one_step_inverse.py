"""The one-step inverse: its moves against an optimiser, its tank in closed form, its starts."""

import casadi as ca
import numpy as np
import pytest
from scan_rig import ScannedLaw, at_rest
from scipy.optimize import linprog

import clepsydra as cl
from clepsydra.controllers.blocks.shared_limits import shared_moves

PLANT = cl.load("averaging-tank")
PERIOD = PLANT.process.sampling_period
OUTFLOW = 0.2


@pytest.fixture(scope="module")
def controller():
    return cl.design.inverse(PLANT)


@pytest.fixture
def law(controller):
    """The law at rest; told that it lost its measurements it takes the next as they are."""
    scanned = ScannedLaw(controller, PERIOD)
    scanned.scan(**at_rest(controller, PLANT))
    return scanned


def tank_after(volume, concentration, inflow, entering, time=PERIOD):
    """What a mixed tank holds after a time of constant flows, in closed form."""
    later = volume + (inflow - OUTFLOW) * time
    if inflow == OUTFLOW:
        share = np.exp(-inflow * time / volume)
    else:
        share = (later / volume) ** (-inflow / (inflow - OUTFLOW))
    return later, entering + (concentration - entering) * share


def moved(outputs):
    return outputs["inflow.out"], outputs["inflow.impurity.out"]


def least_left(errors, slopes, low, high, largest):
    """The same by linear programming: |e − S δ| ≤ s, Σ s/ē least."""
    m = len(errors)
    rows = np.block([[-slopes, -np.eye(m)], [slopes, -np.eye(m)]])
    ends = [*zip(low, high, strict=True), *[(0.0, None)] * m]
    cost = np.concatenate([np.zeros(m), 1.0 / largest])
    return linprog(cost, rows, np.concatenate([-errors, errors]), bounds=ends).fun


@pytest.mark.parametrize("inputs", [1, 2])
def test_the_moves_within_limits_leave_the_least_sum(inputs):
    m = inputs
    e, S, low, high, largest = (
        ca.SX.sym(name, *shape)
        for name, shape in zip("eSlhm", ((m,), (m, m), (m,), (m,), (m,)), strict=True)
    )
    split = ca.vertsplit
    found = ca.Function("moves", [e, S, low, high, largest], [ca.vertcat(*shared_moves(
        split(e), [ca.horzsplit(row) for row in split(S)], split(low), split(high), split(largest)
    ))])  # fmt: skip
    random, cut_short = np.random.default_rng(5), 0
    for _ in range(300):
        errors, slopes = random.normal(size=m), random.normal(size=(m, m))
        slopes[random.random((m, m)) < 0.2] = 0.0
        ends = -random.uniform(0.0, 1.5, m), random.uniform(0.0, 1.5, m)
        sizes = random.uniform(0.5, 2.0, m)
        moves = np.array(found(errors, slopes, *ends, sizes)).ravel()
        assert np.all((ends[0] <= moves) & (moves <= ends[1]))
        left = np.sum(np.abs(errors - slopes @ moves) / sizes)
        best = least_left(errors, slopes, *ends, sizes)
        # Gains of a millionth decide nothing, at each of the corners.
        assert left == pytest.approx(best, abs=13e-6)
        cut_short += best > 0.01
    assert 100 < cut_short < 300


@pytest.mark.parametrize(
    ("concentration", "volume"), [(5100.0, 2.0), (5000.0, 2.01), (4990.0, 1.99), (5030.0, 2.02)]
)
def test_both_outputs_are_at_their_setpoints_in_the_next_sample(law, concentration, volume):
    found = moved(law.scan(concentration_sp=concentration, volume_sp=volume))
    after = tank_after(2.0, 5000.0, *found)
    # Of steps of 0.01 m³ and 10 mol/m³: what four turns and three steps of Runge-Kutta leave.
    assert after == pytest.approx((volume, concentration), rel=1e-7)


def test_wherever_the_tank_is_hardly_any_inputs_leave_less(law):
    """Against a grid of inputs; a product of inputs may have a lesser hollow elsewhere."""
    random = np.random.default_rng(2)
    flows, entering = np.linspace(0.0, 1.0, 201), np.linspace(0.0, 25e3, 201)
    at_limits, missed = 0, []
    for _ in range(60):
        volume, concentration = random.uniform(0.5, 3.5), random.uniform(1e3, 2e4)
        aims = np.array([volume, concentration]) + random.normal(size=2) * [0.1, 2e3]
        law.state["lost"] = 1.0
        flow, impurity = moved(law.scan(
            volume_pv=volume, concentration_pv=concentration, volume_sp=aims[0],
            concentration_sp=aims[1],
        ))  # fmt: skip

        def left(inflow, impurities, start=(volume, concentration), aims=aims):
            after, mixed = tank_after(*start, inflow, impurities)
            return np.abs(aims[0] - after) / 0.4 + np.abs(aims[1] - mixed) / 2500.0

        best = min(np.min(left(each, entering)) for each in flows)
        missed.append(float(left(flow, impurity)) - best)
        at_limits += min(flow, 1.0 - flow) < 1e-9 or min(impurity, 25e3 - impurity) < 1e-6
    assert 20 < at_limits < 60
    assert np.mean(np.array(missed) < 1e-6) > 0.9
    assert max(missed) < 0.02


def test_an_input_that_stands_is_worked_around(law):
    """With the concentrate by hand, the flow decides between both outputs by their sizes."""
    hand = {"inflow.impurity.mode": 0, "inflow.impurity.manual": 9000.0}
    law.scans(40, **hand)
    flow, entering = moved(law.scan(concentration_sp=5000.0, volume_sp=2.05, **hand))
    assert entering == 9000.0
    # A volume too low by 0.05 of 0.4 m³ outweighs what 9 kmol/m³ do to 5 of 2.5 kmol/m³.
    assert 2.0 + (flow - OUTFLOW) * PERIOD == pytest.approx(2.05, abs=1e-6)


def test_a_load_fades_with_both_poles_of_the_observer(controller):
    """The volume is then off by d Δt k p^(k − 1), after k samples, and comes back by itself."""
    time = controller.values["volume.observer_time"]
    pole, load = time / (time + PERIOD), 0.02
    run = cl.simulate(PLANT, controller, [cl.step("outflow", load, at="1 s")], duration="6 s")
    off = run.true_measurement("volume") - 2.0
    k = np.arange(len(off)) - round(1.0 / PERIOD)
    expected = -load * PERIOD * np.where(k > 0, k * pole ** (k - 1.0), 0.0)
    assert off == pytest.approx(expected, abs=1e-8)
    assert abs(off[-1]) < 1e-6 * load


def test_the_setpoint_is_followed_however_slow_the_observer():
    slow = cl.design.inverse(PLANT, observer_time="100 s")
    run = cl.simulate(PLANT, slow, [cl.step("volume", "+0.05 m^3", at="1 s")], duration="3 s")
    volume = run.true_measurement("volume")
    first = round(1.0 / PERIOD) + 1
    assert volume[first:] == pytest.approx(2.05, abs=1e-7)


@pytest.mark.parametrize("mode", ["manual", "tracking"])
def test_automatic_goes_on_from_where_the_inputs_stand_and_then_fades(law, controller, mode):
    """The flows were moved by hand, and the volume is far from its setpoint."""
    number = {"manual": 0, "tracking": 2}[mode]
    hand = {f"{name}.mode": number for name in controller.manipulated}
    hand |= {f"inflow.{mode}": 0.3, f"inflow.impurity.{mode}": 6000.0}
    law.scans(200, **hand)
    automatic = {f"{name}.mode": 1 for name in controller.manipulated}
    first = law.scan(volume_sp=2.5, **automatic)
    assert moved(first) == pytest.approx((0.3, 6000.0), rel=1e-6)
    share = PERIOD / controller.values["volume.fading_time"]
    assert law.state["volume.start_offset"] == pytest.approx(-0.5 * (1.0 - share), rel=1e-6)
    law.scan()
    assert law.state["volume.start_offset"] == pytest.approx(-0.5 * (1.0 - share) ** 2, rel=1e-6)


def test_what_was_lost_is_taken_as_it_comes_back(law):
    held = moved(law.scan(volume_good=0))
    assert moved(law.scans(10, volume_good=0, volume_pv=np.nan)) == held
    back = moved(law.scan(volume_good=1, volume_pv=2.3))
    assert law.named["volume.surprise"] == 0.0
    assert law.state["volume.unmodelled_rate"] == 0.0
    assert back == pytest.approx(held, rel=1e-6)
