"""The compiled kernel against CVODES and DOP853, with the same switches and delays."""

from dataclasses import replace

import numpy as np
import pytest
from written_plants import plant_of

from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.open_loop import simulate
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process

VARIANTS = (
    "averaging-tank:inflow-constant",
    "averaging-tank:all-inputs",
    "eight-tanks:corrected",
    "laboratory-four-tanks:report,volts",
    "three-tanks:corrected",
)
OTHERS = (name for name in (*catalogue_names(), *VARIANTS) if name != "three-tanks")
PROCESSES = ("three-tanks", *(pytest.param(name, marks=pytest.mark.thorough) for name in OTHERS))


def beginnings(scenario, samples):
    """Return the first samples of the rest and of every segment of a scenario, end to end.

    The loop comes to each change from where the last one has left it.
    """
    period = scenario.sampling_period
    starts = [0, *(round(segment.start / period) for segment in scenario.segments)]
    ends = [*starts[1:], scenario.samples]
    chosen = [np.arange(a, min(a + samples, b)) for a, b in zip(starts, ends, strict=True)]
    rows = np.concatenate(chosen)
    borders = period * np.cumsum([len(part) for part in chosen])
    segments = tuple(
        replace(segment, start=float(start), stop=float(stop))
        for segment, start, stop in zip(scenario.segments, borders[:-1], borders[1:], strict=True)
    )
    return replace(
        scenario,
        setpoints=scenario.setpoints[rows],
        disturbances=scenario.disturbances[rows],
        noise=scenario.noise[rows],
        segments=segments,
    )


def furthest(one, other, signals=None):
    """Return the largest difference of two runs, as a fraction of each state's range."""
    return max(
        np.max(np.abs(one.values[s.name] - other.values[s.name])) / s.span
        for s in signals or one.process.state
    )


@pytest.mark.parametrize("name", PROCESSES)
def test_kernel_and_reference_agree_in_the_default_scenario(name):
    """With its noise: a smooth run between the samples, so to a millionth of the range."""
    analysis = analyse(load_process(name))
    scenario = beginnings(default_scenario(analysis.model), 60)
    assert np.ptp(scenario.noise) > 0
    loop = Loop(design_simc(analysis.model, analysis.pairing), analysis.model)
    kernel = loop.run_checked(scenario)
    reference = loop.run(scenario, solver="reference", substeps=1)
    assert kernel.error_estimate < 1e-6
    assert 0 < furthest(kernel, reference) < 1e-6
    moved = [np.ptp(kernel.values[u.name]) / u.span for u in loop.process.inputs]
    assert max(moved) > 1e-3
    for event, *_ in loop.process.motion.events:
        count = f"{event}.count"
        assert np.array_equal(kernel.values[count], reference.values[count])


def compare(point, profiles, substeps, state=None, reference_steps=None):
    """Return the open-loop run of the kernel after the whole comparison with the reference.

    Switches agree in number, order and time; states to 1e-4 of their range and levels to
    1e-5 of theirs throughout, all to 1e-6 until the first switch; volumes spilt to 1e-4.
    """
    kernel = simulate(point, profiles, substeps=substeps, state=state)
    reference = simulate(
        point, profiles, substeps=reference_steps or substeps, state=state, solver="reference"
    )
    one, other = kernel.events, reference.events
    step = point.process.sampling_period / substeps
    assert [(h.event, h.times) for h in one] == [(h.event, h.times) for h in other]
    late = [abs(a.time - b.time) for a, b in zip(one, other, strict=True)]
    assert max(late) < 0.01 * step
    assert furthest(kernel, reference) < 1e-4
    levels = [s for s in point.process.state if s.name.endswith(".level")]
    assert furthest(kernel, reference, levels) < 1e-5
    for name in kernel.values:
        if name.endswith(".spilt"):
            spilt = reference.values[name][-1]
            assert spilt > 0
            assert abs(kernel.values[name][-1] - spilt) < 1e-4 * spilt
    for run in (kernel, reference):
        for balance in run.balances:
            assert balance.error < 1e-11
    before = kernel.time < one[0].time
    for signal in point.process.state:
        difference = np.abs(kernel.values[signal.name] - reference.values[signal.name])[before]
        assert np.max(difference) < 1e-6 * signal.span
    return kernel


