"""Minimax tuning of two PI loops by simulation, beside SciPy as a user would write it.

The averaging tank of M. Kolankowski and R. Piotrowski (2022) with a constant outflow: the inflow
moves the volume, the concentration of the inflow moves the concentration, both by PI control from
the equilibrium, without anti-windup. C steps from 5 to 5.25 kmol/m³ and V from 2 to 2.1 m³ at the
start. The larger of both IAE over 20 s, in kmol s/m³ and m³ s, is minimised over two gains and
two integral times, from the document's constants (80).
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from benchmarks.experiments import Disagreement
from benchmarks.measure import Spread, on_one_core
from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import remembered_parameters
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.process.reader import load_process
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Objective
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import GENERATIONS, Search, tune

T = TypeVar("T")

HORIZON = 20.0  # [s]
PERIODS = (2e-4, 1e-2)  # [s], the document's and a plant's
#: K_C, Ti_C [s], K_V [1/s], Ti_V [s]: equation (80), and the bounds of both ways.
START = np.array([50.0, 1.0, 8.0, 2.0])
LOW = np.array([0.5, 1e-3, 0.08, 1e-2])
HIGH = np.array([500.0, 100.0, 80.0, 1000.0])
VOLUME, CONCENTRATION, FLOW = 2.0, 5.0, 0.2  # [m³], [kmol/m³], [m³/s]
#: Largest relative difference between control sampled at 0.2 ms and continuous control; it is of
#: first order in the period, 2e-3 here and 50 times that at 10 ms.
AGREEMENT = 5e-3
VOLUME_STEP, CONCENTRATION_STEP = 0.1, 0.25
FLOW_LIMIT, CONCENTRATION_LIMIT = 1.0, 25.0


@dataclass(frozen=True)
class Tuned:
    """What one way found.

    Parameters
    ----------
    objective : float
        The larger IAE.
    simulations : int
    seconds : Spread
    """

    objective: float
    simulations: int
    seconds: Spread


@dataclass(frozen=True)
class TuningTimes:
    """All that is measured at one period.

    Parameters
    ----------
    local, whole : Tuned
        Clepsydra without and with the search over all bounds, from the process file to the
        tuned controller; the kernel is compiled in the first round and then read from disk.
    scipy : Tuned
        By SLSQP, each simulation by LSODA; made once.
    one_simulation : Spread
        By LSODA [s].
    """

    local: Tuned
    whole: Tuned
    scipy: Tuned
    one_simulation: Spread


def with_clepsydra(period: float, generations: int) -> Callable[[], TuningResult]:
    """Return a call from the process file to the tuned controller."""

    def run() -> TuningResult:
        process = dataclasses.replace(load_process("averaging-tank"), sampling_period=period)
        point = find_equilibrium(process)
        controlled, moved = ("concentration", "volume"), ("inflow.impurity", "inflow")
        law = multiloop_pid_law(controlled, moved, PidForm(anti_windup="none"))
        settings = ("proportional_gain", "integral_time")
        names = [path(y, setting) for y in controlled for setting in settings]
        values = dict(zip(names, START.tolist(), strict=True))
        values |= {path(y, "setpoint_weight"): 1.0 for y in controlled}
        limits, resting = (1e3 * CONCENTRATION_LIMIT, FLOW_LIMIT), (1e3 * CONCENTRATION, FLOW)
        for u, limit in zip(moved, limits, strict=True):
            values |= {path(u, "low_limit"): 0.0, path(u, "high_limit"): limit}
        rest = dict(zip(controlled + moved, resting * 2, strict=True))
        state = {s.name: rest[s.owner] for s in law.state}
        controller = Controller(
            "PI", "multiloop PI", "The document's constants (80).", law, values,
            state | remembered_parameters(law, values), controlled, controlled, moved,
        )  # fmt: skip
        ends = zip(names, LOW.tolist(), HIGH.tolist(), strict=True)
        space = LawSpace(controller, [TunedParameter(*each) for each in ends])
        weights = {"iae[concentration]": 1e-3, "iae[volume]": 1.0}
        objective = Objective("minimax", weights, relative=False)
        goal = Goal(linearise(point), step(period), objective)
        return tune(space, goal, Search(generations=generations))

    return run


def step(period: float) -> Scenario:
    """Return the document's step, at the first sample."""
    samples = round(HORIZON / period) + 1
    target = [1e3 * (CONCENTRATION + CONCENTRATION_STEP), VOLUME + VOLUME_STEP]
    return Scenario(
        period,
        np.tile(target, (samples, 1)),
        np.full((samples, 1), FLOW),
        np.zeros((samples, 2)),
        (Segment("setpoint", "volume", 0.0, samples * period, VOLUME_STEP),),
        seed=1,
    )


