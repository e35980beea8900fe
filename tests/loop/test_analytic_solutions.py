"""The simulation against solutions in closed form, and the balances that must close."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from clepsydra.loop.open_loop import simulate

GRAVITY = 9.81
LAMINAR = 1e-3


def run(point, samples, substeps, **profiles):
    """Simulate with everything from outside as at the point unless a profile is given."""
    first = (*point.process.inputs, *point.process.disturbances)[0].name
    given = {first: np.full(samples, point.as_dict()[first])} | {
        name.replace("__", "."): values for name, values in profiles.items()
    }
    result = simulate(point, given, substeps=substeps)
    assert all(np.all(np.isfinite(values)) for values in result.values.values())
    return result


def order(errors):
    """Return the order of convergence from errors with a step that is halved each time."""
    return -np.diff(np.log2(errors))


def laminar_time(difference, rate, laminar=LAMINAR):
    """Return the time from `laminar` down to a difference [s], where Δ' = -rate φ(Δ).

    With w = (Δ/δ)² the law φ = √δ (45 s - 18 s³ + 5 s⁵)/32 gives 2 dt ∝ -dw / (w P),
    P = 5 w² - 18 w + 45, and the partial fractions are 1/(45 w) - (5 w - 18)/(45 P).
    """

    def primitive(w):
        polynomial = 5 * w**2 - 18 * w + 45
        fractions = np.log(w) - np.log(polynomial) / 2 + 9 / 12 * np.arctan((10 * w - 18) / 24)
        return fractions / 90

    scale = 32 * np.sqrt(laminar) / rate
    return scale * (primitive(1.0) - primitive((difference / laminar) ** 2))


DRAINED = """
controlled = ["level"]
[reservoirs.basin]
[tanks.tank]
{vessel}
[orifices.outlet]
source = "tank"
destination = "basin"
area = "1 cm^2"
discharge = 0.62
[pumps.pump]
source = "basin"
destination = "tank"
gain = "1 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "0 V"
[sensors.level]
tank = "tank"
range = ["0 cm", "30 cm"]
"""
OUTLET = 0.62e-4 * np.sqrt(2 * GRAVITY)


def test_a_cylinder_drains_by_torricelli(start):
    """√h falls in a straight line as long as the flow is turbulent."""
    rate = OUTLET / 100e-4
    text = DRAINED.format(vessel='area = "100 cm^2"\nheight = "30 cm"')
    point, samples = start(text, 6.0, tank__level=0.2), 4
    exact = (np.sqrt(0.2) - rate / 2 * 6.0 * np.arange(samples + 1)) ** 2
    assert exact[-1] > LAMINAR
    errors = []
    for substeps in (1, 2, 4, 8):
        result = run(point, samples, substeps)
        errors.append(np.max(np.abs(result.values["tank.level"] - exact)) / 0.3)
        assert result.balances[0].error < 1e-12
    assert errors[-1] < 1e-7
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.3)


def test_a_cylinder_ends_in_the_laminar_range(start):
    """The last millimetre: the time at which each level stands, in closed form."""
    rate = OUTLET / 100e-4
    text = DRAINED.format(vessel='area = "100 cm^2"\nheight = "30 cm"')
    point, samples = start(text, 1.0, tank__level=LAMINAR), 5
    late = []
    for substeps in (8, 16, 32):
        result = run(point, samples, substeps)
        level = result.values["tank.level"]
        time = laminar_time(level[1:], rate)
        late.append(np.max(np.abs(time - result.time[1:])))
        assert np.all(np.diff(level) < 0) and 0 < level[-1] < 1e-2 * LAMINAR
    assert late[-1] < 1e-6
    assert np.all(np.abs(order(late) - 4) < 0.3)


def test_a_cylinder_crosses_into_the_laminar_range(start):
    rate = OUTLET / 100e-4
    text = DRAINED.format(vessel='area = "100 cm^2"\nheight = "30 cm"')
    point = start(text, 1.0, tank__level=0.02)
    turbulent = 2 / rate * (np.sqrt(0.02) - np.sqrt(LAMINAR))
    samples = round(turbulent) + 8
    result = run(point, samples, 32)
    level = result.values["tank.level"][1:]
    root_law = 2 / rate * (np.sqrt(0.02) - np.sqrt(level))
    time = np.where(
        level > LAMINAR, root_law, turbulent + laminar_time(np.minimum(level, LAMINAR), rate)
    )
    assert level[0] > LAMINAR > level[-1]
    assert np.max(np.abs(time - result.time[1:])) < 1e-6


def test_a_cone_drains_with_the_power_of_five_halves(start):
    """A = π (ρ h)² and A h' = -k √h: h^(5/2) falls in a straight line."""
    text = DRAINED.format(vessel='shape = "cone"\nrim_diameter = "20 cm"\nheight = "30 cm"')
    slope = 2.5 * OUTLET / (np.pi * (0.1 / 0.3) ** 2)
    point, samples = start(text, 1.0, tank__level=0.28), 8
    exact = (0.28**2.5 - slope * np.arange(samples + 1)) ** 0.4
    assert exact[-1] > LAMINAR
    errors = []
    for substeps in (1, 2, 4, 8):
        result = run(point, samples, substeps)
        errors.append(np.max(np.abs(result.values["tank.level"] - exact)) / 0.3)
        assert result.balances[0].error < 1e-12
    assert errors[-1] < 1e-6
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.3)


