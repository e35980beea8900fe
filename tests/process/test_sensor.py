"""Sensors against calculations by hand: scales, lags, noise, resolution and limits."""

import math
from pathlib import Path

import numpy as np
import pytest

from clepsydra import InputError
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

PLANT = """
name = "plant"
sampling_period = "1 s"
controlled = ["shown"]
{head}

[components.salt]
range = ["0 kg/m^3", "40 kg/m^3"]

[reservoirs.basin]
concentration = {{ salt = "10 kg/m^3" }}

[tanks.tank_1]
{tank}

[orifices.outlet_1]
source = "tank_1"
destination = "basin"
area = "0.5 cm^2"

[pumps.pump_1]
source = "basin"
destination = "tank_1"
gain = "20 cm^3/(s V)"
range = ["0 V", "10 V"]
{nominal}

[sensors.shown]
{sensor}
"""
BOX = 'area = "100 cm^2"\nheight = "30 cm"'
CONE = 'shape = "cone"\nheight = "30 cm"\nrim_diameter = "20 cm"'
MILLIAMPERES = 'range = ["4 mA", "20 mA"]'
VOLTS = 'range = ["0 V", "10 V"]'
SALT = 'tank = "tank_1"\ncomponent = "salt"'
LAG = '\nlag = "2 s"'


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def plant(
    sensor: str, tank: str = BOX, nominal: str = 'nominal = "4 V"', head: str = ""
) -> Process:
    text = PLANT.format(sensor=sensor, tank=tank, nominal=nominal, head=head)
    Path("plant.toml").write_text(text, encoding="utf-8")
    return load_process("plant.toml")


def reading(process: Process, **state: float) -> float:
    """Return the measurement for states by name, "tank_1_level"."""
    values = [state[signal.identifier] for signal in process.state]
    return float(process.measure(values, process.parameter_values))


def displayed(process: Process, value: float) -> float:
    return float(process.display([value]))


def rate(process: Process, state: list[float], inputs: list[float]) -> np.ndarray:
    return np.asarray(process.dynamics(state, inputs, [], process.parameter_values)).ravel()


# tank_1 at 12.5 cm with 8 kg/m³: a share of 0.5 of 25 cm, 0.2 of 40 kg/m³, 1.25 of a litre.
@pytest.mark.parametrize(
    ("sensor", "unit", "shown_unit", "value"),
    [
        ('tank = "tank_1"\nrange = ["0 cm", "25 cm"]', "m", "cm", 0.125),
        ('tank = "tank_1"\ngain = "0.4 V/cm"\nrange = ["0 V", "10 V"]', "V", "V", 5.0),
        ('tank = "tank_1"\ngain = "0.6 mA/cm"\nrange = ["0 mA", "20 mA"]', "A", "mA", 7.5e-3),
        ('tank = "tank_1"\ngain = "4 %/cm"\nrange = ["0 %", "100 %"]', "1", "%", 0.5),
        (f'tank = "tank_1"\nspan = ["0 cm", "25 cm"]\n{MILLIAMPERES}', "A", "mA", 12e-3),
        (f'tank = "tank_1"\nspan = ["5 cm", "25 cm"]\n{MILLIAMPERES}', "A", "mA", 10e-3),
        ('tank = "tank_1"\nspan = ["0 cm", "25 cm"]\nrange = ["0 %", "100 %"]', "1", "%", 0.5),
        ('tank = "tank_1"\nspan = ["5 cm", "25 cm"]\nrange = ["0 V", "10 V"]', "V", "V", 3.75),
        # A scale that begins 5 cm above the floor.
        ('tank = "tank_1"\nspan = ["5 cm", "25 cm"]\nrange = ["0 cm", "20 cm"]', "m", "cm", 0.075),
        ('tank = "tank_1"\nquantity = "volume"\nrange = ["0 l", "3 l"]', "m^3", "l", 1.25e-3),
        (f'tank = "tank_1"\nquantity = "volume"\ngain = "2 V/l"\n{VOLTS}', "V", "V", 2.5),
        (f'{SALT}\nrange = ["0 g/l", "40 g/l"]', "kg/m^3", "g/l", 8.0),
        (f'{SALT}\nspan = ["0 g/l", "40 g/l"]\n{MILLIAMPERES}', "A", "mA", 7.2e-3),
        (f'{SALT}\ngain = "25 mV l/g"\n{VOLTS}', "V", "V", 0.2),
    ],
)  # fmt: skip
def test_scale(sensor: str, unit: str, shown_unit: str, value: float) -> None:
    process = plant(sensor)
    (signal,) = process.measurements
    assert (signal.unit, signal.display_unit) == (unit, shown_unit)
    shown = reading(process, tank_1_level=0.125, tank_1_salt=8.0)
    assert shown == pytest.approx(value, rel=1e-14)
    state = "tank_1.salt" if "component" in sensor else "tank_1.level"
    assert process.measured_state == {"shown": state}
    (element,) = (e for e in process.elements if e.name == "shown")
    assert element.to_quantity(element.to_reading(0.173)) == pytest.approx(0.173, rel=1e-14)


