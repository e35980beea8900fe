"""What is filled in, put into the vendor's equation, is the controller's own transfer function."""

import numpy as np
import pytest
from documented_blocks import DOCUMENTED, UNPUBLISHED, documented
from tunings import tuning

from clepsydra import PidForm
from clepsydra.deploy.vendor_tuning.filling import filled
from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK

S = 1j * np.logspace(-4, 1, 40)


def rounding(block, found):
    """What rounding each number by half its last digit, or half a step, can do to all of it.

    Twice the sum of the relative changes: where integral and derivative cancel, the sum of the
    actions is smaller than each.
    """
    steps = {parameter.name: parameter.resolution for parameter in block.parameters}
    total = 0.0
    for setting in found.settings:
        if setting.value:
            digit = 10.0 ** (np.floor(np.log10(abs(setting.value))) - 4)
            total += max(digit, steps[setting.name]) / 2 / abs(setting.value)
    return 2 * total


def own(tuning, unit, s=S):
    """The controller in ISA form: (to setpoint, to minus measurement) in the block's unit."""
    gain, ti, td, tf, weight = tuning.settings
    gain *= {"percent": 5.0 / 10.0, "engineering": 0.01}[unit]
    action = td * s / (1 + tf * s)
    on_error = tuning.form.derivative_on == "error"
    setpoint = weight + 1 / (ti * s) + (action if on_error else 0)
    return gain * setpoint, gain * (1 + 1 / (ti * s) + action)


def worst(block, case, filter_time=0.0):
    found = filled(block, case)
    errors = []
    for way in documented(block.key, found.settings, found.choices, filter_time):
        for theirs, ours in zip(way(S), own(case, block.gain_in), strict=True):
            errors.append(np.max(np.abs(theirs / ours - 1)))
    return found, max(errors)


def test_every_block_has_an_equation_here():
    assert {block.key for block in EVERY_BLOCK} == set(DOCUMENTED) | set(UNPUBLISHED)


@pytest.mark.parametrize("gain", [4.0, -4.0, 0.7123456])
@pytest.mark.parametrize("block", EVERY_BLOCK, ids=lambda block: block.key)
def test_pi_is_the_same_in_every_block(block, gain):
    found, error = worst(block, tuning(gain, 123.456))
    assert not found.differs
    assert error < rounding(block, found)


def case_for(block, gain):
    """A PID that the block can do as it is: its derivative, its filter, its setpoint weight."""
    on = block.derivative_on[0]
    form = PidForm("PID", derivative_on=on)
    td = 17.65432
    tf = {"none": 0.0, "settable": 2.5, "unpublished": 2.5}.get(block.derivative_filter)
    tf = td / block.derivative_filter if tf is None else tf
    weight = 0.35 if not block.weights and block.form == "isa" else 1.0
    return tuning(gain, 123.456, td, tf, weight, form)


@pytest.mark.parametrize("gain", [4.0, -0.7123456])
@pytest.mark.parametrize(
    "block",
    [block for block in EVERY_BLOCK if block.derivative_on and block.form != "series"],
    ids=lambda block: block.key,
)
def test_pid_is_the_same_in_every_block_that_can_do_it(block, gain):
    case = case_for(block, gain)
    found, error = worst(block, case, case.settings.filter_time)
    assert not found.differs
    assert error < rounding(block, found)


@pytest.mark.parametrize("gain", [4.0, -0.7123456])
def test_pid_in_series_form_is_the_same_where_all_acts_on_the_error(gain):
    block = next(block for block in EVERY_BLOCK if block.form == "series")
    case = tuning(gain, 123.456, 17.65432, 2.5, 1.0, PidForm("PID", derivative_on="error"))
    found, error = worst(block, case)
    assert not found.differs
    assert error < rounding(block, found)


def test_pid_in_series_form_answers_to_disturbances_alike_and_says_what_setpoints_do():
    block = next(block for block in EVERY_BLOCK if block.form == "series")
    case = tuning(4.0, 123.456, 17.65432, 2.5)
    found = filled(block, case)
    (way,) = documented(block.key, found.settings, found.choices, 0.0)
    (their_setpoint, their_process), (our_setpoint, our_process) = way(S), own(case, "percent")
    assert np.max(np.abs(their_process / our_process - 1)) < rounding(block, found)
    assert np.max(np.abs(their_setpoint / our_setpoint - 1)) > 0.01
    assert any("weighs the setpoint" in words for words in found.differs)


@pytest.mark.parametrize("block", EVERY_BLOCK, ids=lambda block: block.key)
def test_a_setpoint_weight_is_kept_or_what_is_taken_is_said(block):
    found, error = worst(block, tuning(4.0, 123.456, weight=0.35))
    if block.weights:
        assert error > 0.1
        assert any("weighs the setpoint" in words for words in found.differs)
    else:
        assert not found.differs
        assert error < rounding(block, found)


@pytest.mark.parametrize("block", EVERY_BLOCK, ids=lambda block: block.key)
def test_a_setpoint_weight_of_zero_is_had_by_a_switch(block):
    found, error = worst(block, tuning(4.0, 123.456, weight=0.0))
    if 0.0 in block.weights or (not block.weights and block.key != "omron-pidat"):
        assert not found.differs
        assert error < rounding(block, found)
    else:
        # Omron's α ends at 0.99.
        assert found.differs
