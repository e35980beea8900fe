"""Numbers that can be had by hand, and what a block cannot do."""

from dataclasses import replace

import pytest
from plants import designed, plant
from schemes import scheme
from tunings import BLOCKS, LEVEL, PUMP, tuning

from clepsydra import InputError, PidForm, Signal
from clepsydra.deploy.vendor_tuning.filling import filled
from clepsydra.deploy.vendor_tuning.printed_gain import printed_number
from clepsydra.deploy.vendor_tuning.translation import translate


def words(key, case):
    return [setting.words for setting in filled(BLOCKS[key], case).settings]


def test_units_of_gain_and_time():
    case = tuning(4.0, 120.0, 15.0, 1.5)
    assert words("rockwell-pide-dependent", case) == ["KC = 2 %/%", "TI = 2 min", "TD = 0.25 min"]
    assert words("rockwell-pide-independent", case) == [
        "KP = 2 %/%",
        "KI = 1 1/min",
        "KD = 0.5 min",
    ]
    assert words("rockwell-pid-independent", case) == [
        "KP = 2 %/%",
        "Ki = 0.016667 1/s",
        "Kd = 30 s",
    ]
    assert words("codesys-pid", case) == ["KP = 0.04 V/cm", "TN = 120 s", "TV = 15 s"]
    assert words("omron-pidat", case) == ["P = 50 %", "Tik = 120 s", "Tdk = 15 s", "α = 0"]
    assert words("siemens-pid-compact", case)[3] == "TdFiltRatio = 0.1"
    assert words("honeywell-hc900-pid", tuning()) == [
        "Prop Band = 50 %", "Gain = 2 %/%", "Reset = 2 min", "Reset (RPM) = 0.5 1/min",
    ]  # fmt: skip


def test_series_form_by_hand():
    """K = 2.5, Ti = 12.5, Td = 1.9, Tf = 0.5 is the product with 2, 10, 2.5 and 0.5."""
    case = tuning(5.0, 12.5, 1.9, 0.5, form=PidForm("PID", derivative_on="error"))
    assert words("emerson-deltav-series", case) == [
        "GAIN = 2 %/%", "RESET = 10 s", "RATE = 2.5 s", "ALPHA = 0.2",
    ]  # fmt: skip


@pytest.mark.parametrize("key", ["emerson-deltav-standard", "emerson-deltav-series"])
def test_deltav_is_told_where_its_output_and_its_reset_end(key):
    """0.5 to 9 l/s as the process shows it, and nothing where nothing limits the output."""
    flow = Signal("feed", "m^3/s", display_unit="l/s", low=0.0, high=0.01)
    limited = replace(tuning(moved=flow), limits=(0.0005, 0.009))
    assert words(key, limited)[-4:] == [
        "OUT_LO_LIM = 0.5 l/s", "OUT_HI_LIM = 9 l/s", "ARW_LO_LIM = 0.5 l/s",
        "ARW_HI_LIM = 9 l/s",
    ]  # fmt: skip
    assert not [each for each in words(key, tuning()) if "LIM" in each]


def test_the_limits_are_those_of_the_controller():
    """A pump of 0 to 10 V that its controller keeps from 1 to 8 V."""
    tank = plant("quadruple-tank")
    controller = designed("simc", "quadruple-tank")
    kept = controller.with_values({"pump_1.low_limit": "1 V", "pump_1.high_limit": "8 V"})
    found = translate(kept, tank.process)
    (row, _) = [r for r in found.rows if r.block.key == "emerson-deltav-standard"]
    settings = [setting.words for setting in row.filled.settings]
    assert "OUT_LO_LIM = 1 V" in settings and "ARW_HI_LIM = 8 V" in settings


def test_the_limits_of_an_outer_loop_are_those_of_the_setpoint_that_it_moves():
    """A flow whose meter reads to 60 l/s and whose setpoint may go from 5 to 35 l/s."""
    controller, ready = scheme("cascade")
    limits = {"flow.setpoint_low_limit": 0.005, "flow.setpoint_high_limit": 0.035}
    kept = replace(controller, values={**controller.values, **limits})
    found = translate(kept, ready.process)
    outer, inner = (r for r in found.rows if r.block.key == "emerson-deltav-standard")
    settings = [setting.words for setting in outer.filled.settings]
    assert settings[-4:] == [
        "OUT_LO_LIM = 5 l/s", "OUT_HI_LIM = 35 l/s", "ARW_LO_LIM = 5 l/s", "ARW_HI_LIM = 35 l/s",
    ]  # fmt: skip
    assert "OUT_HI_LIM = 100 %" in [setting.words for setting in inner.filled.settings]