def test_gain_and_zero_are_parameters() -> None:
    """A transmitter that is set 1 cm too high and 10 % too steep."""
    process = plant(f'tank = "tank_1"\nspan = ["5 cm", "25 cm"]\n{MILLIAMPERES}')
    names = [signal.name for signal in process.parameters]
    values = process.parameter_values
    assert process.signal("shown.gain").unit == "A/m"
    assert process.signal("shown.gain").display_unit == "mA/cm"
    assert values[names.index("shown.gain")] == pytest.approx(0.016 / 0.2, rel=1e-15)
    values[names.index("shown.gain")] *= 1.1
    values[names.index("shown.zero")] += 0.01
    # 4 mA + 0.88 mA/cm (12.5 cm - 6 cm)
    assert float(process.measure([0.125, 8.0], values)) == pytest.approx(9.72e-3, rel=1e-14)


def test_lag_follows_as_a_first_order_element() -> None:
    """dq_l/dt = (q - q_l) / T, and the equations of the tank are the same."""
    plain = plant('tank = "tank_1"\nrange = ["0 cm", "30 cm"]')
    process = plant('tank = "tank_1"\nrange = ["0 cm", "30 cm"]' + LAG)
    assert [s.name for s in process.state] == ["tank_1.level", "tank_1.salt", "shown.lagged"]
    moved = rate(process, [0.2, 8.0, 0.15], [4.0])
    assert moved[2] == pytest.approx(0.05 / 2.0, rel=1e-14)
    assert np.array_equal(moved[:2], rate(plain, [0.2, 8.0], [4.0]))
    assert reading(process, tank_1_level=0.2, tank_1_salt=8.0, shown_lagged=0.15) == 0.15
    assert process.measured_state == {"shown": "shown.lagged"}


def test_lagged_level_at_rest_and_its_pole() -> None:
    process = plant(f'tank = "tank_1"\nspan = ["5 cm", "25 cm"]\n{MILLIAMPERES}' + LAG)
    point = find_equilibrium(process)
    # Torricelli: h = (q/a)² / 2g.
    level = (80e-6 / 0.5e-4) ** 2 / (2 * 9.81)
    values = point.as_dict()
    assert values["tank_1.level"] == pytest.approx(level, rel=1e-9)
    assert values["shown.lagged"] == pytest.approx(level, rel=1e-9)
    assert values["shown"] == pytest.approx(4e-3 + 16e-3 * (level - 0.05) / 0.2, rel=1e-9)
    poles = np.linalg.eigvals(linearise(point).A)
    assert np.min(np.abs(poles + 1 / 2.0)) < 1e-12