@pytest.mark.thorough
def test_a_station_that_starts_stops_and_spills():
    """The wet well in a storm, with its duty pump at standstill, and the dry hours after it."""
    point = find_equilibrium(load_process("wet-well"))
    inflow, duty = np.full(900, 80e-3), np.zeros(900)
    inflow[320:], duty[320:] = 4e-3, 0.8
    kernel = compare(point, {"inflow": inflow, "duty": duty}, 160, {"well.level": 2.45}, 4)
    happened = {event.event for event in kernel.events}
    assert happened >= {"standby.starts", "standby.stops", "duty.stops"}


@pytest.mark.thorough
@pytest.mark.parametrize("variant", ["fitted", "report"])
def test_a_laboratory_whose_pumps_trip(variant):
    """Both pumps at full voltage until the upper tanks are nearly full, again and again."""
    point = find_equilibrium(load_process("laboratory-four-tanks", variant))
    process = point.process
    full = {signal.name: np.full(1200, signal.high) for signal in process.inputs}
    for signal in process.inputs:
        full[signal.name][900:] = point.as_dict()[signal.name]
    kernel = compare(point, full, 1)
    happened = {event.event for event in kernel.events}
    assert any("trips" in event for event in happened)
    assert any("released" in event for event in happened)


RIG = """
name = "rig"
title = "A rig with every switch"
gravity = "9.81 m/s^2"
sampling_period = "1 s"
controlled = ["level"]
[components.salt]
range = ["0 kg/m^3", "50 kg/m^3"]
[reservoirs.basin]
concentration = {{ salt = "10 kg/m^3" }}
[tanks.upper]
area = "300 cm^2"
height = "50 cm"
weir = "20 cm"
[tanks.lower]
shape = "cone"
floor_diameter = "15 cm"
rim_diameter = "40 cm"
height = "60 cm"
weir = "30 cm"
[delays.channel]
destination = "lower"
time = "7.5 s"
[pumps.feed]
source = "basin"
destination = "upper"
gain = "100 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "4 V"
lag = "1.5 s"
trip_above = {{ lower = "55 cm" }}
hysteresis = "4 cm"
[pumps.sump]
source = "lower"
destination = "basin"
gain = "150 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "5 V"
lag = "1 s"
start_above = {{ lower = "40 cm" }}
stop_below = {{ lower = "12 cm" }}
running = false
[flows.taken]
source = "upper"
range = ["0 l/s", "2 l/s"]
nominal = "0 l/s"
[valves.throttle]
source = "upper"
destination = "channel"
kv = "9 m^3/h"
characteristic = "equal percentage"
range = ["0 %", "100 %"]
nominal = "60 %"
stroke_time = "60 s"
{friction}
[sensors.level]
tank = "lower"
range = ["0 cm", "60 cm"]
"""


@pytest.mark.thorough
@pytest.mark.parametrize("friction", ['backlash = "6 %"', 'stiction = "5 %"\nslip_jump = "3 %"'])
def test_a_rig_with_every_switch(tmp_path, friction):
    """Trips, level switches, a delay, weirs that spill, an emptied tank, a valve that sticks."""
    process = plant_of(tmp_path, RIG.format(friction=friction)).process
    start = {
        "upper.level": 0.2, "upper.salt": 0.0, "lower.level": 0.35, "lower.salt": 40.0,
        "feed.actual": 4.0, "sump.actual": 0.0, "throttle.position": 0.6,
    }  # fmt: skip
    x = np.array([start[signal.name] for signal in process.state])
    u = np.array([signal.initial for signal in process.inputs])
    d = np.array([signal.initial for signal in process.disturbances])
    y = np.array(process.measure(x, process.parameter_values)).ravel()
    point = OperatingPoint(process, x, u, d, y, residual=np.inf)
    samples = np.arange(400)
    profiles = {
        "feed": np.select([samples < 280, samples < 330], [10.0, 0.0], 6.0),
        "sump": np.where((samples >= 130) & (samples < 270), 0.0, 9.0),
        "throttle": 0.7 + 0.25 * np.sin(2 * np.pi * samples / 60),
        "taken": np.where((samples >= 290) & (samples < 330), 1.5e-3, 0.0),
    }
    kernel = compare(point, profiles, 18)
    happened = {event.event for event in kernel.events}
    assert happened >= {
        "feed.trips_lower_above", "feed.is_released", "sump.starts", "sump.stops",
        "taken.runs_dry",
    }  # fmt: skip
    if "stiction" in friction:
        assert happened >= {
            "throttle.breaks_away_up",
            "throttle.breaks_away_down",
            "throttle.sticks",
        }
