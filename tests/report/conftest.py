"""A study built by hand: Johansson's four tanks under two PI controllers, simulated in NumPy."""

from __future__ import annotations

import re

import numpy as np
import pytest

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import multiloop_pid_law
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.studies.result import Candidate, Standing, StudyResult
from clepsydra.studies.tuning.pareto import ParetoFront
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.warnings.loop_response import loop_response

PROCESS = load_process("quadruple-tank")
AREAS = np.array([28e-4, 32e-4, 28e-4, 32e-4])
OUTLETS = np.array([0.071e-4, 0.057e-4, 0.071e-4, 0.057e-4])
GAINS = (3.33e-6, 3.35e-6)
FRACTIONS = (0.7, 0.6)
SENSOR_GAIN = 50.0  # V/m
GRAVITY = 9.81


def rates(level: np.ndarray, volts: np.ndarray, inflow: np.ndarray) -> np.ndarray:
    """Johansson's four differential equations, m/s."""
    out = OUTLETS * np.sqrt(2 * GRAVITY * np.maximum(level, 0.0))
    pumped = np.array(GAINS) * volts
    received = np.array(
        [
            out[2] + FRACTIONS[0] * pumped[0] + inflow[0],
            out[3] + FRACTIONS[1] * pumped[1] + inflow[1],
            (1 - FRACTIONS[1]) * pumped[1],
            (1 - FRACTIONS[0]) * pumped[0],
        ]
    )
    return (received - out) / AREAS


def scenario(point: OperatingPoint) -> Scenario:
    stretch = 400
    segments = []
    setpoints = np.tile(point.measurements[:2], (7 * stretch, 1))
    disturbances = np.zeros((7 * stretch, 2))
    noise = np.zeros((7 * stretch, 4))
    steps = [("level_1", 1.0), ("level_1", -1.0), ("level_2", 1.0), ("level_2", -1.0)]
    for place, (name, size) in enumerate(steps):
        start = place * stretch
        segments.append(Segment("setpoint", name, start, start + stretch, size))
        if size > 0:
            setpoints[start : start + stretch, int(name[-1]) - 1] += size
    for place, name in enumerate(("inflow_1", "inflow_2"), start=4):
        start = place * stretch
        segments.append(Segment("load", name, start, start + stretch, 2e-6))
        disturbances[start : start + stretch, place - 4] = 2e-6
    segments.append(Segment("noise", "", 6 * stretch, 7 * stretch, 0.0))
    noise[6 * stretch :] = np.random.default_rng(7).normal(0.0, 0.05, (stretch, 4))
    return Scenario(1.0, setpoints, disturbances, noise, tuple(segments), seed=7)


def controller(name: str, gains: tuple[float, float], times: tuple[float, float]) -> Controller:
    law = multiloop_pid_law(
        2,
        measured=[PROCESS.signal(f"level_{i}") for i in (1, 2)],
        manipulated=[PROCESS.signal(f"pump_{i}") for i in (1, 2)],
    )
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    values |= {f"proportional_gain_{i}": gains[i - 1] for i in (1, 2)}
    values |= {
        f"{what}_time_{i}": times[i - 1] for what in ("integral", "tracking") for i in (1, 2)
    }
    state = {signal.name: signal.initial for signal in law.state}
    state |= {f"{what}_{i}": 3.0 for what in ("integral", "last_output") for i in (1, 2)}
    state |= {f"last_proportional_gain_{i}": gains[i - 1] for i in (1, 2)}
    return Controller(
        name=name,
        family="multiloop PI",
        design=f"Gains {gains[0]:g} and {gains[1]:g}, integral times {times[0]:g} s and "
        f"{times[1]:g} s, chosen by hand.",
        law=law,
        values=values,
        initial_state=state,
        measurements=("level_1", "level_2"),
        setpoints=("level_1", "level_2"),
        manipulated=("pump_1", "pump_2"),
        notes=("The pairing follows the relative gain array.",),
    )


def simulate(process: Process, point: OperatingPoint, law: Controller, plan: Scenario) -> Run:
    """Sampled PI with conditional integration on the nonlinear tanks, Euler steps of 0.2 s."""
    gains = np.array([law.values[f"proportional_gain_{i}"] for i in (1, 2)])
    times = np.array([law.values[f"integral_time_{i}"] for i in (1, 2)])
    level, integral = point.state.copy(), point.inputs.copy()
    levels, measured, volts = [], [], []
    for sample in range(plan.samples):
        reading = SENSOR_GAIN * level + plan.noise[sample]
        error = plan.setpoints[sample] - reading[:2]
        wanted = integral + gains * error
        output = np.clip(wanted, 0.0, 10.0)
        integral = integral + np.where(output == wanted, gains / times * error, 0.0)
        levels.append(level.copy())
        measured.append(reading)
        volts.append(output)
        for _ in range(5):
            level = level + 0.2 * rates(level, output, plan.disturbances[sample])
    columns: dict[str, np.ndarray] = {}
    for signals, table in (
        (process.state, levels),
        (process.measurements, measured),
        (process.inputs, volts),
        (process.disturbances, plan.disturbances),
    ):
        columns |= {signal.name: np.array(table)[:, place] for place, signal in enumerate(signals)}
    for signal in process.inputs:
        low, high = (columns[signal.name] == limit for limit in (signal.low, signal.high))
        columns[f"{signal.name}.status"] = 1.0 + 4.0 * low + 8.0 * high
    for place, name in enumerate(process.controlled):
        columns[f"{name}.setpoint"] = plan.setpoints[:, place]
    signals = (*process.state, *process.measurements, *process.inputs, *process.disturbances)
    return Run(process, law, plan, plan.time, signals, columns, 3.2e-9, 5)


