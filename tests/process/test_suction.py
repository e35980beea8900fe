"""Where suction ends: one key for all that draws by force, and one flow, shown as it runs."""

from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError, NoEquilibrium
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.reader import load_process

PLANT = """
name = "plant"
sampling_period = "2 s"
controlled = ["level"]
manipulated = ["feed"]
[reservoirs.basin]
[tanks.tank]
area = "0.5 m^2"
height = "1 m"
[flows.feed]
destination = "tank"
range = ["0 l/min", "300 l/min"]
nominal = "{feed} l/min"
[orifices.hole]
source = "tank"
destination = "basin"
area = "10 cm^2"
[sensors.level]
tank = "tank"
range = ["0 m", "1 m"]
{draws}
"""
#: What draws 100 l/min by force.
FLOW = """
[flows.outflow]
source = "tank"
range = ["0 l/min", "200 l/min"]
nominal = "100 l/min"
"""
PUMP = """
[pumps.outflow]
source = "tank"
destination = "basin"
gain = "10 l/(min V)"
range = ["0 V", "20 V"]
nominal = "10 V"
"""
VALVE = """
[valves.outflow]
source = "tank"
destination = "basin"
kv = "6 m^3/h"
pressure = "1 bar"
range = ["0 %", "100 %"]
nominal = "100 %"
"""


@pytest.fixture
def plant(tmp_path):
    """Return a function that writes the plant with what draws and its keys; return the path."""

    def make(draws: str, keys: str = "", feed: float = 200.0) -> Path:
        path = tmp_path / "plant.toml"
        path.write_text(PLANT.format(draws=f"{draws}{keys}\n", feed=feed), encoding="utf-8")
        return path

    return make


@pytest.mark.sampled
@pytest.mark.parametrize("draws", [FLOW, PUMP, VALVE], ids=["flow", "pump", "valve"])
@pytest.mark.parametrize(
    ("keys", "ends"), [("", 0.01), ('suction_level = "7 cm"', 0.07)], ids=["default", "key"]
)
@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_whatever_draws_by_force_ends_at_the_level_of_the_file(plant, draws, keys, ends, solver):
    cut = [cl.step("feed", to=0.0, at="10 s")]
    run = cl.simulate(cl.load(plant(draws, keys)), None, cut, duration="6 min", solver=solver)
    (event,) = [each for each in run.events if each.event == "outflow.runs_dry"]
    level = run.values["tank.level"]
    before = int(np.searchsorted(run.time, event.time)) - 1
    assert level[before] > ends > level[before + 1]
    # After that only the hole drains: Torricelli's √h falls in a straight line.
    later = np.sqrt(level[before + 1 : before + 6])
    slope = 1e-3 / (2 * 0.5) * np.sqrt(2 * 9.81)
    assert np.diff(later) == pytest.approx(-slope * 2.0, rel=1e-6)


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_a_forced_flow_reads_what_flows(plant, solver):
    """What the signal says to have left closes the balance to within the sample that breaks off."""
    less = [cl.step("feed", to="20 l/min", at="10 s")]
    tank = cl.load(plant(FLOW, feed=240.0))
    run = cl.simulate(tank, None, less, duration="6 min", solver=solver)
    draws, outflow = run.values["outflow.draws"], run.values["outflow"]
    assert 0.0 < np.mean(draws) < 1.0
    assert np.array_equal(outflow, np.where(draws > 0.5, 100.0 / 60e3, 0.0))
    level = run.values["tank.level"]
    hole = 1e-3 * np.sqrt(2 * 9.81 * level)
    left = 2.0 * float(np.sum(outflow[:-1] + (hole[1:] + hole[:-1]) / 2))
    (balance,) = run.balances
    assert balance.error < 1e-12
    breaks = float(run.values["outflow.runs_dry.count"][-1])
    assert abs(left - balance.left) < (breaks + 0.1) * 2.0 * 100.0 / 60e3


@pytest.mark.parametrize("draws", [FLOW, PUMP], ids=["flow", "pump"])
def test_nothing_rests_where_suction_has_ended(plant, draws):
    """At 105 l/min of feed the hole is left 5 l/min, for which half a millimetre is enough."""
    with pytest.raises(NoEquilibrium, match="outflow runs dry: tank holds 1 % of its capacity"):
        find_equilibrium(load_process(plant(draws, feed=105.0)))
    with pytest.raises(NoEquilibrium, match="outflow runs dry: tank below 12 cm"):
        find_equilibrium(load_process(plant(draws, 'suction_level = "12 cm"', feed=190.0)))
    assert find_equilibrium(load_process(plant(draws, feed=190.0))).state[0] > 0.1


def test_a_rest_beyond_a_trip_is_none(plant):
    trip = 'trip_above = { tank = "5 cm" }\nhysteresis = "1 cm"'
    with pytest.raises(NoEquilibrium, match="outflow trips: tank above 5 cm"):
        find_equilibrium(load_process(plant(PUMP, trip)))


@pytest.mark.parametrize(
    ("draws", "keys", "expected"),
    [
        (FLOW, 'suction_level = "0 cm"', "a level above 0 cm"),
        (PUMP, 'suction_level = "99 cm"', "a level of at most 98 cm"),
        (VALVE, 'suction_level = "-1 cm"', "a level above 0 cm"),
        (FLOW.replace("source", "destination"), 'suction_level = "1 cm"', "no such key"),
        (PUMP.replace('source = "tank"', 'source = "basin"').replace(
            'destination = "basin"', 'destination = "tank"'
        ), 'suction_level = "1 cm"', "no such key"),
        (VALVE.replace('pressure = "1 bar"\n', ""), 'suction_level = "1 cm"', "no such key"),
    ],
)  # fmt: skip
def test_a_level_of_suction_that_means_nothing_is_refused(plant, draws, keys, expected):
    path = plant(draws, keys)
    with pytest.raises(InputError) as caught:
        load_process(path)
    assert caught.value.expected.startswith(expected)
    assert caught.value.place.endswith("outflow.suction_level")
