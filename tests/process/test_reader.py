"""A process as it comes from its file: signals, units, ranges, operating point."""

from pathlib import Path

import pytest
from written_plants import plant_of

from clepsydra.base.units import from_si
from clepsydra.process.elements.forced_flow import ForcedFlow
from clepsydra.process.elements.tank import Tank
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.process.vessels.prism import Prism

VALID = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")


def read(tmp_path: Path, *edits: tuple[str, str]) -> Process:
    return plant_of(tmp_path, VALID, *edits).process


def test_an_orifice_may_have_a_diameter(tmp_path: Path) -> None:
    """Of 20 mm: π/4 · 4 cm²."""
    process = read(tmp_path, ('area = "0.071 cm^2"', 'diameter = "20 mm"'))
    area = process.signal("outlet_1.area")
    assert area.initial == pytest.approx(3.14159265e-4, rel=1e-8)
    assert area.shown_unit == "mm^2"


def test_signals_of_the_catalogue() -> None:
    process = load_process("quadruple-tank")
    assert [s.name for s in process.state] == [f"tank_{i}.level" for i in range(1, 5)]
    assert [s.name for s in process.measurements] == [f"level_{i}" for i in range(1, 5)]
    assert process.measured_state == {f"level_{i}": f"tank_{i}.level" for i in range(1, 5)}
    assert process.controlled == ("level_1", "level_2")
    for signal in process.state:
        assert (signal.low, signal.high, signal.unit, signal.display_unit) == (0.0, 0.2, "m", "cm")
    for signal in process.inputs:
        assert (signal.low, signal.high, signal.initial, signal.unit) == (0.0, 10.0, 3.0, "V")
    for signal in process.measurements:
        assert (signal.low, signal.high, signal.unit) == (0.0, 10.0, "V")
    for signal in process.disturbances:
        assert (signal.unit, signal.display_unit) == ("m^3/s", "cm^3/s")
        assert (signal.low, signal.high, signal.initial) == (0.0, 5e-6, 0.0)
    assert [e.steps for e in process.elements if isinstance(e, ForcedFlow)] == [(1.5e-6,)] * 2
    assert process.sampling_period == 1.0
    assert process.nominal_outputs == {}
    assert process.path is None
    assert len({s.identifier for s in process.parameters}) == len(process.parameters) == 21
    with pytest.raises(KeyError):
        process.signal("tank_5.level")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("quadruple-tank", [3.33, 3.35, 0.70, 0.60, 3.0]),
        ("quadruple-tank-nonminimum-phase", [3.14, 3.29, 0.43, 0.34, 3.15]),
    ],
)
def test_what_the_reader_sees_is_what_the_file_says(name: str, expected: list[float]) -> None:
    process = load_process(name)
    names = ["pump_1.gain", "pump_2.gain", "splitter_1.tank_1", "splitter_2.tank_2", "pump_1"]
    signals = [process.signal(name) for name in names]
    assert [from_si(s.initial, s.unit, s.shown_unit) for s in signals] == expected
    for i, (area, outlet) in enumerate([(28.0, 0.071), (32.0, 0.057)] * 2, 1):
        tank, hole = process.signal(f"tank_{i}.area"), process.signal(f"outlet_{i}.area")
        assert from_si(tank.initial, "m^2", tank.shown_unit) == area
        assert from_si(hole.initial, "m^2", hole.shown_unit) == outlet


def test_operating_point_by_outputs(tmp_path: Path) -> None:
    edit = ('nominal = "3 V"', '[operating_point]\nlevel_2 = "20 mm"')
    process = read(tmp_path, edit)
    assert process.nominal_outputs == {"level_2": 0.02}
    # Without a nominal voltage a search begins in the middle of the range.
    assert process.inputs[0].initial == 5.0


def test_any_unit_of_the_right_kind(tmp_path: Path) -> None:
    first = read(tmp_path)
    second = read(
        tmp_path,
        ('area = "28 cm^2"', 'area = "0.0028 m²"'),
        ('height = "20 cm"', 'height = "0.2 m"'),
        ("tank_1 = 0.7", 'tank_1 = "70%"'),
        ('gravity = "9.81 m/s^2"\n', ""),
        ('"1 s"', '"1000ms"'),
        ('gain = "0.5 V/cm"', 'gain = "50 mV/mm"'),
    )
    assert list(first.parameter_values) == list(second.parameter_values)
    assert first.elements == second.elements
    assert second.signal("tank_1.area").display_unit == "m^2"
    assert second.signal("valve.tank_1").shown_unit == "%"
    assert second.sampling_period == 1.0
    tank = next(e for e in second.elements if isinstance(e, Tank))
    assert tank.vessel == Prism(0.2, area=0.0028)


def test_integrating_tank_is_allowed(tmp_path: Path) -> None:
    outlet = VALID[VALID.index("[orifices.outlet_1]") : VALID.index("[orifices.outlet_2]")]
    process = read(tmp_path, (outlet, ""))
    level, voltage = [0.1, 0.1], [3.0]
    rate = process.dynamics(level, voltage, [0.0], process.parameter_values)
    assert float(rate[0]) > 0.0


@pytest.mark.parametrize(
    ("line", "gravity"),
    [("9.81 m/s^2", 9.81), ("162 cm/s^2", 1.62), ("9.83 N/kg", 9.83)],
)
def test_outlets_and_pumps_add_up(tmp_path: Path, line: str, gravity: float) -> None:
    """The file's own numbers, by hand: tank 2 falls through outlet 2 into tank 1."""
    process = read(tmp_path, ("9.81 m/s^2", line))
    h1, h2, v, d = 0.08, 0.05, 4.0, 1e-6
    out_1 = 0.071e-4 * (2 * gravity * h1) ** 0.5
    out_2 = 0.9 * 0.057e-4 * (2 * gravity * h2) ** 0.5
    pumped = 3.33e-6 * v
    rate = process.dynamics([h1, h2], [v], [d], process.parameter_values)
    assert float(rate[0]) == pytest.approx((out_2 + 0.7 * pumped - out_1) / 28e-4, rel=1e-13)
    assert float(rate[1]) == pytest.approx((0.3 * pumped + d - out_2) / 32e-4, rel=1e-13)