def test_a_sphere_fills_at_constant_flow(start):
    """V = V₀ + q t, and 3 s² - 2 s³ = v has the root s = 1/2 + sin(asin(2 v - 1)/3)."""
    text = """
    controlled = ["level"]
    [reservoirs.basin]
    [tanks.tank]
    shape = "sphere"
    diameter = "1 m"
    [pumps.pump]
    source = "basin"
    destination = "tank"
    gain = "1 l/(s V)"
    range = ["0 V", "10 V"]
    nominal = "5 V"
    [sensors.level]
    tank = "tank"
    range = ["0 m", "1 m"]
    """
    point, samples = start(text, 1.0, tank__level=0.02), 100
    result = run(point, samples, 1)
    capacity, share = np.pi / 6, 3 * 0.02**2 - 2 * 0.02**3
    volume = share * capacity + 5e-3 * result.time
    exact = 0.5 + np.sin(np.arcsin(2 * volume / capacity - 1) / 3)
    assert 0.85 < exact[-1] < 1.0
    assert np.max(np.abs(result.values["tank.level"] - exact)) < 1e-13
    assert result.balances[0].error < 1e-14
    assert result.balances[0].entered == pytest.approx(0.5, rel=1e-14)


JOINED = """
controlled = ["level"]
[reservoirs.basin]
[tanks.left]
area = "100 cm^2"
height = "60 cm"
[tanks.right]
area = "200 cm^2"
height = "60 cm"
{joint}
[flows.feed]
destination = "right"
range = ["0 cm^3/s", "200 cm^3/s"]
nominal = "0 cm^3/s"
[pumps.pump]
source = "basin"
destination = "left"
gain = "1 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "0 V"
[sensors.level]
tank = "left"
range = ["0 cm", "60 cm"]
"""
OPENING = """[orifices.opening]
source = "left"
destination = "right"
area = "1 cm^2"
discharge = 0.62
submerged = true
"""
INVERSE = 1 / 100e-4 + 1 / 200e-4


