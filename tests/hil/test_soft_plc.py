"""A soft PLC and its plant in processes of their own, in real time, with all that befalls a PLC."""

from collections.abc import Iterator

import pytest
from plc_bench import READY
from running_rig import RunningRig
from table_bus import TableBus
from waiting import wait_until

from clepsydra.hil.commands import Delay, PowerCycle, Skip, Stop
from clepsydra.hil.ideal import as_operated, deviations, ideal_run
from clepsydra.hil.replay import replay_law, replay_plant
from clepsydra.hil.wire_check import check_wires

pytestmark = pytest.mark.thorough
#: Bits of the status word.
SCAN_TIME_OFF, SCAN_LOST, NOTHING_KEPT = 2048, 32768, 131072


@pytest.fixture
def rig(tmp_path) -> Iterator[RunningRig]:
    running = RunningRig(tmp_path)
    running.process.start()
    yield running
    running.process.end()


def table_bus(rig: RunningRig) -> TableBus:
    return TableBus(rig.path, rig.settings.layout, rig.tags)


def test_it_is_the_simulation_whatever_befalls_it(rig, compiled_c):
    """Every bit of law and process, and each status word as docs/plc.md tells it."""
    plc = rig.plc(compiled_c, table_bus(rig))
    plc.start()
    wait_until(lambda: rig.heartbeat > 3.0)
    rig.operate("level_1.sp", 7.0)
    first = rig.sample + 30
    plc.send(Delay(first, 0.5, 2))
    plc.send(Skip(first + 10, 3))
    plc.send(Stop(first + 20, 10.0))
    plc.send(PowerCycle(first + 40, 2.0, retained=True))
    plc.send(PowerCycle(first + 60, 3.0, retained=False))
    log = plc.finish(first + 80)
    rows = rig.rows()
    assert log is not None and log.lost == (0, 0)
    words = [words for _, words in log.events]
    assert words == [
        "2 scans begin 0.5 s late", "3 scans are left out", "STOP for 10 s",
        "no power for 2 s; it comes back with kept state",
        "no power for 3 s; it comes back without kept state",
    ]  # fmt: skip
    late, skipped, stopped, kept, lost = (scan for scan, _ in log.events)
    status = log.found()["pump_1.status"].astype(int)
    steps = log.given()["time_step"]
    assert steps[late] > 1.3 and status[late] & SCAN_TIME_OFF
    assert steps[skipped] > 3.5 and status[skipped] & SCAN_TIME_OFF
    assert steps[stopped] > 10.0 and status[stopped] & SCAN_LOST
    assert log.given()["start"].nonzero()[0].tolist() == [0, kept, lost]
    assert steps[kept] == steps[lost] == 1.0
    assert not status[kept] & NOTHING_KEPT and status[lost] & NOTHING_KEPT
    assert log.unseen >= 3 + 10 + 2 + 3
    assert replay_law(READY.program, log).differing == 0
    assert replay_plant(rig.settings, rows).differing == 0
    checked = rig.settings, log, rig.wiring, rows, rig.tags
    assert check_wires(*checked).foreign == 0
    given = as_operated(rig.settings, READY, log, rig.wiring, rows, rig.tags)
    ideal = ideal_run(rig.settings, READY, rows.last + 1, given)
    away = {each.tag.name: each.largest for each in deviations(ideal, rows, rig.tags, first)}
    # A pump of 10 V, in a step of 1 V: even a scan or two that came late move it by less.
    assert away["pump_1.position"] < 1.0


def test_it_waits_for_a_bus_and_rides_through_without_a_plant(rig, compiled_c):
    """Killed, the plant shows nothing new; the PLC scans on, and is there when it comes back."""
    plc = rig.plc(compiled_c, table_bus(rig))
    plc.start()
    wait_until(lambda: rig.heartbeat > 3.0)
    rig.process.end()
    beats = rig.heartbeat
    wait_until(lambda: rig.heartbeat > beats + 3.0)
    rig.process.start()
    told = rig.sample
    wait_until(lambda: rig.sample > told + 5)
    log = plc.finish()
    assert log is not None and log.lost == (0, 0)
    assert replay_law(READY.program, log).differing == 0


def test_it_ends_where_it_is_when_the_plant_stands_still(rig, compiled_c):
    plc = rig.plc(compiled_c, table_bus(rig))
    plc.start()
    wait_until(lambda: rig.heartbeat > 3.0)
    rig.process.end()
    log = plc.finish(at=1_000_000, patience=0.2)
    assert log is not None and len(log) > 3


def test_its_end_is_seen(rig, compiled_c):
    plc = rig.plc(compiled_c, table_bus(rig))
    plc.start()
    wait_until(lambda: rig.heartbeat > 3.0)
    assert plc.child.process is not None
    plc.child.process.kill()
    assert plc.finish() is None
