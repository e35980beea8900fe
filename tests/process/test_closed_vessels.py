"""A closed vessel is never above full: its inflow stops, or the run ends, as its file says."""

import json
import math
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import clepsydra as cl
from clepsydra import InputError, NoEquilibrium
from clepsydra.cli.application import application
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.reader import load_process

PLANT = """
name = "closed"
sampling_period = "2 s"
controlled = ["level"]
manipulated = ["transfer"]
[components.salt]
range = ["0 g/l", "50 g/l"]
[reservoirs.basin]
concentration = {{ salt = "1 g/l" }}
[tanks.drum]
{shape}
{lid}
[pumps.transfer]
source = "drum"
destination = "basin"
gain = "100 l/(min V)"
range = ["0 V", "10 V"]
{feeds}
[sensors.level]
tank = "drum"
span = ["0 m", "2.4 m"]
range = ["4 mA", "20 mA"]
noise = "0 %"
[operating_point]
level = "12 mA"
"""
FEED = """
[flows.feed]
destination = "{}"
range = ["0 l/min", "3000 l/min"]
nominal = "500 l/min"
concentration = {{ salt = "10 g/l" }}
"""
DIRECT = FEED.format("drum")
#: Half of what another pump sends through a splitter goes elsewhere.
SPLIT = """
[pumps.feed]
source = "basin"
destination = "split"
gain = "1 l/(min mA)"
range = ["0 mA", "6000 mA"]
nominal = "1000 mA"
[splitters.split]
fractions = { drum = 0.5, basin = 0.5 }
"""
SHAPES = {
    "cylinder": 'shape = "horizontal cylinder"\ndiameter = "2.4 m"\nlength = "1.6 m"',
    "sphere": 'shape = "sphere"\ndiameter = "2.4 m"',
    "cone": 'shape = "cone"\nfloor_diameter = "2.4 m"\nrim_diameter = "0 m"\nheight = "2.4 m"',
    "lid": 'area = "2 m^2"\nheight = "2.4 m"\nwhen_full = "inflow stops"',
}
CAPACITY = {
    "cylinder": math.pi * 1.2**2 * 1.6,
    "sphere": math.pi / 6 * 2.4**3,
    "cone": math.pi / 3 * 1.2**2 * 2.4,
    "lid": 4.8,
}
ENDS = 'when_full = "run ends"'
MUCH = [cl.step("feed", to="3000 l/min", at="60 s")]


def written(folder: Path, shape: str = "sphere", lid: str = "", feeds: str = DIRECT) -> Path:
    """Write the plant; return its path."""
    path = folder / "closed.toml"
    text = PLANT.format(shape=SHAPES[shape], lid=lid, feeds=feeds)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def plant(tmp_path):
    """Return a function that writes the plant; return its path."""
    return partial(written, tmp_path)


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """Return a function: shape → its run, fed from 60 s on with more than it can give."""

    @cache
    def run(shape: str) -> cl.OpenLoopRun:
        path = written(tmp_path_factory.mktemp(shape), shape)
        return cl.simulate(cl.load(path), None, MUCH, duration="5 min")

    return run


@pytest.mark.parametrize(
    "shape",
    ["sphere", *(pytest.param(s, marks=pytest.mark.thorough) for s in SHAPES if s != "sphere")],
)
def test_inflow_stops_when_a_closed_vessel_is_full(filled, shape):
    run = filled(shape)
    level, reading = run.values["drum.level"], run.values["level"]
    assert level.max() <= 2.4
    assert reading.max() <= 0.02
    times = [each.time for each in run.events if each.event == "drum.fills"]
    assert len(times) > 2
    # From half full, 3000 l/min in and 500 l/min out; then 1 % goes out, and comes in again.
    capacity = CAPACITY[shape]
    assert level[0] == pytest.approx(1.2, abs=1e-12)
    half = capacity / 2 if shape != "cone" else capacity / 8
    assert times[0] == pytest.approx(60.0 + half / (2500 / 60e3), rel=1e-9)
    cycle = 0.01 * capacity * (60e3 / 500 + 60e3 / 2500)
    assert np.diff(times) == pytest.approx(cycle, rel=1e-6)
    assert all(balance.error < 1e-12 for balance in run.balances)
    assert len(run.balances) == 2