@pytest.mark.parametrize("higher", ["left", "right"])
def test_two_tanks_equalise_by_the_root_law_and_then_the_laminar_one(start, higher):
    rate = OUTLET * INVERSE
    levels = {"left__level": 0.2, "right__level": 0.2, f"{higher}__level": 0.22}
    point = start(JOINED.format(joint=OPENING), 0.5, **levels)
    turbulent = 2 / rate * (np.sqrt(0.02) - np.sqrt(LAMINAR))
    samples = round(2 * turbulent) + 6
    result = run(point, samples, 16)
    left, right = result.values["left.level"], result.values["right.level"]
    difference = (left - right)[1:] * (1 if higher == "left" else -1)
    assert np.all(difference > 0) and difference[-1] < 0.1 * LAMINAR
    time = np.where(
        difference > LAMINAR,
        2 / rate * (np.sqrt(0.02) - np.sqrt(difference)),
        turbulent + laminar_time(np.minimum(difference, LAMINAR), rate),
    )
    assert np.max(np.abs(time - result.time[1:])) < 1e-6
    content = 100e-4 * left + 200e-4 * right
    assert np.max(np.abs(content - content[0])) < 1e-15
    assert result.balances[0].entered == result.balances[0].left == 0.0


def test_the_levels_of_two_tanks_change_places(start):
    """A feed to the lower tank, so that the difference goes through zero and stays beyond.

    Δ' = -κ φ(Δ) - p. While turbulent, with r = √Δ, the time is that of the root law with a
    logarithm; in the laminar range it is a quadrature of our own.
    """
    rate, feed = OUTLET * INVERSE, 20e-6 / 200e-4
    point = start(JOINED.format(joint=OPENING), 0.5, left__level=0.22, right__level=0.2)

    def law(difference):
        share = difference / LAMINAR
        return np.sqrt(LAMINAR) * (45 * share - 18 * share**3 + 5 * share**5) / 32

    def down_to(difference):
        """Return the time from 0.02 m to a difference."""
        root = np.sqrt(max(difference, LAMINAR))

        def primitive(r):
            return 2 / rate * (r - feed / rate * np.log(rate * r + feed))

        turbulent = primitive(np.sqrt(0.02)) - primitive(root)
        if difference >= LAMINAR:
            return turbulent
        return (
            turbulent
            + quad(
                lambda value: 1 / (rate * law(value) + feed),
                difference, LAMINAR, epsabs=1e-13, epsrel=1e-12,
            )[0]
        )  # fmt: skip

    samples = 60
    result = run(point, samples, 16, feed=np.full(samples, 20e-6))
    difference = result.values["left.level"] - result.values["right.level"]
    # It comes to rest at κ φ = -p, inside the laminar range and below zero.
    moving = difference - difference[-1] > 1e-2 * LAMINAR
    late = [down_to(d) - t for d, t in zip(difference[moving], result.time[moving], strict=True)]
    assert np.sum(difference[moving] > LAMINAR) > 5
    assert np.sum(np.abs(difference[moving]) < LAMINAR) > 3
    assert np.sum(difference[moving] < 0) >= 2
    assert np.max(np.abs(late)) < 1e-6
    assert rate * law(difference[-1]) + feed == pytest.approx(0.0, abs=1e-6 * feed)
    assert result.balances[0].error < 1e-12


def test_two_tanks_with_a_linear_joint_equalise_exponentially(start):
    joint = (
        '[linear_outlets.tube]\nsource = "left"\ndestination = "right"\n'
        'coefficient = "5 cm^2/s"\nsubmerged = true\n'
    )
    point, samples = start(JOINED.format(joint=joint), 8.0, left__level=0.4, right__level=0.1), 12
    errors = []
    for substeps in (1, 2, 4, 8):
        result = run(point, samples, substeps)
        exact = 0.3 * np.exp(-5e-4 * INVERSE * result.time)
        left, right = result.values["left.level"], result.values["right.level"]
        errors.append(np.max(np.abs(left - right - exact)) / 0.6)
        assert np.max(np.abs(left + 2 * right - 0.6)) < 1e-14
    assert errors[-1] < 1e-7
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.2)


