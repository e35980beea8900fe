"""A gain in a study file is converted through the two signals that it joins, or refused."""

import pytest

from clepsydra import InputError
from clepsydra.linear.linearise import linearise
from clepsydra.process.reader import load_process
from clepsydra.studies.file.reader import read_study

PERCENT = "laboratory-four-tanks"
VOLTS = "laboratory-four-tanks:report,volts"


def proportional_gain(folder, process, gain, output="pump_1", measurement="level_1"):
    """Return the gain [SI] that a P loop of a study runs with."""
    path = folder / "study.toml"
    path.write_text(
        f'process = "{process}"\n[controllers.a.loops.one]\nmeasurement = "{measurement}"\n'
        f'output = "{output}"\nactions = "P"\naction = "reverse"\ngain = {gain}\n',
        encoding="utf-8",
    )
    request = read_study(path)
    model = linearise(request.analysis.operating_point)
    return request.controllers[0].make(request.analysis, model).values["one.proportional_gain"]


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("process", "gain", "expected"),
    [
        # A percent of a level is a hundredth of 25 cm, though its sensor goes to 120 %.
        (PERCENT, '"1 %/%"', 1.0),
        (PERCENT, "1.0", 1.0),
        (PERCENT, '"0.25 1/%"', 25.0),
        # 15 V and 6 V are the ends of the ranges.
        (VOLTS, '"1 V/V"', 1.0),
        (VOLTS, '"1000 mV/V"', 1.0),
        (VOLTS, '"1 %/%"', 15.0 / 6.0),
        (VOLTS, '"2 %/V"', 0.3),
        (VOLTS, '"0.3 V/%"', 5.0),
        (VOLTS, "1.0", 1.0),
        ("quadruple-tank", '"1 V/V"', 1.0),
    ],
)
def test_a_gain_is_converted_through_its_signals(tmp_path, process, gain, expected):
    found = proportional_gain(tmp_path, process, gain)
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("process", "gain"),
    [
        (PERCENT, '"1 V/V"'),
        (PERCENT, '"1 cm/cm"'),
        (PERCENT, '"0.2 V/%"'),
        (PERCENT, '"1 %/V"'),
        (VOLTS, '"1 cm/cm"'),
        (VOLTS, '"1 A/A"'),
        (VOLTS, '"1 V/cm"'),
    ],
)
def test_a_gain_of_other_signals_is_refused_with_the_reason(tmp_path, process, gain):
    with pytest.raises(InputError) as caught:
        proportional_gain(tmp_path, process, gain)
    assert caught.value.place.endswith("gain")
    assert "pump_1" in caught.value.expected
    assert "level_1" in caught.value.expected


def test_one_percent_of_a_signal_everywhere():
    """What a setpoint of 60 % is, an axis in percent shows as 60 %."""
    level = load_process(PERCENT).signal("level_1")
    assert level.high == pytest.approx(1.2)
    assert level.to_percent(0.6) == pytest.approx(60.0)
    assert level.from_percent(60.0) == pytest.approx(0.6)
