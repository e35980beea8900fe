"""The clock of a plant: nobody sets it."""

import pytest

from clepsydra.rig.plant_process import PlantClock
from clepsydra.rig.report import Reporter


@pytest.fixture
def machine():
    """The clocks of a machine: that of the day can be set, the other one goes on."""
    return {"of_day": 1.8e9, "steady": 50.0}


@pytest.fixture
def said():
    return []


@pytest.fixture
def clock(machine, said):
    reporter = Reporter("plant", lambda report: said.append(report.words))
    return PlantClock(reporter, lambda: machine["of_day"], lambda: machine["steady"])


def go_on(machine, seconds):
    for name in machine:
        machine[name] += seconds


@pytest.mark.parametrize("set_by", [-3600.0, 7200.0])
def test_it_goes_on_whatever_the_machine_is_set_to_and_that_is_told_once(
    clock, machine, said, set_by
):
    go_on(machine, 10.0)
    clock.look()
    assert clock.time() == 1.8e9 + 10.0 and said == []
    machine["of_day"] += set_by
    for _ in range(3):
        go_on(machine, 1.0)
        clock.look()
    assert clock.time() == 1.8e9 + 13.0
    assert len(said) == 1 and f"set by {set_by:+.0f} s" in said[0]


def test_a_clock_that_is_set_again_is_told_again(clock, machine, said):
    for set_by in (-100.0, 100.0):
        machine["of_day"] += set_by
        clock.look()
    assert ["-100 s" in said[0], "+100 s" in said[1]] == [True, True]


def test_what_is_slewed_a_little_is_not_told(clock, machine, said):
    machine["of_day"] += 0.9
    clock.look()
    assert said == []