@pytest.mark.parametrize(
    ("key", "switch", "reverse", "direct"),
    [
        ("siemens-pid-compact", "Invert control logic", "no", "yes"),
        ("rockwell-pide-dependent", "control action", "E = SP − PV", "E = PV − SP"),
        ("emerson-deltav-standard", "CONTROL_OPTS, Direct Acting", "off", "on"),
        ("honeywell-hc900-pid", "Direction", "REVERSE", "DIRECT"),
    ],
)
def test_action_is_a_switch_beside_a_gain_above_zero(key, switch, reverse, direct):
    for gain, expected in ((4.0, reverse), (-4.0, direct)):
        found = filled(BLOCKS[key], tuning(gain))
        assert dict(found.choices)[switch] == expected
        assert all(setting.value > 0 or "α" in setting.name for setting in found.settings)
        assert found.applied.settings.gain == gain


def test_action_is_the_sign_of_the_gain():
    assert words("siemens-cont-c", tuning(-4.0))[0] == "GAIN = -2 %/%"
    # ERROR is PV − SP there.
    assert words("iec-61131-3-pid", tuning(-4.0))[0] == "KP = 0.04 V/cm"
    assert words("iec-61131-3-pid", tuning(4.0))[0] == "KP = -0.04 V/cm"


@pytest.mark.parametrize(
    ("key", "case", "expected"),
    [
        ("codesys-pid", tuning(4.0, 120, 15, 1.5), "differentiates the error"),
        ("codesys-pid", tuning(4.0, 120, 15, 1.5), "no derivative filter"),
        ("rockwell-micrologix", tuning(4.0, 120, 15, 1.5), "Td/16 = 0.9375 s"),
        ("yokogawa-fieldbus-pid", tuning(0.02), "GAIN from 0.05 to 20 %/%, not 0.01"),
        ("honeywell-hc900-pid", tuning(4.0, 6000.0), "Reset from 0.02 to 50 min, not 100"),
        ("omron-pidat", tuning(4.0, 1000.0), "Tik from 0.1 to 819.1 s, not 1000"),
        ("emerson-deltav-standard", tuning(4.0, 120, 15, 0.3), "ALPHA from 0.05 to 1, not 0.02"),
        ("siemens-cont-c", tuning(weight=0.5), "weighs the setpoint with 1, the controller"),
    ],
)
def test_what_a_block_lacks_is_said(key, case, expected):
    assert any(expected in said for said in filled(BLOCKS[key], case).differs)


def test_an_unpublished_filter_is_a_note():
    found = filled(BLOCKS["rockwell-pide-dependent"], tuning(4.0, 120, 15, 1.5))
    assert not found.differs
    assert any("not published; the check takes 1.5 s" in said for said in found.notes)


def test_what_is_not_confirmed_of_the_derivative_concerns_only_loops_with_one():
    block = BLOCKS["rockwell-pide-dependent"]
    with_derivative = filled(block, tuning(4.0, 120, 15, 1.5)).notes
    assert any("not confirmed" in said for said in with_derivative)
    assert not filled(block, tuning()).notes


def test_without_integral_there_is_no_integral_time_but_a_bias():
    case = tuning(4.0, float("inf"), form=PidForm("P"))
    found = filled(BLOCKS["rockwell-pide-dependent"], case)
    assert [setting.words for setting in found.settings] == ["KC = 2 %/%"]
    assert any("bias" in said for said in found.notes)


def test_rounding_is_that_of_the_block():
    assert words("rockwell-micrologix", tuning(4.01, 100.0)) == ["KC = 2 %/%", "TI = 1.67 min"]
    found = filled(BLOCKS["rockwell-micrologix"], tuning(4.01, 100.0)).applied.settings
    assert found.gain == pytest.approx(4.0, rel=1e-14)
    assert found.integral_time == pytest.approx(100.2, rel=1e-14)
    assert words("beckhoff-fb-ctrl-pid", tuning(4.0, 2.000416)) == ["fKp = 0.04 V/cm", "tTn = 2 s"]


@pytest.mark.parametrize(
    ("key", "case", "expected"),
    [
        ("honeywell-hc900-pid", tuning(4.0, 120, 15, 1.5), "how this block differentiates"),
        ("emerson-deltav-series", tuning(4.0, 50, 15, 1.5), "4 Ti Td"),
        ("rockwell-micrologix", tuning(0.004), "half the block's step of 0.01"),
        ("siemens-pid-compact", tuning(measurement=Signal("level", "m")), "level without a range"),
    ],
)
def test_what_cannot_be_filled_is_refused(key, case, expected):
    with pytest.raises(InputError, match=expected):
        filled(BLOCKS[key], case)


def test_a_gain_in_units_needs_no_range():
    case = tuning(measurement=Signal("level", "m"), moved=PUMP)
    assert words("codesys-pid", case)[0] == "KP = 4 V/m"
    assert LEVEL.display_unit == "cm" and words("codesys-pid", tuning())[0] == "KP = 0.04 V/cm"


def test_five_digits():
    assert [printed_number(v) for v in (1 / 3, 123456.0, 1e-7 / 3, -2.0, 0.0)] == [
        "0.33333", "1.2346e+05", "3.3333e-08", "-2", "0",
    ]  # fmt: skip
