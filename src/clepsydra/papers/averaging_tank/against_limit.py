"""The document's step of both references, at its own sampling and at a controller's scan."""

from __future__ import annotations

import dataclasses
from functools import partial
from itertools import product

from clepsydra.controllers.controller import Controller
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.papers.averaging_tank.fuzzy import FILTERED, fuzzy_controller
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_of
from clepsydra.papers.averaging_tank.model import tank
from clepsydra.papers.averaging_tank.operating_range import CYCLE
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL, pi_controller
from clepsydra.papers.averaging_tank.step_run import HORIZON, MEASURED, PERIOD, STEPS
from clepsydra.papers.averaging_tank.symbols import VARIANTS, Variant, constant_flow
from clepsydra.papers.contest import Contest, Contests
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

#: That of the document's indices, and two scans of a programmable logic controller [s].
PERIODS = (PERIOD, CYCLE, 10.0 * CYCLE)
WORDS = (
    "C and V step together, as the printed indices have it. The controllers are the document's, "
    "without anti-windup: PI control of (80) to (83), LQI by the weights of (97a) to (101a), that "
    "of Q3 as Table 7 needs it, and the fuzzy rules with both derivatives over 2 ms, as Table 8 "
    "needs them. Its indices belong to a sample every 0.2 ms; no controller in a plant is so "
    "fast, so that all of it stands here at scans of 10 and 100 ms too, with the same settings. "
    "Where both flows are moved, the loops of ours still move one of them."
)


def contests() -> Contests:
    """Return each way to move the tank, at each period."""
    constant = {constant_flow(each): partial(_one_flow, each) for each in VARIANTS}
    ways = constant | {"Both flows moved": _both_flows}
    return {
        f"{moved}, every {1e3 * period:g} ms": partial(contest, period)
        for period, (moved, contest) in product(PERIODS, ways.items())
    }


def _one_flow(variant: Variant, period: float) -> Contest:
    """Return PI control and LQI with the printed constants and weights."""
    analysis = _sampled(tank(variant), period)
    published = {
        f"PI, {each.tuned}": pi_controller(each, analysis.model)
        for each in (BY_HAND[variant], OPTIMAL[variant])
    }
    published |= {
        f"LQI, {each.tuned}": lqi_of(each, analysis.model)
        for each in COLUMNS
        if each.constant == variant
    }
    return _contest(analysis, published)


def _both_flows(period: float) -> Contest:
    analysis = _sampled(load_process("averaging-tank:all-inputs"), period)
    return _contest(analysis, {"fuzzy": fuzzy_controller(FILTERED, analysis.operating_point)})


def _sampled(process: Process, period: float) -> Analysis:
    return analyse(dataclasses.replace(process, sampling_period=period))


def _contest(analysis: Analysis, published: dict[str, Controller]) -> Contest:
    at = analysis.operating_point.as_dict()
    targets = {
        name: at[name] + factor * STEPS[output] for output, (name, factor) in MEASURED.items()
    }
    return Contest(analysis, targets, HORIZON, published)