@pytest.mark.parametrize("span", ['["0 cm", "10 cm"]', '["20 cm", "25 cm"]'])
def test_operating_point_beyond_the_range_of_a_lagged_sensor(span: str) -> None:
    """At 13.05 cm: the quantity goes on where the signal ends."""
    process = plant(f'tank = "tank_1"\nspan = {span}\n{MILLIAMPERES}' + LAG)
    values = find_equilibrium(process).as_dict()
    assert values["shown.lagged"] == pytest.approx(values["tank_1.level"], rel=1e-9)


def test_flow_of_a_pump_and_of_an_outlet() -> None:
    process = plant('flow = "pump_1"\nspan = ["0 l/min", "12 l/min"]\n' + MILLIAMPERES + LAG)
    assert process.signal("shown.gain").display_unit == "mA/(l/min)"
    assert process.signal("shown.gain").initial == pytest.approx(16e-3 / 200e-6, rel=1e-14)
    # Pump: 20 cm³/s a volt at 5 V, the meter still at 60 cm³/s.
    assert rate(process, [0.2, 8.0, 60e-6], [5.0])[2] == pytest.approx(20e-6, rel=1e-12)
    shown = reading(process, tank_1_level=0.2, tank_1_salt=8.0, shown_lagged=50e-6)
    assert shown == pytest.approx(8e-3, rel=1e-14)
    assert find_equilibrium(process).as_dict()["shown"] == pytest.approx(10.4e-3, rel=1e-9)
    process = plant('flow = "outlet_1"\nrange = ["0 l/s", "0.2 l/s"]' + LAG)
    outflow = 0.5e-4 * math.sqrt(2 * 9.81 * 0.2)
    assert rate(process, [0.2, 8.0, 0.0], [5.0])[2] == pytest.approx(outflow / 2, rel=1e-12)


def test_flow_at_rest_is_the_flow_that_is_asked_for() -> None:
    process = plant(
        'flow = "pump_1"\nrange = ["0 l/s", "0.2 l/s"]' + LAG,
        nominal='[operating_point]\nshown = "90 cm^3/s"',
    )
    assert process.nominal_outputs == {"shown": 90e-6}
    point = find_equilibrium(process)
    assert point.as_dict()["pump_1"] == pytest.approx(4.5, rel=1e-9)


def test_volume_of_a_cone_needs_a_lag_and_is_exact() -> None:
    sensor = 'tank = "tank_1"\nquantity = "volume"\nrange = ["0 l", "3 l"]'
    process = plant(sensor + LAG, tank=CONE)
    # At half its height a cone on its point holds an eighth: V = π r² h / 24.
    eighth = math.pi * 0.1**2 * 0.3 / 3 / 8
    moved = rate(process, [0.15, 8.0, 0.0], [0.0])
    assert moved[2] == pytest.approx(eighth / 2.0, rel=1e-12)
    with pytest.raises(InputError) as refusal:
        plant(sensor, tank=CONE)
    assert "expected the time constant of a sensor of such a volume" in str(refusal.value)


@pytest.mark.parametrize(
    ("sensor", "value"),
    [
        ('span = ["0 cm", "25 cm"]\nrange = ["4 mA", "20 mA"]\nnoise = "0.5 %"', 80e-6),
        ('span = ["0 cm", "25 cm"]\nrange = ["4 mA", "20 mA"]\nnoise = "0.1 mA"', 100e-6),
        ('gain = "0.5 V/cm"\nrange = ["0 V", "10 V"]\nnoise = "20 mV"', 0.02),
        ('range = ["5 cm", "25 cm"]\nnoise = "1 mm"', 1e-3),
        ('range = ["5 cm", "25 cm"]\nnoise = "1 %"', 2e-3),
        # % of the range, also where the range is in %.
        ('span = ["0 cm", "25 cm"]\nrange = ["0 %", "50 %"]\nnoise = "1 %"', 5e-3),
        ('range = ["5 cm", "25 cm"]\nnoise = "0 mm"', 0.0),
    ],
)
def test_noise(sensor: str, value: float) -> None:
    process = plant('tank = "tank_1"\n' + sensor)
    assert process.noise == {"shown": pytest.approx(value, rel=1e-14)}


