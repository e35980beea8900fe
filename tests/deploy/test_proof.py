"""The proof in small: engine, C and Structured Text of one controller, equal in every bit."""

import numpy as np
import pytest
from deployed import no_output_lay_idle, prints_its_numbers, run_alike, spoilt
from plants import designed, plant

from clepsydra import PidForm, program_of
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.program.defaults import with_defaults
from clepsydra.program.program import Program
from clepsydra.studies.designs import DESIGNS

SCANS = 10_000
STATUS_BITS = (1, 2, 4, 8, 16, 32, 64)


def held(random: np.random.Generator, values: list[float], chance: list[float]) -> np.ndarray:
    """A signal that keeps a value for some 25 scans, so that the law settles and saturates."""
    blocks = random.choice(values, size=SCANS // 25, p=chance)
    return np.repeat(blocks, 25)


def scans(program: Program, seed: int) -> dict[str, np.ndarray]:
    """Ten thousand scans of a plant that goes wrong in every way the inputs can express."""
    random = np.random.default_rng(seed)
    inputs = {}
    for signal in program.inputs:
        name = signal.name
        if signal.part == "sp":
            inputs[name] = spoilt(random, np.repeat(random.uniform(2, 8, SCANS // 50), 50), 0.02)
        elif signal.part == "pv":
            walk = 5 + np.cumsum(random.normal(scale=0.05, size=SCANS)) % 4
            inputs[name] = spoilt(random, walk, 0.03)
        elif signal.part == "good":
            inputs[name] = (random.random(SCANS) < 0.95).astype(float)
        elif signal.part == "mode":
            inputs[name] = held(random, [0.0, 1.0, 2.0, 3.0], [0.15, 0.65, 0.15, 0.05])
        elif name == "time_step":
            steps = random.choice([1.0, 0.1, 1 / 3], size=SCANS)
            places = random.random(SCANS) < 0.02
            steps[places] = random.choice([0.0, -1.0, np.nan, np.inf], size=int(places.sum()))
            inputs[name] = steps
        else:
            inputs[name] = spoilt(random, random.uniform(-2, 12, SCANS), 0.02)
    return inputs


def proven(program: Program, folder, seed: int) -> None:
    inputs = scans(program, seed)
    no_output_lay_idle(program, run_alike(program, folder, inputs), STATUS_BITS)


@pytest.mark.parametrize(
    "anti_windup",
    [
        "back_calculation",
        pytest.param("conditional_integration", marks=pytest.mark.thorough),
        pytest.param("clamping", marks=pytest.mark.thorough),
        pytest.param("none", marks=pytest.mark.thorough),
    ],
)
def test_pi_is_the_same_in_engine_c_and_structured_text(anti_windup, tmp_path):
    program = program_of(
        multiloop_pid_law(
            ["level_1", "level_2"], ["pump_1", "pump_2"], PidForm(anti_windup=anti_windup)
        )
    )
    values = {
        "level_1.proportional_gain": 2.7, "level_1.integral_time": 31.0,
        "level_1.setpoint_weight": 0.7,
        "level_2.proportional_gain": -1.3, "level_2.integral_time": 77.7, "pump_2.low_limit": -1.0,
        "pump_1.high_limit": 10.0, "pump_2.high_limit": 9.0, "pump_1.last_output": 3.0,
        "level_1.integral": 3.0,
    }  # fmt: skip
    proven(with_defaults(program, values), tmp_path, seed=1)


def test_lqi_is_the_same_in_engine_c_and_structured_text(tmp_path):
    program = designed("lqi", "quadruple-tank").program()
    random = np.random.default_rng(5)
    values = {
        signal.name: float(random.normal())
        for signal in program.parameters
        if "feedback" in signal.name or "integral_gain" in signal.name
    }
    for pump in ("pump_1", "pump_2"):
        values |= {f"{pump}.high_limit": 10.0, f"{pump}.bias": 3.1}
    proven(with_defaults(program, values), tmp_path, seed=2)


#: One design of each law that is proved here.
DESIGNED = (
    "PI, SIMC, dynamic decoupling", "PID, phase margin", "LQI with Kalman filter",
    "LQR with precompensator",
)  # fmt: skip


@pytest.mark.parametrize(
    "name", ["PI, SIMC", *(pytest.param(name, marks=pytest.mark.thorough) for name in DESIGNED)]
)
def test_a_designed_controller_is_the_same_in_engine_c_and_structured_text(name, tmp_path):
    """What is printed is the controller that was designed, with its numbers.

    Its initial state goes to the instances of its blocks; the first scans of the proof see it.
    """
    controller = DESIGNS[name](plant("quadruple-tank").analysis)
    prints_its_numbers(controller)
    proven(controller.program(), tmp_path, seed=3)
