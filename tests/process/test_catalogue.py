"""The catalogue: every process in every variant, and the figures that its comments state."""

from __future__ import annotations

import math
import tomllib
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.reader import load_process


def every_process() -> list[str]:
    """Return every process of the catalogue, and every process with each of its variants."""
    names = []
    for name in catalogue_names():
        tables = tomllib.loads(catalogue_file(name).read_text("utf-8"))
        names += [name, *(f"{name}:{variant}" for variant in tables.get("variants", {}))]
    return [*names, "laboratory-four-tanks:fitted,volts"]


PROCESSES = every_process()
process_of = cache(load_process)


@cache
def point_of(name: str) -> OperatingPoint:
    return find_equilibrium(process_of(name))


def test_names() -> None:
    assert catalogue_names() == [
        "averaging-tank",
        "eight-tanks",
        "equalisation-tank",
        "laboratory-four-tanks",
        "laboratory-four-tanks-nonminimum-phase",
        "quadruple-tank",
        "quadruple-tank-nonminimum-phase",
        "three-tanks",
        "wet-well",
    ]
    assert len(PROCESSES) == 9 + 3 + 2 + 4 + 3 + 2 + 3 + 1 + 1


@pytest.mark.parametrize("name", catalogue_names())
def test_what_every_file_says_of_itself(name: str) -> None:
    process = process_of(name)
    assert process.name == name
    assert process.source != "not given"
    assert all(process.variants.values())
    others = {process_of(other).title for other in catalogue_names() if other != name}
    assert process.title not in others


@pytest.mark.parametrize("name", PROCESSES)
def test_equilibrium(name: str) -> None:
    """Every process rests at its operating point, within all ranges."""
    process = process_of(name)
    point = point_of(name)
    # A relief valve is there to be nearly shut.
    told = [each for each in point.warnings if not each.startswith("relief rests at 1.8")]
    assert not told
    rate = process.dynamics(point.state, point.inputs, point.disturbances, process.parameter_values)
    # The fastest of these plants moves through its range within seconds.
    for signal, slope in zip(process.state, np.asarray(rate).ravel(), strict=True):
        assert abs(slope) < 1e-12 * (signal.high - signal.low)
    for signals, values in (
        (process.state, point.state),
        (process.inputs, point.inputs),
        (process.measurements, point.measurements),
    ):
        for signal, value in zip(signals, values, strict=True):
            assert signal.low <= value <= signal.high
    for signal in process.inputs:
        assert signal.low < point.as_dict()[signal.name] < signal.high


@pytest.mark.parametrize("name", PROCESSES)
def test_linear_model_equals_differences(name: str) -> None:
    process, point = process_of(name), point_of(name)
    model = linearise(point)
    place = [np.asarray(v, float) for v in (point.state, point.inputs, point.disturbances)]
    groups = (process.state, process.inputs, process.disturbances)

    def rates(*arguments: np.ndarray) -> np.ndarray:
        return np.asarray(process.dynamics(*arguments, process.parameter_values)).ravel()

    for argument, matrix in enumerate((model.A, model.B, model.E)):
        for column, signal in enumerate(groups[argument]):
            slopes = []
            for share in (1e-3, 5e-4):  # central differences, extrapolated to order four
                step = share * max(abs(place[argument][column]), 1e-2 * signal.high)
                ahead, behind = [v.copy() for v in place], [v.copy() for v in place]
                ahead[argument][column] += step
                behind[argument][column] -= step
                slopes.append((rates(*ahead) - rates(*behind)) / (2 * step))
            expected = (4 * slopes[1] - slopes[0]) / 3
            np.testing.assert_allclose(
                matrix[:, column], expected, rtol=1e-7, atol=1e-8 * np.abs(matrix).max()
            )


def test_all_inputs_of_the_averaging_tank() -> None:
    process = process_of("averaging-tank:all-inputs")
    assert [signal.name for signal in process.inputs] == ["inflow", "outflow", "inflow.impurity"]
    assert process.disturbances == ()


