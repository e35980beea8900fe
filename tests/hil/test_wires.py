"""A soft PLC and its plant with wires between them: every value as the wires make it."""

import pytest
from plc_bench import READY
from running_door import by_modbus, by_opc_ua
from running_rig import RunningRig
from tools import need
from waiting import wait_until

from clepsydra.hil.commands import PowerCycle
from clepsydra.hil.evidence import Evidence, evidence_of
from clepsydra.hil.wires import Wires, modbus_wires, opc_ua_wires

pytestmark = pytest.mark.thorough


def on_wires(rig: RunningRig, image, wires: Wires) -> Evidence:
    """Step the setpoint, fail a sensor, take the power away; returns what that shows."""
    plc = rig.plc(image, wires.bus)
    plc.start()
    wait_until(lambda: rig.heartbeat > 3.0)
    rig.operate("level_1.sp", 7.0)
    first = rig.sample
    wait_until(lambda: rig.sample > first + 30)
    rig.image.write("level_1.sensor", 0.0)
    wait_until(lambda: rig.sample > first + 40)
    rig.image.write("level_1.sensor", 1.0)
    plc.send(PowerCycle(first + 50, 2.0, retained=False))
    log = plc.finish(first + 70)
    rows = rig.rows()
    assert log is not None and log.lost == (0, 0), log and log.events
    status = log.found()["pump_1.status"].astype(int)
    # Failed safe, and later without kept state.
    assert (status & 1024).any() and status[-1] & 131072
    assert rig.table.read(rig.table.tags["pump_1.status"]).value == status[-1]
    found = evidence_of(
        READY, "double", rig.settings, log, rig.wiring, rows, rig.tags, wires, first + 30
    )
    assert found.holds, found
    assert found.law.differing == 0 and found.scans == len(log)
    assert found.wires.read > 80 and found.wires.in_time > 80
    # No scan while there is no power, and a sample or two until they are in step again.
    assert found.unseen >= 2 and found.lost == (0, 0)
    return found


@pytest.fixture
def rig(tmp_path):
    running = RunningRig(tmp_path)
    running.process.start()
    yield running
    running.process.end()


@pytest.mark.parametrize(
    ("encoding", "step"),
    [("float32", 2.0**-20), ("counts-27648", 10.0 / 27648), ("microamperes", 10.0 / 16000)],
)
def test_by_modbus(encoding, step, rig, compiled_c):
    need("pymodbus")
    with by_modbus(rig, encoding) as place:
        wires = modbus_wires(*place)
        assert encoding in wires.title
        # Next to 10 V a number of single precision has 20 binary digits behind the point.
        assert wires.step(rig.table.tags["level_1.pv"]) == step
        found = on_wires(rig, compiled_c, wires)
    assert [each.tag.name for each in found.deviations][::5] == ["level_1.pv", "pump_2.position"]
    assert found.steps == pytest.approx([step] * 6)


def test_by_opc_ua(rig, by_matiec):
    need("asyncua", "cryptography")
    with by_opc_ua(rig) as access:
        found = on_wires(rig, by_matiec, opc_ua_wires(access, rig.tags))
    assert set(found.steps) == {0.0}
