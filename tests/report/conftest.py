"""A study of Johansson's four tanks under two PI controllers, judged by hand."""

import re
from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.studies.result import Remark, Standing

SENSOR_GAIN = 50.0  # V/m
#: K [%/%] and Ti [s] of both loops, of which the second set moves pumps to their limits.
SETTINGS = {
    "PI, phase margin": ((3.0, 30.0), (2.7, 40.0)),
    "PI, <SIMC> & detuned": ((12.0, 62.0), (9.0, 90.0)),
}


def scores_of(run):
    found = {}
    for name in run.process.controlled:
        level = run.values[run.process.measured_state[name]]
        error = run.values[f"{name}.setpoint"] - SENSOR_GAIN * level
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


def tuning_of(controller, plant):
    """A tuning whose front has three points, the chosen one last."""
    step = [cl.step("level_1", "0.5 V", at=10)]
    bounds = {"level_1": {"K": (2.5, 3.5)}}
    found = cl.tune(controller, plant, parameters=bounds, events=step, duration=20).tuning
    front = replace(
        found.front,
        sensitivity=np.array([1.2, 1.4, 1.62]),
        objective=np.array([0.9, 0.7, 0.55]),
    )
    return replace(
        found,
        objective=0.55,
        start_objective=1.0,
        start_scores={"iae[level_1]": 50.0},
        scores={"iae[level_1]": 30.0},
        maximum_sensitivity=1.62,
        start_maximum_sensitivity=1.3,
        binding=("total variation of pump_1 at most 200",),
        front=front,
    )


def judged(candidate, place, tuning):
    return replace(
        candidate,
        run=replace(candidate.run, error_estimate=3.2e-9),
        scores=scores_of(candidate.run),
        maximum_sensitivity=1.62 + 0.3 * place,
        standing=Standing.ROBUST,
        mean_error=1.0 + 0.2 * place,
        relative_error=1.0 + 0.2 * place,
        rank=place + 1,
        reason=(
            "Smallest error of all, and it leaves the pumps away from their limits.",
            "Faster, but its pumps reach their limits after each step.",
        )[place],
        warnings=() if place == 0 else (Remark("pump_1 stood at its limit after setpoint steps"),),
        criteria={"setpoint error": 1.0 + 0.1 * place, "load error": 1.0 + 0.3 * place},
        wear=1.0 + 11.5 * place,
        tuning=None if place else tuning,
    )


def build_study():
    plant = cl.load("quadruple-tank")
    pi = cl.design.simc(plant)
    controllers = []
    for name, loops in SETTINGS.items():
        settings = {
            f"level_{place}": {"K": gain, "Ti": time}
            for place, (gain, time) in enumerate(loops, start=1)
        }
        controllers.append(pi.with_values(settings, name=name))
    found = cl.study(plant, controllers, seed=7)
    tuning = tuning_of(controllers[0], plant)
    return replace(
        found,
        ranking=tuple(
            judged(found[each.name], place, tuning) for place, each in enumerate(controllers)
        ),
        not_applicable=(("Smith predictor", "the process has no dead time"),),
        verdict="PI, phase margin holds both levels best: worst error integral 3 % s, "
        "maximum sensitivity 1.62, no warning.",
        warnings=(Remark("The upper tanks are measured but not controlled"),),
    )


@pytest.fixture(scope="session")
def result():
    return build_study()


@pytest.fixture(scope="session")
def process(result):
    return result.process


@pytest.fixture(scope="session")
def run(result):
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