def test_the_laboratory_counts_in_percent_or_in_volts() -> None:
    """One process in two units: the same levels, and a loop gain that differs by the scales."""
    percent = process_of("laboratory-four-tanks:fitted,percent")
    volts = process_of("laboratory-four-tanks:fitted,volts")
    assert process_of("laboratory-four-tanks").variant == ("report", "percent")
    one, other = (find_equilibrium(process) for process in (percent, volts))
    np.testing.assert_allclose(one.state, other.state, rtol=1e-12)
    np.testing.assert_allclose(15 * one.inputs, other.inputs, rtol=1e-12)
    # 100 % are 25 cm, and 0.2 V are 1 cm: 100 % are 5 V.
    np.testing.assert_allclose(5 * one.measurements, other.measurements, rtol=1e-12)


def test_the_laboratory_trips_at_110_percent() -> None:
    process = process_of("laboratory-four-tanks")
    events = [event.words for event in process.motion.events if "trips" in event.words]
    assert events == [
        f"pump_{pump} trips: tank_{tank} above 27.5 cm" for pump in (1, 2) for tank in (1, 2, 3, 4)
    ]
    assert process.noise == {"pump_1.noise": 0.1, "pump_2.noise": 0.1}


# Hourly means from midnight, l/s and g/m³: the example that equalisation-tank.toml cites.
INFLOW = [275, 221, 164, 130, 105, 99, 119, 204, 354, 411, 425, 430,
          425, 405, 385, 351, 326, 326, 328, 365, 399, 399, 379, 345]  # fmt: skip
STRENGTH = [150, 115, 75, 50, 45, 60, 90, 130, 175, 200, 215, 220,
            220, 210, 200, 190, 180, 170, 175, 210, 280, 305, 245, 180]  # fmt: skip


def test_the_equalisation_basin_holds_a_day() -> None:
    inflow, strength = np.array(INFLOW) / 1000, np.array(STRENGTH) / 1000
    mean = inflow.mean()
    held = np.concatenate([[0.0], np.cumsum((inflow - mean) * 3600)])
    needed = held.max() - held.min()
    assert needed == pytest.approx(4100, abs=50)
    process = load_process("equalisation-tank")
    capacity = process.signal("basin.area").initial * process.signal("basin.level").high
    assert 1.2 * needed < capacity < 1.25 * needed
    assert process.signal("inflow").initial == pytest.approx(mean, abs=0.0005)
    assert process.signal("inflow.bod").initial == pytest.approx(
        (inflow * strength).sum() / inflow.sum(), abs=0.0005
    )
    assert process.signal("inflow").high > inflow.max()
    assert process.signal("inflow.bod").high > strength.max()


def head_of_the_pump(flow: float, speed: float) -> float:
    """The curve of wet-well.toml by the affinity laws, straight in the square of the flow [m]."""
    flows, heads = np.array([0.0, 0.030, 0.050]), [22.0, 17.0, 9.0]
    return speed**2 * float(np.interp((flow / speed) ** 2, flows**2, heads))


def test_the_wet_well_lifts_what_its_comments_say() -> None:
    process = load_process("wet-well")
    pipe = 8 * 0.02 * 300 / (math.pi**2 * 9.81 * 0.2**5)
    valve = 1e5 / (1000 * 9.81) / (200 / 3600) ** 2
    assert process.signal("duty.pipe_loss").initial == pytest.approx(pipe + valve, abs=30)

    def excess(flow: float, speed: float) -> float:
        return head_of_the_pump(flow, speed) - (8.0 - 1.5) - 4850 * flow**2

    full = brentq(excess, 1e-3, 0.049, args=(1.0,), xtol=1e-12)
    assert round(full * 1000) == 39
    speed = brentq(lambda n: excess(0.020, n), 0.5, 1.0, xtol=1e-12)
    assert round(speed, 2) == 0.70
    point = find_equilibrium(process)
    assert point.as_dict()["duty"] == pytest.approx(speed, rel=1e-9)
    disturbances = [signal.initial for signal in process.disturbances]
    at_full_speed = process.dynamics([1.5, 1.0, 0.0], [1.0], disturbances, process.parameter_values)
    assert 12.0 * float(at_full_speed[0]) == pytest.approx(0.020 - full, rel=1e-9)
