"""A setpoint outside the range of its sensor is held at the end of it, and the word says so."""

from dataclasses import replace

import pytest
from shell_rig import LEVEL, read_status, shelled_loop


def bits(outputs) -> tuple[str, ...]:
    return read_status(int(outputs["pump_1.status"]))


def test_one_scan_of_a_million_leaves_nothing_behind():
    """Without the range it left 50,000 V in the integral."""
    struck, calm = (shelled_loop(1.0, level_1_setpoint_weight=0.5) for _ in range(2))
    for loop in (struck, calm):
        loop.scan(level_1_pv=5.0)
    outputs = struck.scan(level_1_sp=1e6)
    assert "setpoint_limited" in bits(outputs) and outputs["pump_1.out"] <= 10.0
    calm.scan(level_1_sp=LEVEL.high)
    assert struck.state == calm.state
    outputs = struck.scan(level_1_sp=5.0)
    assert "setpoint_limited" not in bits(outputs)
    # Half the gain times the range is the most that a setpoint can make of it.
    assert abs(struck.state["level_1.integral"] - 3.0) < 0.5 * 2.0 * LEVEL.span


@pytest.mark.parametrize(("asked", "followed"), [
    (16.0, 16.0), (16.0000001, 16.0), (-1e-9, 0.0), (0.0, 0.0), (-1e6, 0.0), (1e300, 16.0),
])  # fmt: skip
@pytest.mark.parametrize("mode", [0, 1, 2])
def test_the_ends_of_the_range(mode, asked, followed):
    loop = shelled_loop(1.0)
    outputs = loop.scan(level_1_sp=asked, pump_1_mode=mode)
    assert loop.state["level_1.ramped_setpoint"] == followed
    assert ("setpoint_limited" in bits(outputs)) == (asked != followed)


def test_the_range_is_that_of_the_transmitter_also_the_other_way_round():
    loop = shelled_loop(1.0, level=replace(LEVEL, low=2.0, high=12.0))
    loop.scan(level_1_sp=1.0)
    assert loop.state["level_1.ramped_setpoint"] == 2.0
    loop.values |= {"level_1.range_low": 12.0, "level_1.range_high": 2.0}
    for asked, followed in ((1.0, 2.0), (7.0, 7.0), (20.0, 12.0)):
        loop.scan(level_1_sp=asked)
        assert loop.state["level_1.ramped_setpoint"] == followed


def test_a_signal_without_a_range_leaves_every_setpoint():
    boundless = replace(LEVEL, low=float("-inf"), high=float("inf"))
    loop = shelled_loop(1.0, level=boundless)
    assert "setpoint_limited" not in bits(loop.scan(level_1_sp=1e6))
    assert loop.state["level_1.ramped_setpoint"] == 1e6
    above = shelled_loop(1.0, level=replace(LEVEL, high=float("inf")))
    assert "setpoint_limited" in bits(above.scan(level_1_sp=-1.0))


def test_what_is_no_number_is_another_bit():
    word = bits(shelled_loop(1.0).scan(level_1_sp=float("inf")))
    assert "invalid_input" in word and "setpoint_limited" not in word