def simulate_with_scipy(settings: np.ndarray, period: float) -> np.ndarray:
    """Return IAE of C [kmol s/m³] and of V [m³ s], the equations and the IAE by LSODA."""
    from scipy.integrate import solve_ivp

    gain_c, time_c, gain_v, time_v = settings.tolist()
    target_c, target_v = CONCENTRATION + CONCENTRATION_STEP, VOLUME + VOLUME_STEP

    def slope(t: float, x: np.ndarray) -> list[float]:
        volume, concentration, integral_c, integral_v, _, _ = x.tolist()
        error_c, error_v = target_c - concentration, target_v - volume
        inlet = CONCENTRATION + gain_c * (error_c + integral_c / time_c)
        flow = FLOW + gain_v * (error_v + integral_v / time_v)
        inlet = min(max(inlet, 0.0), CONCENTRATION_LIMIT)
        flow = min(max(flow, 0.0), FLOW_LIMIT)
        return [
            flow - FLOW,
            flow * (inlet - concentration) / volume,
            error_c,
            error_v,
            abs(error_c),
            abs(error_v),
        ]

    start = [VOLUME, CONCENTRATION, 0.0, 0.0, 0.0, 0.0]
    found = solve_ivp(slope, (0.0, HORIZON), start, method="LSODA", max_step=period)
    return np.array(found.y[4:, -1])


def with_scipy(period: float) -> tuple[float, int]:
    """Tune by SLSQP in epigraph form with its own differences; objective and simulations."""
    from scipy.optimize import minimize

    known: dict[bytes, np.ndarray] = {}

    def scores(logarithms: np.ndarray) -> np.ndarray:
        key = logarithms.tobytes()
        if key not in known:
            known[key] = simulate_with_scipy(np.exp(logarithms), period)
        return known[key]

    scale = float(np.max(scores(np.log(START))))
    found = minimize(
        lambda x: x[-1],
        np.append(np.log(START), 1.0),
        bounds=[*zip(np.log(LOW), np.log(HIGH), strict=True), (None, None)],
        constraints=[{"type": "ineq", "fun": lambda x: x[-1] - scores(x[:-1]) / scale}],
        method="SLSQP",
    )
    return float(np.max(scores(found.x[:-1]))), len(known)


def measure(rounds: int) -> dict[float, TuningTimes]:
    """Measure all ways at both periods on one core; SciPy's tuning once, since it is long."""
    found = {}
    with on_one_core():
        for period in PERIODS:
            ways = []
            for generations in (0, GENERATIONS):
                tuned, seconds = _timed(with_clepsydra(period, generations), rounds)
                ways.append(Tuned(tuned.objective, tuned.evaluations, seconds))
            continuous, simulation = _timed(lambda p=period: simulate_with_scipy(START, p), rounds)
            if period == min(PERIODS):
                _check(tuned, continuous)
            (best, count), seconds = _timed(lambda p=period: with_scipy(p), 1)
            found[period] = TuningTimes(*ways, Tuned(best, count, seconds), simulation)
    return found


def _check(tuned: TuningResult, continuous: np.ndarray) -> None:
    """Refuse to compare ways that do not simulate the same: the start, by both.

    Raises
    ------
    Disagreement
    """
    sampled = [1e-3 * tuned.start_scores["iae[concentration]"], tuned.start_scores["iae[volume]"]]
    difference = float(np.max(np.abs(sampled / continuous - 1.0)))
    if not difference <= AGREEMENT:
        raise Disagreement(f"tuning: LSODA differs from the kernel by {difference:.1e}")


def _timed(call: Callable[[], T], rounds: int) -> tuple[T, Spread]:
    seconds = []
    for _ in range(rounds):
        start = time.perf_counter()
        answer = call()
        seconds.append(time.perf_counter() - start)
    return answer, Spread.of(seconds)
