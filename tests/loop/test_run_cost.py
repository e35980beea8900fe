"""What a run costs is weighed before it begins, in time and in memory."""

from pathlib import Path

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.loop.run_cost import run_cost, weigh_run
from clepsydra.loop.step_size import delay_substeps, refined, substeps_for
from clepsydra.process.reader import load_process

HEAD = """
name = "quick"
sampling_period = "1 s"
controlled = ["level"]
[reservoirs.main]
[reservoirs.river]
[pumps.feed]
source = "main"
destination = "{first}"
gain = "2e-4 m^3/(s V)"
range = ["0 V", "10 V"]
nominal = "5 V"
[sensors.level]
tank = "tank_1"
range = ["0 m", "1 m"]
"""
#: k/A = 0.002 m²/s / 2.5e-6 m² = 800 1/s: a tenth of its inverse goes 8000 times into a second.
TANK = """
[tanks.tank_{n}]
area = "0.025 cm^2"
height = "1 m"
[linear_outlets.outlet_{n}]
source = "tank_{n}"
destination = "{to}"
coefficient = "0.002 m^2/s"
"""
DELAY = """
[delays.pipe]
destination = "tank_1"
time = "{time}"
"""


def written(folder: Path, first: str, *parts: str) -> Path:
    path = folder / "quick.toml"
    path.write_text(HEAD.format(first=first) + "".join(parts))
    return path


@pytest.fixture
def four_quick_tanks(tmp_path):
    """One after the other, each with a time constant of 1.25 ms."""
    tanks = [TANK.format(n=n, to=f"tank_{n + 1}" if n < 4 else "river") for n in (1, 2, 3, 4)]
    return cl.load(written(tmp_path, "tank_1", *tanks))


def test_a_run_of_more_than_an_hour_is_refused_before_it_begins(four_quick_tanks):
    """540,000 samples, 2500 · (1 + 2 + 4) steps, 4 states, 100 ns: 3780 s."""
    assert substeps_for(four_quick_tanks.linear) == 8000
    said = "540,000 samples of 8,000 integration steps, about 63 min"
    with refused(place="quick, run", value=said, expected="0.000125 s", remedy="nearly empty"):
        cl.simulate(four_quick_tanks, None, [cl.step("feed", "0.1 V")], duration="150 h")


def test_the_analysis_names_the_vessel_that_makes_runs_long(tmp_path):
    """The second of two tanks is a thousand times slower: k/A = 0.8 1/s."""
    slow = TANK.format(n=2, to="river").replace("0.025 cm^2", "25 cm^2")
    path = written(tmp_path, "tank_1", TANK.format(n=1, to="tank_2"), slow)
    (said,) = [each for each in cl.analyse(path).words if "steps" in each]
    assert "0.00125 s of tank_1.level, goes 800 times into the sampling period of 1 s" in said
    assert "8,000 steps a sample" in said
    calm = path.read_text().replace("0.025 cm^2", "25 cm^2")
    path.write_text(calm)
    assert not any("steps" in each for each in cl.analyse(path).words)


def test_the_lag_of_a_sensor_makes_no_run_long(tmp_path):
    """20 ms go 50 times into a second; it has settled by the next sample and gets 50 steps."""
    tank = TANK.format(n=1, to="river").replace("0.025 cm^2", "0.25 m^2")
    path = written(tmp_path, "tank_1", tank)
    path.write_text(path.read_text().replace("[sensors.level]", '[sensors.level]\nlag = "20 ms"'))
    plant = cl.load(path)
    assert substeps_for(plant.linear) == 50
    assert not any("steps" in each for each in plant.analysis.words)


def test_a_study_of_such_runs_is_refused_before_any_design(four_quick_tanks):
    scenario = [cl.step("level", "1 cm", at="10 h")]
    begun = []
    with refused(place="quick, run"):
        cl.study(four_quick_tanks, events=scenario, duration="150 h", progress=begun.append)
    assert begun == []


def test_the_reference_solver_is_weighed_by_its_own_steps(four_quick_tanks, tmp_path):
    """It goes from sample to sample, and in the steps of the kernel only where there are delays."""
    parts = TANK.format(n=1, to="river"), DELAY.format(time="2 s")
    late = load_process(written(tmp_path, "pipe", *parts))
    for process, steps in ((four_quick_tanks.process, 1), (late, 8000)):
        few, many = (
            run_cost(process, 10, substeps, checked=False, solver="reference")
            for substeps in (1, 8000)
        )
        assert many == pytest.approx(steps * few)


def test_a_long_run_is_told_of_once_and_a_short_one_is_not(four_quick_tanks, caplog):
    process = four_quick_tanks.process
    weigh_run(process, 1000, 8000)  # 7 s
    assert caplog.messages == []
    for _ in range(2):
        weigh_run(process, 10_000, 8000)
    (said,) = caplog.messages
    assert "10,000 samples of 8,000 integration steps, about 70 s" in said
    assert "steps of 0.000125 s" in said


@pytest.mark.parametrize(("time", "needed"), [("1e9 s", "160,000"), ("1600001 s", "256")])
def test_a_delay_that_memory_cannot_hold_is_refused(tmp_path, time, needed):
    """5 numbers of 8 bytes each of 4 steps a second: 160 bytes a second."""
    path = written(tmp_path, "pipe", TANK.format(n=1, to="river"), DELAY.format(time=time))
    words = f"at most 256 MB; this takes {needed} MB, with 4 steps"
    with refused(place="quick, pipe", expected=words, remedy="shorten the delay"):
        cl.simulate(path, None, [cl.step("feed", "0.1 V")], duration="1 min")


def test_steps_are_not_halved_beyond_what_memory_holds(tmp_path):
    """1e6 periods on their way: 40 MB with one step in each, so 4 steps by halves, and not 8."""
    path = written(tmp_path, "pipe", TANK.format(n=1, to="river"), DELAY.format(time="1e6 s"))
    process, counts = load_process(path), []

    class Never:
        """A run that is another one with every step."""

        def __init__(self, count):
            counts.append(count)
            self.values = {s.name: np.array([float(count)]) for s in process.state}

    assert delay_substeps(process) == 1
    refined(process, Never, 1, 1e-6)
    assert counts == [1, 2, 4]