def test_the_inflow_reads_what_flows(filled):
    run = filled("sphere")
    full = run.values["drum.full"] > 0.5
    assert 0.0 < np.mean(full) < 1.0
    assert np.all(run.values["feed"][full] == 0.0)
    assert np.all(run.values["feed"][~full & (run.time > 60.0)] == 3000 / 60e3)


@pytest.mark.thorough
def test_the_kernel_agrees_with_the_reference_solver(filled, plant):
    kernel = filled("sphere")
    reference = cl.simulate(cl.load(plant()), None, MUCH, duration="5 min", solver="reference")
    assert [e.event for e in kernel.events] == [e.event for e in reference.events]
    assert len(kernel.events) > 2
    for one, other in zip(kernel.events, reference.events, strict=True):
        assert one.time == pytest.approx(other.time, abs=1e-5)
    assert kernel.values["feed"] == pytest.approx(reference.values["feed"])
    assert kernel.values["drum.level"] == pytest.approx(reference.values["drum.level"], abs=1e-4)


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_the_run_ends_where_the_file_says_so(plant, solver):
    run = cl.simulate(cl.load(plant(lid=ENDS)), None, MUCH, duration="5 min", solver=solver)
    moment = 60.0 + CAPACITY["sphere"] / 2 / (2500 / 60e3)
    assert run.end is not None
    assert run.end.time == pytest.approx(moment, rel=1e-9)
    assert run.time[-2] < moment <= run.time[-1]
    assert all(len(values) == len(run.time) for values in run.values.values())
    assert run.values["drum.level"][-1] == pytest.approx(2.4, abs=1e-12)
    assert run.values["drum.level"].max() <= 2.4
    assert all(balance.error < 1e-12 for balance in run.balances)


@pytest.mark.thorough
def test_the_command_line_says_that_the_run_ended(plant, tmp_path):
    given = ["--input", "feed=3000 l/min@60s", "--duration", "5 min", "-o", str(tmp_path)]
    arguments = ["simulate", str(plant(lid=ENDS)), *given, "--json"]
    said = json.loads(CliRunner().invoke(application(), arguments).output)
    assert said["ended"]["event"] == "drum.fills"
    assert said["signals"]["level"]["largest"]["value"] <= 0.02
    page = Path(said["report"]).read_text(encoding="utf-8")
    assert "it ended at 146.9 s: drum is full" in page


@pytest.mark.thorough
def test_what_a_splitter_leads_to_a_full_vessel_stops_as_a_whole(plant):
    much = [cl.step("feed", to="6000 mA", at="60 s")]
    run = cl.simulate(cl.load(plant(feeds=SPLIT)), None, much, duration="10 min")
    assert run.values["drum.level"].max() <= 2.4
    assert run.events
    assert all(balance.error < 1e-12 for balance in run.balances)


def test_nothing_rests_in_a_full_vessel(plant):
    path = plant()
    path.write_text(path.read_text().replace('level = "12 mA"', 'level = "20 mA"'))
    with pytest.raises(NoEquilibrium, match="drum is full"):
        find_equilibrium(load_process(path))


DELAYED = FEED.format("channel") + '[delays.channel]\ndestination = "drum"\ntime = "10 s"\n'


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"lid": 'when_full = "level rises"'}, "one of inflow stops, run ends"),
        ({"lid": f'{ENDS}\nweir = "1 m"'}, "no such key beside a weir"),
        ({"feeds": DELAYED}, "a vessel that always takes in, since channel feeds it"),
    ],
)
def test_what_a_closed_vessel_cannot_do_is_refused(plant, given, expected):
    with pytest.raises(InputError) as caught:
        load_process(plant(**given))
    assert caught.value.expected.startswith(expected)


@pytest.mark.parametrize("given", [{"lid": 'weir = "1 m"'}, {"feeds": DELAYED, "lid": ENDS}])
def test_what_a_closed_vessel_can_do_is_not_refused(plant, given):
    assert find_equilibrium(load_process(plant(**given))).residual < 1e-9
