"""The blending tank of docs/examples with its analyser, computed by SciPy alone.

Volume and salt of the blender, of 0.5 m², balance brine b of 100 g/l, water w, rinse r and what the
hole of 4 cm² lets out, q = a √(2 g h): dV/dt = b + w + r − q and dN/dt = 100 b − q N/V. What the
analyser tells is N/V of 40 s before, or of its last report.
"""

from pathlib import Path

import numpy as np
import pytest
from refusals import refused
from scipy.integrate import solve_ivp
from written_plants import plant_of

import clepsydra as cl

TEXT = (Path(__file__).parents[1] / "docs" / "examples" / "analyser.toml").read_text("utf-8")
LATE = 'dead_time = "40 s"'
AREA, HOLE, GRAVITY = 0.5, 4e-4, 9.81  # [m²], [m²], [m/s²]
LEVEL, STRENGTH, RINSE, STORE = 0.5, 30.0, 1e-4, 100.0  # [m], [g/l], [m³/s], [g/l]
GAINS = np.array([1e-3, 2e-3])  # of brine and water at full speed [m³/s]
PERIOD = 5.0  # [s]
NEAR = 1e-6  # of 0 to 1 m and, times a hundred, of 0 to 100 g/l


@pytest.fixture
def plant(tmp_path):
    return plant_of(tmp_path, TEXT)


def at_rest():
    """Return both pumps [1]: b + w + r = q and 100 b = 30 q."""
    out = HOLE * np.sqrt(2 * GRAVITY * LEVEL)
    brine = STRENGTH / STORE * out
    return np.array([brine, out - brine - RINSE]) / GAINS


def blender(pumps, rinse, lag=1.0):
    """Return level [m], strength and lagged strength [g/l] at each sample, from rest."""
    state = np.array([AREA * LEVEL, AREA * LEVEL * STRENGTH, STRENGTH])
    found = []
    for (brine, water), more in zip(GAINS * pumps, rinse, strict=True):
        found.append((state[0] / AREA, state[1] / state[0], state[2]))

        def rates(time, now, brine=brine, water=water, more=more):
            out, strength = HOLE * np.sqrt(2 * GRAVITY * now[0] / AREA), now[1] / now[0]
            salt = STORE * brine - out * strength
            return brine + water + more - out, salt, (strength - now[2]) / lag

        over = {"t_span": (0.0, PERIOD), "method": "DOP853", "rtol": 1e-10, "atol": 1e-12}
        state = solve_ivp(rates, y0=state, **over).y[:, -1]
    return np.array(found).T


def moved(samples):
    """Return pumps and rinse that step at some samples, from rest."""
    time = np.arange(samples)
    brine, water = at_rest()
    pumps = np.column_stack([brine + 0.1 * (time >= 20), water - 0.1 * (time >= 60)])
    return pumps, RINSE + 5e-5 * (time >= 90)


def steps_to(pumps):
    """Return these steps as events."""
    return [
        cl.step("brine", to=f"{100 * pumps[0]:.17g} %", at="100 s"),
        cl.step("water", to=f"{100 * pumps[1]:.17g} %", at="300 s"),
        cl.step("rinse", to="0.15 l/s", at="450 s"),
    ]


def held(late, every, first):
    """Return which sample's strength is told in each of 200, −1 for that at rest."""
    told, found = -1, []
    for sample in range(200):
        if sample >= first and (sample - first) % every == 0:
            told = max(sample - late, -1)
        found.append(told)
    return found


SENSORS = {
    LATE: (8, 1, 0),
    'sampling = "1 min"': (0, 12, 0),
    'dead_time = "40 s"\nsampling = "5 min"\nfirst_report = "30 s"': (8, 60, 6),
}


@pytest.mark.parametrize("solver", ["kernel", "reference"])
@pytest.mark.parametrize("sensor", SENSORS)
def test_what_the_analyser_tells_is_what_was_in_the_tank(tmp_path, sensor, solver):
    plant = plant_of(tmp_path, TEXT, (LATE, sensor))
    pumps, rinse = moved(200)
    level, strength, _ = blender(pumps, rinse)
    run = cl.simulate(plant, None, steps_to(pumps[-1]), duration="995 s", solver=solver)
    expected = np.append(strength, STRENGTH)[held(*SENSORS[sensor])]
    assert np.ptp(expected) > 5.0
    assert np.abs(run.values["level"] - level).max() < NEAR
    assert np.abs(run.values["strength"] - expected).max() < 100 * NEAR