MIXED = """
manipulated = ["drain"]
controlled = ["level"]
[components.salt]
range = ["0 kg/m^3", "100 kg/m^3"]
[tanks.tank]
area = "1 m^2"
height = "2 m"
[flows.feed]
destination = "tank"
range = ["0 l/s", "50 l/s"]
nominal = "10 l/s"
concentration = { salt = "30 kg/m^3" }
[flows.drain]
source = "tank"
range = ["0 l/s", "50 l/s"]
nominal = "10 l/s"
[sensors.level]
tank = "tank"
range = ["0 m", "2 m"]
"""


def test_a_constant_volume_is_washed_out_exponentially(start):
    point, samples = start(MIXED, 20.0, tank__level=0.5, tank__salt=5.0), 15
    errors = []
    for substeps in (1, 2, 4, 8):
        result = run(point, samples, substeps)
        exact = 30 - 25 * np.exp(-10e-3 / 0.5 * result.time)
        errors.append(np.max(np.abs(result.values["tank.salt"] - exact)) / 30)
        assert np.all(result.values["tank.level"] == 0.5)
        liquid, salt = result.balances
        assert liquid.entered == pytest.approx(10e-3 * 300, rel=1e-14)
        assert salt.entered == pytest.approx(0.3 * 300, rel=1e-14)
        assert liquid.error < 1e-13 and salt.error < 1e-13
    assert errors[-1] < 1e-6
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.2)


@pytest.mark.parametrize(("entering", "leaving"), [(25e-3, 10e-3), (10e-3, 25e-3)])
def test_a_varying_volume_mixes_with_a_power_of_the_volume(start, entering, leaving):
    """C = C_in + (C₀ - C_in) (V₀/V)^(q_in/(q_in - q_out))."""
    first = 0.4 if entering > leaving else 1.6
    point, samples = start(MIXED, 10.0, tank__level=first, tank__salt=5.0), 9
    errors = []
    for substeps in (1, 2, 4, 8):
        profiles = {"feed": np.full(samples, entering), "drain": np.full(samples, leaving)}
        result = run(point, samples, substeps, **profiles)
        volume = first + (entering - leaving) * result.time
        exact = 30 - 25 * (first / volume) ** (entering / (entering - leaving))
        errors.append(np.max(np.abs(result.values["tank.salt"] - exact)) / 30)
        assert np.max(np.abs(result.values["tank.level"] - volume)) < 1e-14
        assert all(balance.error < 1e-12 for balance in result.balances)
    assert errors[-1] < 1e-6
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.35)


@pytest.mark.thorough
def test_two_mixed_tanks_in_series(start):
    """C₂ = C_in + (C₂₀ - C_in + (C₁₀ - C_in) t/τ) exp(-t/τ) for two equal volumes."""
    text = MIXED.replace('[flows.drain]\nsource = "tank"', """[tanks.second]
area = "0.5 m^2"
height = "2 m"
[flows.between]
source = "tank"
destination = "second"
range = ["0 l/s", "50 l/s"]
nominal = "10 l/s"
[flows.drain]
source = "second" """)  # fmt: skip
    state = {"tank__level": 0.5, "tank__salt": 5.0, "second__level": 1.0, "second__salt": 80.0}
    point, samples = start(text, 20.0, **state), 15
    errors = []
    for substeps in (1, 2, 4, 8):
        result = run(point, samples, substeps)
        share = result.time * 10e-3 / 0.5
        exact = 30 + (80 - 30 + (5 - 30) * share) * np.exp(-share)
        errors.append(np.max(np.abs(result.values["second.salt"] - exact)) / 80)
        assert all(balance.error < 1e-13 for balance in result.balances)
    assert errors[-1] < 1e-6
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.2)


