"""The silence of a controller: when it counts, and what a plant that goes on makes of it."""

from multiprocessing import Pipe

import pytest
from rig_bench import bench

from clepsydra.rig.child import never_wait
from clepsydra.rig.plant_process import Silence
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag import HEARTBEAT


class Watched:
    """A controller of a rig, and who listens to it, on a clock that a test sets."""

    def __init__(self, rig):
        self.rig, self.now, self.told = rig, 0.0, []
        self.listen()

    def listen(self):
        reporter = Reporter("plant", lambda report: self.told.append(report.words))
        self.silence = Silence(self.rig.image, 3.0, reporter, steady=lambda: self.now)

    def heard_at(self, now):
        self.now = now
        return self.silence.heard()


@pytest.fixture
def watched():
    with bench() as rig:
        yield Watched(rig)


def test_nobody_is_missed_before_the_first_sign(watched):
    assert watched.heard_at(1000.0) and not watched.told


def test_any_value_is_a_sign_until_the_heartbeat_is_counted(watched):
    watched.rig.write("pump_1.out", 3.0)
    assert watched.heard_at(1.0) and watched.heard_at(3.9) and not watched.heard_at(4.1)
    watched.rig.write("pump_1.out", 3.0)
    assert watched.heard_at(5.0)
    watched.rig.write(HEARTBEAT, 1.0)
    assert watched.heard_at(6.0)
    watched.rig.write("pump_1.out", 3.5)
    assert watched.heard_at(8.9) and not watched.heard_at(9.1)
    watched.rig.write(HEARTBEAT, 2.0)
    assert watched.heard_at(10.0)
    assert ["fail-safe" in words for words in watched.told] == [True, False, True, False]


def test_a_plant_that_goes_on_misses_a_controller_that_went_meanwhile(watched):
    watched.rig.write("pump_1.out", 4.0)
    assert watched.heard_at(1.0)
    watched.now = 2.0
    watched.listen()
    assert watched.heard_at(4.9) and not watched.heard_at(5.1)


def test_a_plant_that_goes_on_still_wants_the_heartbeat(watched):
    watched.rig.write(HEARTBEAT, 7.0)
    watched.listen()
    watched.rig.write("pump_1.out", 4.0)
    assert watched.heard_at(2.9) and not watched.heard_at(3.1)


def test_reports_that_nobody_takes_hold_nobody_up():
    here, there = Pipe(duplex=False)
    never_wait(there)
    reporter = Reporter("plant", there.send)
    for number in range(10_000):
        reporter.event(f"report {number}")
    taken = []
    while here.poll():
        taken.append(here.recv().words)
    # What was there in time is whole, in order, and not all.
    assert taken == [f"report {number}" for number in range(len(taken))]
    assert 10 < len(taken) < 10_000