def test_a_lag_stands_before_the_dead_time(tmp_path):
    plant = plant_of(tmp_path, TEXT, (LATE, f'lag = "20 s"\n{LATE}'))
    pumps, rinse = moved(100)
    run = cl.simulate(plant, None, steps_to(pumps[-1]), duration="495 s")
    *_, lagged = blender(pumps, rinse, lag=20.0)
    told = np.append(lagged, STRENGTH)[held(8, 1, 0)[:100]]
    assert np.ptp(told) > 5.0
    assert np.abs(run.values["strength"] - told).max() < 100 * NEAR


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_controller_gets_what_the_analyser_tells(tmp_path, sensor):
    """Under its own inputs the tank is computed again, and of it what the analyser tells."""
    plant = plant_of(tmp_path, TEXT, (LATE, sensor))
    controller = cl.design.simc(plant)
    events = [cl.step("strength", to="34 g/l", at="50 s"), cl.step("rinse", to="0.15 l/s", at=500)]
    runs = [
        cl.simulate(plant, controller, events, duration="1000 s", solver=solver)
        for solver in ("kernel", "reference")
    ]
    for run in runs:
        pumps = np.column_stack([run.values[name] for name in ("brine", "water")])
        level, strength, _ = blender(pumps, run.values["rinse"])
        told = np.append(strength, STRENGTH)[held(*SENSORS[sensor])]
        assert np.abs(run.values["strength"] - told[: len(level)]).max() < 100 * NEAR
        assert np.abs(run.values["level"] - level).max() < NEAR
    # Rounding of what drives the loop is all that the two ways differ by.
    for name in ("level", "strength"):
        span = plant.process.signal(name).span
        assert np.abs(runs[0].values[name] - runs[1].values[name]).max() < NEAR * span


def test_the_strength_follows_after_the_dead_time_and_the_level_at_once(plant):
    """In the end c = 100 b/(b + w + r), and the lag of the tank is V/q."""
    out = HOLE * np.sqrt(2 * GRAVITY * LEVEL)
    found = cl.analyse(plant)
    assert found.dead_times.tolist() == [[0.0, 0.0], [40.0, 40.0]]
    slopes = np.array([STORE - STRENGTH, -STRENGTH]) * GAINS / out
    assert found.static_gain[1] == pytest.approx(slopes, rel=1e-9)
    assert min(found.time_constants) == pytest.approx(AREA * LEVEL / out, rel=1e-9)


#: Designs that take dead time; a polynomial one has a gain for each of its samples.
DESIGNS = (
    "simc", "lambda_", "amigo", "phase_margin", "smith_predictor", "lqi_kalman", "lqr",
    "glover_mcfarlane",
)  # fmt: skip
TIMES = (LATE, 'dead_time = "4 min"', 'dead_time = "40 s"\nsampling = "1 min"')
CASES = [
    *((design, sensor) for design in DESIGNS for sensor in TIMES),
    *(("polynomial", sensor) for sensor in (TIMES[0], TIMES[2])),
]


@pytest.mark.parametrize(("design", "sensor"), CASES)
def test_designs_that_take_dead_time_take_that_of_a_sensor(tmp_path, design, sensor):
    """Their loops are as robust as others, and the strength comes to its setpoint."""
    plant = plant_of(tmp_path, TEXT, (LATE, sensor))
    controller = getattr(cl.design, design)(plant)
    assert cl.margins(controller, plant)["max|S|"].max() < 2.01
    events = [cl.step("strength", to="33 g/l", at=0)]
    run = cl.simulate(plant, controller, events, duration="4 h")
    assert run.values["strength"][-1] == pytest.approx(33.0, abs=0.1)


@pytest.mark.parametrize(
    ("sensor", "key", "value"),
    [
        ('dead_time = "0 s"', "dead_time", "0 s"),
        ('dead_time = "6 d"', "dead_time", "6 d"),
        ('dead_time = "40 cm"', "dead_time", "40 cm"),
        ('sampling = "-1 s"', "sampling", "-1 s"),
        ('sampling = "1 min"\nfirst_report = "60 s"', "first_report", "60 s"),
        ('first_report = "60 s"', "first_report", "60 s"),
    ],
)
def test_a_wrong_time_is_refused_at_its_place(tmp_path, sensor, key, value):
    with refused(place=f"sensors.strength.{key}", value=value):
        plant_of(tmp_path, TEXT, (LATE, sensor))


def test_a_flatline_alarm_waits_for_a_report(tmp_path):
    sensor = f'{LATE}\nsampling = "5 min"'
    alarms = "\n[alarms.strength]\nflatline = {}\n"
    assert plant_of(tmp_path, TEXT + alarms.format('"6 min"'), (LATE, sensor)).process.alarms
    with refused(place="alarms.strength.flatline", value="5 min", expected="5.67 min"):
        plant_of(tmp_path, TEXT + alarms.format('"5 min"'), (LATE, sensor))


def test_a_time_that_is_no_whole_number_of_samples_is_rounded_and_told(tmp_path):
    plant = plant_of(tmp_path, TEXT, (LATE, 'dead_time = "42 s"\nsampling = "61 s"'))
    said = " ".join(str(cl.analyse(plant)).split())
    assert "42 s is not a whole number of sampling periods of 5 s" in said
    same = plant_of(tmp_path, TEXT, (LATE, 'dead_time = "40 s"\nsampling = "60 s"'))
    assert plant.process.reporting == same.process.reporting
