"""Every change of who moves an output, and every way back, without a bump."""

from functools import cache
from pathlib import Path

import pytest
from scan_rig import ScannedLaw, at_rest, designed

from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell

DEAD_TIME = Path(__file__).parents[2] / "dead-time.toml"
#: Families that take an output up in one scan.
AT_ONCE = [
    ("PI, SIMC", "quadruple-tank"),
    ("PI, SIMC, static decoupling", "quadruple-tank"),
    ("PI, variable structure", "quadruple-tank"),
    ("LQI, Bryson", "quadruple-tank"),
    ("LQI, gain scheduling", "quadruple-tank"),
    ("LQI, recomputed", "quadruple-tank"),
    ("2DOF polynomial, LQ", "quadruple-tank"),
    ("Feedback linearisation", "quadruple-tank"),
    ("One-step inverse", "averaging-tank"),
    ("Fuzzy PI", "quadruple-tank"),
    ("2DOF polynomial, LQ", DEAD_TIME),
]
#: Families that remember measurements, and how far they go in the scan after taking up.
IN_TIME = [
    ("PID, phase margin", "quadruple-tank", 1e-5),
    ("PID, SIMC", DEAD_TIME, 2e-4),
    ("Smith predictor, LQ", DEAD_TIME, 1e-4),
]
BUMP = 1e-9


@cache
def shelled(name, process):
    """The controller and behind a shell that fails safe at 40 % of its range, and its plant."""
    controller, plant = designed(name, process)
    signal = controller.law.outputs[0]
    safe = dict.fromkeys(controller.manipulated, signal.low + 0.4 * signal.span)
    shell = PlantShell(fail_safe=safe)
    return controller, with_plant_shell(controller, plant.process.sampling_period, shell), plant


class Rig:
    def __init__(self, name, process):
        self.controller, behind_shell, plant = shelled(name, process)
        self.period = plant.process.sampling_period
        first = self.controller.law.outputs[0]
        self.span, low = first.span, first.low
        self.safe = low + 0.4 * self.span
        self.moved = low + 0.55 * self.span
        self.loop = ScannedLaw(behind_shell, self.period, **at_rest(behind_shell, plant))
        self.loop.scans(20)

    def all(self, what, value):
        return {f"{name}.{what}": value for name in self.controller.manipulated}

    def elsewhere(self, share=0.02):
        """Other measurements, and setpoints that ask for nothing more than these."""
        inputs = {s.name: s for s in self.controller.law.inputs}
        given = {}
        for name in (f"{each}.pv" for each in self.controller.measurements):
            given[name] = self.loop.inputs[name] + share * inputs[name].span
        for name in self.controller.setpoints:
            given[f"{name}.sp"] = given[f"{name}.pv"]
        return given

    def sensors(self, good):
        return {f"{name}.good": float(good) for name in self.controller.measurements}

    def bump(self, outputs, value):
        moved = (outputs[f"{name}.out"] for name in self.controller.manipulated)
        return max(abs(each - value) for each in moved) / self.span


@pytest.mark.sampled
@pytest.mark.parametrize(("name", "process"), AT_ONCE)
@pytest.mark.parametrize(("mode", "what"), [(0, "manual"), (2, "tracking")])
def test_automatic_goes_on_where_a_hand_or_another_controller_stopped(name, process, mode, what):
    rig = Rig(name, process)
    outputs = rig.loop.scans(5, **rig.all("mode", mode), **rig.all(what, rig.moved))
    assert rig.bump(outputs, rig.moved) == 0.0
    assert rig.bump(rig.loop.scan(**rig.all("mode", 1)), rig.moved) <= BUMP


@pytest.mark.parametrize(("name", "process"), AT_ONCE)
@pytest.mark.parametrize("waits", [0, 7])
def test_the_way_back_from_fail_safe(name, process, waits):
    """Acknowledged with the first good scan, and later; the measurement has changed meanwhile."""
    rig = Rig(name, process)
    delay = int(-(-4.0 // rig.period))
    outputs = rig.loop.scans(delay + 12, **rig.sensors(False))
    assert rig.bump(outputs, rig.safe) == 0.0
    elsewhere = rig.elsewhere()
    for _ in range(waits):
        assert rig.bump(rig.loop.scan(**rig.sensors(True), **elsewhere), rig.safe) == 0.0
    outputs = rig.loop.scan(acknowledge=1, **rig.sensors(True), **elsewhere)
    scans = int(rig.loop.values["take_up_scans"])
    for _ in range(scans):
        assert rig.bump(outputs, rig.safe) <= BUMP
        outputs = rig.loop.scan(acknowledge=0)
    # In force again: no more than what is left after taking up.
    assert rig.bump(outputs, rig.safe) <= (BUMP if scans < 20 else 1e-4)


@pytest.mark.parametrize(("name", "process"), AT_ONCE)
def test_a_warm_start_takes_up_the_present_measurement(name, process):
    rig = Rig(name, process)
    rig.loop.scans(5, **rig.all("mode", 0), **rig.all("manual", rig.moved))
    rig.loop.scan(**rig.all("mode", 1))
    outputs = rig.loop.scan(start=1, **rig.elsewhere())
    for _ in range(int(rig.loop.values["take_up_scans"])):
        assert rig.bump(outputs, rig.moved) <= BUMP
        outputs = rig.loop.scan(start=0)
    assert rig.bump(outputs, rig.moved) <= BUMP


def after_warm_start(rig, scans):
    """How far an output goes in the first scan in force after so many of taking up."""
    rig.loop.values["take_up_scans"] = scans
    last = f"{rig.controller.manipulated[-1]}.out"
    before = [rig.loop.scan()[last] for _ in rig.controller.manipulated][-1]
    outputs = rig.loop.scan(start=1, **rig.elsewhere())
    for _ in range(int(scans)):
        assert abs(outputs[last] - before) <= BUMP * rig.span
        outputs = rig.loop.scan(start=0)
    return abs(outputs[last] - before) / rig.span


@pytest.mark.parametrize(("name", "process", "bound"), IN_TIME)
def test_a_law_that_remembers_measurements_takes_more_scans(name, process, bound):
    """With one scan only the change of the measurement by 2 % would be a bump."""
    scans = Rig(name, process).loop.values["take_up_scans"]
    assert 2 <= scans <= 20
    assert after_warm_start(Rig(name, process), scans) <= bound
    assert after_warm_start(Rig(name, process), 1.0) > 100.0 * bound


def test_a_warm_start_waits_for_the_sensors():
    rig = Rig("PI, SIMC", "quadruple-tank")
    before = rig.loop.scan()["pump_1.out"]
    rig.loop.scan(start=1, **rig.sensors(False))
    rig.loop.scans(2, start=0)
    elsewhere = rig.elsewhere()
    for _ in range(3):
        outputs = rig.loop.scan(**rig.sensors(True), **elsewhere)
        assert abs(outputs["pump_1.out"] - before) / rig.span <= BUMP


def test_fail_safe_begins_and_ends_in_manual_where_the_hand_says():
    rig = Rig("PI, SIMC", "quadruple-tank")
    rig.loop.scans(8, **rig.sensors(False))
    outputs = rig.loop.scan(**rig.all("mode", 0), **rig.all("manual", rig.safe))
    assert rig.bump(outputs, rig.safe) == 0.0
    rig.loop.scans(3, **rig.all("manual", rig.moved), **rig.sensors(True))
    outputs = rig.loop.scans(2, **rig.all("mode", 1))
    assert rig.bump(outputs, rig.moved) <= BUMP