def scores_of(run: Run) -> dict[str, float]:
    found: dict[str, float] = {}
    for name in run.process.controlled:
        error = (
            run.values[f"{name}.setpoint"]
            - SENSOR_GAIN * run.values[run.process.measured_state[name]]
        )
        found[f"iae[{name}]"] = float(np.abs(error).sum())
        found[f"settling_time_noisy[{name}]"] = 90.0
        found[f"ise[{name}]"] = float((error**2).sum())
        found[f"overshoot[{name}]"] = 12.5
        found[f"rise_time[{name}]"] = 21.0
        found[f"settling_time[{name}]"] = 140.0
        found[f"peak_deviation[{name}]"] = 0.21
    for name in ("pump_1", "pump_2"):
        volts = run.values[name]
        found[f"total_variation[{name}]"] = float(np.abs(np.diff(volts)).sum())
        found[f"time_in_saturation[{name}]"] = float(((volts <= 0) | (volts >= 10)).sum())
    return found


def tuning_of(law: Controller, start: dict[str, float], found: dict[str, float]) -> TuningResult:
    """A tuning whose front has three points, the chosen one last."""
    front = ParetoFront(np.array([1.2, 1.4, 1.62]), np.array([0.9, 0.7, 0.55]), {})
    return TuningResult(
        controller=law,
        objective=0.55,
        start_objective=1.0,
        scores=found,
        start_scores=start,
        maximum_sensitivity=1.62,
        start_maximum_sensitivity=1.3,
        binding=("total variation of pump_1 at most 200",),
        evaluations=321,
        history=np.array([[1.0, 1.0], [321.0, 0.55]]),
        front=front,
        seed=1,
        interrupted=False,
        tuned={},
    )


def build_study(analysis: Analysis) -> StudyResult:
    point = analysis.operating_point
    process = point.process
    plan = scenario(point)
    laws = [
        controller("PI, phase margin", (3.0, 2.7), (30.0, 40.0)),
        controller("PI, <SIMC> & detuned", (12.0, 9.0), (62.0, 90.0)),
    ]
    runs = [simulate(process, point, law, plan) for law in laws]
    model = linearise(point)
    tuning = tuning_of(laws[0], {"iae[level_1]": 50.0}, {"iae[level_1]": 30.0})
    candidates = tuple(
        Candidate(
            controller=law,
            run=run,
            scores=scores_of(run),
            maximum_sensitivity=1.62 + 0.3 * place,
            standing=Standing.ROBUST,
            mean_error=1.0 + 0.2 * place,
            rank=place + 1,
            reason=(
                "Smallest error of all, and it leaves the pumps away from their limits.",
                "Faster, but its pumps reach their limits after each step.",
            )[place],
            warnings=() if place == 0 else ("pump_1 stood at its limit after setpoint steps.",),
            criteria={"setpoint error": 1.0 + 0.1 * place, "load error": 1.0 + 0.3 * place},
            wear=1.0 + 11.5 * place,
            response=loop_response(law, model),
            tuning=None if place else tuning,
        )
        for place, (law, run) in enumerate(zip(laws, runs, strict=True))
    )
    return StudyResult(
        process=process,
        analysis=analysis,
        scenario=plan,
        ranking=candidates,
        not_applicable=(("Smith predictor", "the process has no dead time"),),
        verdict="PI, phase margin holds both levels best: worst error integral 3 % s, "
        "maximum sensitivity 1.62, no warning.",
        warnings=("The upper tanks are measured but not controlled.",),
    )


@pytest.fixture(scope="session")
def process() -> Process:
    return load_process("quadruple-tank")


@pytest.fixture(scope="session")
def result(process: Process) -> StudyResult:
    return build_study(analyse(process))


@pytest.fixture(scope="session")
def run(result: StudyResult) -> Run:
    """The run that reaches the limits of its pumps."""
    return result.ranking[1].run


def path_points(data: str) -> np.ndarray:
    """The points of a path written with M, l, h and v, in points."""
    found, here = [], np.zeros(2)
    for command, words in re.findall(r"([Mlhv])([^Mlhv]*)", data):
        numbers = [int(word) for word in re.findall(r"-?\d+", words)]
        if command == "M":
            here = np.array(numbers, float)
            found.append(here.copy())
        elif command == "l":
            for move in np.reshape(numbers, (-1, 2)):
                here = here + move
                found.append(here.copy())
        else:
            (length,) = numbers
            here = here + (np.array([length, 0]) if command == "h" else np.array([0, length]))
            found.append(here.copy())
    return np.array(found) / 10.0


@pytest.fixture(scope="session")
def points_of():
    return path_points
