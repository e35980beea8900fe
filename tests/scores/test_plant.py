"""Flows, heads and filling read from runs, against the balances that the runs close themselves."""

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.scores.plant import plant_trajectories


def test_a_buffer_fills_by_what_arrives_less_what_leaves() -> None:
    events = [
        cl.step("inflow", to="0.4 m^3/s", at="10 min"),
        cl.step("outflow", to="50 %", at="60 min"),
    ]
    run = cl.simulate(cl.load("equalisation-tank"), None, events, duration="3 h")
    plant = plant_trajectories(run.process, run.time, run.values)
    buffer = plant.buffers["level"]
    held = np.diff(run.time)
    gained = float(np.sum(held * (buffer.inflow - buffer.outflow)[:-1]))
    assert (buffer.filling[-1] - buffer.filling[0]) * 5000.0 == pytest.approx(gained, rel=1e-9)
    assert np.all(buffer.inflow[run.time > 600] == 0.4)
    assert np.allclose(plant.pumped["outflow"], 0.005 * 100 * run.values["outflow"], rtol=1e-12)
    left = next(b for b in run.balances if b.name == "liquid").left
    pumped = float(np.sum(held * plant.pumped["outflow"][:-1]))
    assert pumped == pytest.approx(left, rel=1e-9)
    assert not plant.heads


def test_what_spills_is_no_outflow_of_a_buffer() -> None:
    closed = [cl.step("outflow", to="0 %", at="10 min")]
    run = cl.simulate(cl.load("equalisation-tank"), None, closed, duration="4 h")
    plant = plant_trajectories(run.process, run.time, run.values)
    assert plant.spilt["basin"][-1] > 100.0
    assert np.all(plant.buffers["level"].outflow[run.time > 600] == 0.0)
    assert plant.running["outflow"][0] == 1.0 and plant.running["outflow"][-1] == 0.0


def test_a_pump_with_a_curve_lifts_what_its_curve_gives() -> None:
    """The head from the pipe is the head of the curve, 22 - k q² between its first points."""
    well = cl.load("wet-well")
    at = well.point.as_dict()
    values = {name: np.full(3, value) for name, value in at.items()}
    plant = plant_trajectories(well.process, np.arange(3.0), values)
    flow, speed = plant.pumped["duty"][0], at["duty"]
    assert flow == pytest.approx(0.02, rel=1e-6)
    curve = speed**2 * (22.0 - (22.0 - 17.0) / 0.03**2 * (flow / speed) ** 2)
    assert plant.heads["duty"][0] == pytest.approx(curve, rel=1e-9)
    assert plant.pumped["standby"][0] == 0.0
    assert (plant.running["duty"][0], plant.running["standby"][0]) == (1.0, 0.0)


@pytest.mark.thorough
def test_a_standby_pump_runs_when_its_switch_has_started_it() -> None:
    rain = [cl.step("inflow", to="60 l/s", at="1 min")]
    run = cl.simulate(cl.load("wet-well"), None, rain, duration="15 min")
    plant = plant_trajectories(run.process, run.time, run.values)
    runs = run.values["standby.runs"] > 0.5
    assert 0 < np.count_nonzero(runs) < runs.size
    assert np.array_equal(plant.running["standby"] > 0.5, runs)
    assert np.all(plant.pumped["standby"][np.flatnonzero(runs)[10:]] > 0.02)


CHANNEL = """
name = "channel"
sampling_period = "1 s"
controlled = ["level"]
averaging = ["level"]

[reservoirs.river]

[tanks.tank]
area = "1 m^2"
height = "2 m"

[delays.channel]
destination = "tank"
time = "40 s"

[flows.inflow]
destination = "channel"
range = ["0 l/s", "10 l/s"]
nominal = "3 l/s"

[pumps.outflow]
source = "tank"
destination = "river"
gain = "1 l/(s V)"
range = ["0 V", "10 V"]

[sensors.level]
tank = "tank"
range = ["0 m", "2 m"]

[operating_point]
level = "1 m"
"""


def test_what_comes_out_of_a_channel_entered_it_earlier(tmp_path) -> None:
    more = [cl.step("inflow", to="5 l/s", at="20 s")]
    run = cl.simulate(plant_of(tmp_path, CHANNEL), None, more, duration="3 min")
    buffer = plant_trajectories(run.process, run.time, run.values).buffers["level"]
    # The step enters at 20 s and arrives at 60 s; the sample at its front may show either.
    assert np.allclose(buffer.inflow[run.time < 60], 3e-3, rtol=1e-9)
    assert np.allclose(buffer.inflow[run.time > 60], 5e-3, rtol=1e-9)
    assert np.allclose(buffer.outflow, 3e-3, rtol=1e-9)
    gained = (buffer.filling[-1] - buffer.filling[0]) * 2.0
    assert gained == pytest.approx(120 * 2e-3, rel=1e-6)
