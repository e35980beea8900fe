"""A block to which nothing is wired does not look healthy, and neither does a forgotten wire."""

import pytest
from scan_rig import ScannedLaw
from shell_rig import one_loop, read_status, shelled_loop

from clepsydra import Signal
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell


def unwired(**wired):
    """The scans of a block with its own defaults but for what is wired."""
    shelled = with_plant_shell(one_loop(), 1.0, PlantShell(fail_safe={"pump_1": 1.5}))
    defaults = {signal.name: signal.initial for signal in shelled.law.inputs}
    return ScannedLaw(shelled, defaults["time_step"], **defaults | wired)


def told(outputs) -> set[str]:
    return set(read_status(int(outputs["pump_1.status"])))


def test_nothing_wired_is_a_fault_and_the_fail_safe_value():
    block = unwired()
    for _ in range(8):
        outputs = block.scan()
        assert outputs["pump_1.out"] == 1.5
        expected = {"sensor_fault", "invalid_time_step"}
        assert expected <= told(outputs) and "automatic" not in told(outputs)
        # A sensor that was never good is not ridden through.
        assert "failed_safe" in told(outputs)
    # 4 mA are 0 V, and 16 V are 16 mA.
    assert block.inputs["level_1.pv"] == -4.0


ALL = {"level_1.pv": 5.0, "level_1.good": 1.0, "pump_1.mode": 1.0, "time_step": 1.0}
#: What is left unwired, and a bit that tells it.
FORGOTTEN = {"level_1.pv": "sensor_fault", "level_1.good": "sensor_fault",
             "time_step": "invalid_time_step"}  # fmt: skip


@pytest.mark.parametrize("name", FORGOTTEN)
def test_one_forgotten_wire_is_told(name):
    block = unwired(**{other: value for other, value in ALL.items() if other != name})
    assert all(FORGOTTEN[name] in told(block.scan()) for _ in range(10))


def test_with_all_wires_it_is_healthy():
    assert told(unwired(**ALL).scan()) == {"automatic"}


def test_a_sensor_without_a_range_is_not_good_all_the_same():
    law = shelled_loop(1.0, level=Signal("level_1", "V")).controller.law
    found = {signal.name: signal.initial for signal in law.inputs}
    assert found["level_1.good"] == 0.0 and found["pump_1.mode"] == 0.0