DELAYED = """
controlled = ["level"]
[components.salt]
range = ["0 kg/m^3", "100 kg/m^3"]
[reservoirs.brine]
concentration = { salt = "20 kg/m^3" }
[delays.channel]
destination = "tank"
time = "7 s"
[tanks.tank]
area = "1 m^2"
height = "4 m"
[flows.feed]
destination = "channel"
range = ["0 l/s", "50 l/s"]
nominal = "10 l/s"
[flows.feed.concentration.salt]
range = ["0 kg/m^3", "100 kg/m^3"]
nominal = "30 kg/m^3"
[pumps.pump]
source = "brine"
destination = "channel"
gain = "2 l/(s V)"
range = ["0 V", "10 V"]
nominal = "0 V"
rate = "0.25 V/s"
[sensors.level]
tank = "tank"
range = ["0 m", "4 m"]
"""


@pytest.mark.parametrize("substeps", [1, 3])
def test_a_step_arrives_exactly_after_the_dead_time(start, substeps):
    """The tank counts what arrives: no drop of a step of 15 l/s before its time, or after."""
    point, samples = start(DELAYED, 1.0, tank__level=1.0, tank__salt=30.0, pump__actual=0.0), 30
    feed, salt = np.full(samples, 10e-3), np.full(samples, 30.0)
    feed[5:], salt[9:] = 25e-3, 50.0
    result = run(point, samples, substeps, feed=feed, feed__salt=salt)
    time = result.time
    volume = 1.0 + 10e-3 * time + 15e-3 * np.maximum(time - 5 - 7, 0)
    amount = 30 * volume + 25e-3 * 20 * np.maximum(time - 9 - 7, 0)
    assert np.max(np.abs(result.values["tank.level"] - volume)) < 1e-14
    assert np.max(np.abs(result.values["tank.salt"] - amount / volume)) < 1e-12
    assert all(balance.error < 1e-13 for balance in result.balances)
    entered = [float(np.sum(feed)), float(np.sum(feed * salt))]
    assert [b.entered for b in result.balances] == pytest.approx(entered, rel=1e-14)


def test_a_ramp_arrives_exactly_after_the_dead_time(start):
    """A pump at its largest rate: its flow is 0.5 l/s² t, and the volume a parabola 7 s later."""
    point, samples = start(DELAYED, 1.0, tank__level=1.0, tank__salt=30.0, pump__actual=0.0), 30
    result = run(point, samples, 1, pump=np.full(samples, 10.0))
    late = np.maximum(result.time - 7, 0)
    pumped = 0.5e-3 * late**2 / 2
    volume = 1.0 + 10e-3 * result.time + pumped
    assert np.max(np.abs(result.values["tank.level"] - volume)) < 1e-14
    concentration = (30 * (volume - pumped) + 20 * pumped) / volume
    assert np.max(np.abs(result.values["tank.salt"] - concentration)) < 1e-13
    assert all(balance.error < 1e-13 for balance in result.balances)


def test_a_delay_between_two_tanks_keeps_the_order(start):
    """Upper tank at rate a, lower at rate b, what arrives being constant for the dead time."""
    text = """
    controlled = ["level"]
    [reservoirs.basin]
    [tanks.upper]
    area = "1 m^2"
    height = "2 m"
    [tanks.lower]
    area = "0.5 m^2"
    height = "2 m"
    [delays.channel]
    destination = "lower"
    time = "32 s"
    [linear_outlets.upper_outlet]
    source = "upper"
    destination = "channel"
    coefficient = "0.02 m^2/s"
    [linear_outlets.lower_outlet]
    source = "lower"
    destination = "basin"
    coefficient = "0.03 m^2/s"
    [pumps.pump]
    source = "basin"
    destination = "upper"
    gain = "1 l/(s V)"
    range = ["0 V", "10 V"]
    nominal = "0 V"
    [sensors.level]
    tank = "lower"
    range = ["0 m", "2 m"]
    """
    point, samples = start(text, 16.0, upper__level=1.5, lower__level=0.2), 12
    a, b, first = 0.02 / 1.0, 0.03 / 0.5, 0.02 * 1.5 / 0.5
    errors = []
    for substeps in (1, 2, 4, 8):
        result = run(point, samples, substeps)
        early = np.minimum(result.time, 32.0)
        before = first / b + (0.2 - first / b) * np.exp(-b * early)
        late = np.maximum(result.time - 32.0, 0.0)
        exact = before * np.exp(-b * late) + first / (b - a) * (
            np.exp(-a * late) - np.exp(-b * late)
        )
        errors.append(np.max(np.abs(result.values["lower.level"] - exact)) / 2)
        assert result.balances[0].error < 1e-13
    assert errors[-1] < 1e-6
    assert np.all(np.abs(order(errors)[1:] - 4) < 0.3)