def test_noise_that_is_not_given_is_not_known() -> None:
    assert plant('tank = "tank_1"\nrange = ["5 cm", "25 cm"]').noise == {}


def test_resolution_rounds_to_the_nearest_step() -> None:
    process = plant('tank = "tank_1"\nrange = ["0 cm", "25 cm"]\nresolution = "2 mm"')
    for value, expected in ((0.1009, 0.1), (0.1011, 0.102), (0.1, 0.1), (0.0009, 0.0)):
        assert displayed(process, value) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("scale", "below", "above"),
    [
        # NAMUR NE 43: 3.8 to 20.5 mA is still a measurement.
        (f'span = ["0 cm", "25 cm"]\n{MILLIAMPERES}', 3.8e-3, 20.5e-3),
        ('span = ["0 cm", "25 cm"]\nrange = ["0 mA", "20 mA"]', 0.0, 20e-3),
        ('span = ["0 cm", "25 cm"]\nrange = ["0 V", "10 V"]', 0.0, 10.0),
        ('range = ["5 cm", "25 cm"]', 0.05, 0.25),
    ],
)
def test_limits(scale: str, below: float, above: float) -> None:
    process = plant('tank = "tank_1"\n' + scale)
    inside = 0.3 * below + 0.7 * above
    assert displayed(process, -1.0) == below
    assert displayed(process, 99.0) == above
    assert displayed(process, inside) == inside
    assert math.isnan(displayed(process, math.nan))


def test_resolution_comes_before_the_limits() -> None:
    process = plant('tank = "tank_1"\nrange = ["0 cm", "25 cm"]\nresolution = "2 cm"')
    assert displayed(process, 0.2499) == pytest.approx(0.24, abs=1e-15)
    assert displayed(process, 0.2501) == 0.25


def test_operating_point_by_concentration() -> None:
    """The value is read in the unit of the measurement, and 12 mA is half the span."""
    process = plant(
        f'tank = "tank_1"\ncomponent = "salt"\nspan = ["0 g/l", "40 g/l"]\n{MILLIAMPERES}',
        nominal='[operating_point]\nshown = "12 mA"',
    )
    assert process.nominal_outputs == {"shown": 0.012}


def test_operating_point_in_percent_of_a_range() -> None:
    """As a setpoint and a band: a quarter of 4 to 20 mA is 8 mA, of 0 to 25 cm 6.25 cm."""
    for sensor, expected in (
        (f'span = ["5 cm", "25 cm"]\n{MILLIAMPERES}', 0.008),
        ('range = ["0 cm", "25 cm"]', 0.0625),
    ):
        process = plant(f'tank = "tank_1"\n{sensor}', nominal='[operating_point]\nshown = "25 %"')
        assert process.nominal_outputs == {"shown": pytest.approx(expected, rel=1e-14)}


def test_operating_point_by_volume_and_by_span() -> None:
    for sensor, value in (
        ('quantity = "volume"\nrange = ["0 l", "3 l"]', "1.3 l"),
        (f'span = ["5 cm", "25 cm"]\n{MILLIAMPERES}', "10.4 mA"),
    ):
        process = plant(
            f'tank = "tank_1"\n{sensor}', nominal=f'[operating_point]\nshown = "{value}"'
        )
        point = find_equilibrium(process)
        assert point.as_dict()["tank_1.level"] == pytest.approx(0.13, rel=1e-9)
        volts = 0.5e-4 * math.sqrt(2 * 9.81 * 0.13) / 20e-6
        assert point.as_dict()["pump_1"] == pytest.approx(volts, rel=1e-9)
