"""Limits that an independent prototype found, within what a limit is proved by."""

from dataclasses import replace

import pytest

import clepsydra as cl

TOLERANCE = 0.005


@pytest.fixture(scope="module")
def four_steps():
    """The four setpoint steps of 1 V of the quadruple tank."""
    return cl.limit("quadruple-tank")


def test_a_step_of_one_volt_of_the_quadruple_tank(four_steps):
    first = four_steps.found[0]
    assert first.index == pytest.approx(1.789, rel=TOLERANCE)
    assert first.errors["level_1"] + first.errors["level_2"] == pytest.approx(1.789, rel=TOLERANCE)
    assert first.horizon == 600.0


def test_all_steps_of_the_quadruple_tank(four_steps):
    assert four_steps.index == pytest.approx(12.48, rel=TOLERANCE)
    assert [each.proofs.failed for each in four_steps.found] == [()] * 4


def test_rest_within_a_minute_costs_seven_times_as_much():
    """The upper tanks of the quadruple tank take longer to come to rest; so it is not proved."""
    found = cl.limit("quadruple-tank", [cl.step("level_1", "+1 V", at="1 s")], duration="61 s")
    (short,) = found.found
    assert short.best.time[-1] == 60.0
    assert short.index == pytest.approx(13.4, rel=TOLERANCE)
    assert "horizon" in short.proofs.failed and not short.accepted
    said = " ".join(str(found).split())
    assert said.startswith("No limit is proved for Quadruple tank, minimum phase: these errors")
    assert "level_1 at 1 s: twice the time to come to rest changes it by " in said
    assert " where at most 0.5 % is allowed." in said


def test_a_centimetre_of_the_three_tanks():
    found = cl.limit("three-tanks", [cl.step("level_3", "+1 cm", at="10 s")])
    assert found.found[0].errors["level_3"] == pytest.approx(0.354, rel=TOLERANCE)  # [m s]


def averaging_tank(period: float) -> cl.Plant:
    """Return the averaging tank whose flows are both moved, sampled with a period [s]."""
    return cl.Plant(replace(cl.load("averaging-tank:all-inputs").process, sampling_period=period))


def test_a_tenth_of_a_cubic_metre_of_the_averaging_tank():
    """Both flows together move the volume by 1 m³/s, so that 0.1 m³ take 0.1 s."""
    step = [cl.step("volume", "+0.1 m^3", at="1 s")]
    (found,) = cl.limit(averaging_tank(0.1), step, duration="21 s").found
    assert found.errors["volume"] == pytest.approx(0.0050, rel=TOLERANCE)


@pytest.mark.parametrize(
    ("period", "printed"),
    # At 100 ms the step takes one sample. The prototype has the area below the curve, 0.01230; a
    # score takes the straight line between samples, half of 0.25 kmol/m³ times 0.1 s.
    [(0.1, 0.25 * 0.1 / 2), (0.01, 0.00327)],
)
def test_a_quarter_of_a_kilomole_in_the_averaging_tank(period, printed):
    step = [cl.step("concentration", "+0.25 kmol/m^3", at="1 s")]
    (found,) = cl.limit(averaging_tank(period), step, duration="21 s").found
    assert found.errors["concentration"] / 1000 == pytest.approx(printed, rel=TOLERANCE)