def test_a_pump_begins_to_deliver_when_it_lifts_to_the_end_of_its_pipe(start):
    """n² H₀ = H_s at t = -T ln(1 - √(H_s/H₀)); then q² = (n² H₀ - H_s)/(b + r)."""
    text = """
    controlled = ["level"]
    [reservoirs.basin]
    [tanks.tank]
    area = "0.1 m^2"
    height = "4 m"
    [pumps.pump]
    source = "basin"
    destination = "tank"
    curve = [["0 l/s", "30 m"], ["10 l/s", "18 m"]]
    static_head = "12 m"
    pipe_loss = "30000 s^2/m^5"
    range = ["0 %", "100 %"]
    nominal = "0 %"
    lag = "4 s"
    [sensors.level]
    tank = "tank"
    range = ["0 m", "4 m"]
    """
    point, samples = start(text, 0.5, tank__level=0.5, pump__actual=0.0), 40
    begins = -4 * np.log(1 - np.sqrt(12 / 30))
    friction = (30 - 18) / 0.01**2 + 30000
    smallest = (0.01 * 0.01) ** 2

    def flow(time):
        squared = max((1 - np.exp(-time / 4)) ** 2 * 30 - 12, 0.0) / friction
        if squared >= smallest:
            return np.sqrt(squared)
        share = squared / smallest
        return np.sqrt(smallest) * (45 * share - 18 * share**3 + 5 * share**5) / 32

    turbulent = -4 * np.log(1 - np.sqrt((12 + friction * smallest) / 30))
    result = run(point, samples, 64, pump=np.ones(samples))
    level = result.values["tank.level"]
    exact = np.full(samples + 1, 0.5)
    for place, time in enumerate(result.time):
        corners = [c for c in (begins, turbulent) if c < time]
        ends = [*corners, time]
        exact[place] += 10 * sum(
            quad(flow, a, b, epsabs=1e-13, epsrel=1e-12)[0] for a, b in pairwise(ends)
        )
    assert np.max(np.abs(result.values["pump.actual"] - (1 - np.exp(-result.time / 4)))) < 1e-10
    assert np.all(level[result.time < begins] == 0.5)
    assert np.all(np.diff(level[result.time > begins - 0.5]) > 0)
    assert np.max(np.abs(level - exact)) < 1e-6
    full = np.sqrt((30 - 12) / friction)
    assert flow(1e3) == pytest.approx(full, rel=1e-12)


def test_a_surface_evaporates_at_constant_speed_and_leaves_its_salt(start):
    text = MIXED.replace('height = "2 m"', 'height = "2 m"\nevaporation = "10 mm/h"')
    point, samples = start(text, 60.0, tank__level=0.5, tank__salt=20.0), 600
    still = np.zeros(samples)
    result = run(point, samples, 1, feed=still, drain=still)
    level = 0.5 - 0.01 / 3600 * result.time
    assert np.max(np.abs(result.values["tank.level"] - level)) < 1e-13
    assert np.max(np.abs(result.values["tank.salt"] - 10 / level)) < 1e-10
    liquid, salt = result.balances
    assert liquid.left == pytest.approx(0.1, rel=1e-12) and liquid.error < 1e-11
    assert salt.entered == salt.left == salt.gained == 0.0
