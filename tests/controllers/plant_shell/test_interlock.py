"""An interlock holds its output in every mode, tells so, and without one nothing changes."""

import numpy as np
import pytest
from shell_rig import one_loop, shelled_loop

from clepsydra.controllers.blocks.status import read_status
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.plant_shell.status import INTERLOCKED_BITS

HELD = PlantShell(interlock={"pump_1": 1.5})


def test_an_output_without_an_interlock_has_no_port_of_it():
    law = with_plant_shell(one_loop(), 1.0).law
    assert not [
        s.name for s in (*law.inputs, *law.outputs, *law.parameters) if "interlock" in s.name
    ]


@pytest.mark.parametrize("mode", [0.0, 1.0, 2.0, 3.0, -1.0])
def test_it_wins_in_every_mode(mode):
    law = shelled_loop(1.0, HELD)
    given = {"pump_1.mode": mode, "pump_1.manual": 7.0, "pump_1.tracking": 8.0}
    law.scan(**given, **{"pump_1.interlock": 0.0})
    out = law.scan(**given, **{"pump_1.interlock": 1.0})
    assert out["pump_1.out"] == 1.5
    assert {"interlocked", "tracking"} <= set(
        read_status(int(out["pump_1.status"]), INTERLOCKED_BITS)
    )
    assert out["pump_1.conditions.interlocked"] == 1.0


def test_the_law_goes_on_from_the_interlock_value():
    """At rest, with no error left to act on, the output stays where the interlock had it."""
    law = shelled_loop(1.0, HELD)
    rest = {"pump_1.mode": 1.0, "level_1.sp": 5.0, "level_1.pv": 5.0}
    for interlock in (0.0, 1.0, 1.0):
        law.scan(**rest, **{"pump_1.interlock": interlock})
    after = law.scan(**rest, **{"pump_1.interlock": 0.0})
    assert after["pump_1.out"] == pytest.approx(1.5, abs=1e-12)
    assert set(read_status(int(after["pump_1.status"]), INTERLOCKED_BITS)) == {"automatic"}


def test_it_acknowledges_no_fault_of_a_sensor():
    """A latched fault waits for a person, whatever an alarm does in between."""
    law = shelled_loop(1.0, HELD)
    automatic = {"pump_1.mode": 1.0, "pump_1.interlock": 0.0, "level_1.good": 1.0}
    law.scan(**automatic)
    for _ in range(8):
        law.scan(**automatic | {"level_1.good": 0.0})
    for interlock in (0.0, 1.0, 1.0, 0.0):
        out = law.scan(**automatic | {"pump_1.interlock": interlock})
        assert "failed_safe" in read_status(int(out["pump_1.status"]), INTERLOCKED_BITS)
        assert out["pump_1.out"] == (1.5 if interlock else 0.0)
    # Who moves it in manual has looked.
    law.scan(**automatic | {"pump_1.mode": 0.0})
    out = law.scan(**automatic)
    assert "failed_safe" not in read_status(int(out["pump_1.status"]), INTERLOCKED_BITS)


def test_one_that_nobody_wires_holds_its_output():
    law = with_plant_shell(one_loop(), 1.0, HELD).law
    (port,) = (signal for signal in law.inputs if signal.part == "interlock")
    assert (port.kind, port.initial) == ("boolean", 1.0)


def test_an_interlock_that_never_acts_changes_no_bit():
    plain, held = shelled_loop(1.0), shelled_loop(1.0, HELD)
    random = np.random.default_rng(7)
    for _ in range(2000):
        given = {
            "level_1.pv": random.normal(5.0, 2.0), "level_1.sp": 5.0,
            "level_1.good": float(random.random() < 0.9),
            "pump_1.mode": float(random.choice([0, 1, 1, 1, 2, 3])),
            "acknowledge": float(random.random() < 0.1),
        }  # fmt: skip
        first, second = plain.scan(**given), held.scan(**given, **{"pump_1.interlock": 0.0})
        for name, value in first.items():
            assert value == second[name], name


def test_a_value_outside_the_limits_is_held_at_the_limit():
    law = shelled_loop(1.0, PlantShell(interlock={"pump_1": 12.0}))
    assert law.scan(**{"pump_1.interlock": 1.0})["pump_1.out"] == 10.0
