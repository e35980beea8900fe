"""The printed rule of the ranking, on trials made by hand, and the words against the numbers."""

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from clepsydra.controllers.controller import Controller
from clepsydra.design.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.study.ranking import RULE, Standing, Trial, rank, verdict
from clepsydra.study.warnings import leaves_its_tanks, run_warnings

SAMPLES = 100


@pytest.fixture(scope="module")
def process() -> Process:
    return load_process("quadruple-tank")


@pytest.fixture(scope="module")
def point(process) -> OperatingPoint:
    return analyse(process).operating_point


@pytest.fixture(scope="module")
def controller(process) -> Controller:
    analysis = analyse(process)
    return design_simc(analysis.model, analysis.pairing)


@pytest.fixture(scope="module")
def resting(process, point, controller) -> Run:
    """A run in which nothing moves."""
    at = point.as_dict()
    signals = (*process.state, *process.inputs)
    nothing = np.zeros((SAMPLES, 2))
    return Run(
        process=process,
        controller=controller,
        scenario=Scenario(1.0, nothing, nothing, np.zeros((SAMPLES, 4)), (), 1),
        time=np.arange(SAMPLES, dtype=float),
        signals=signals,
        values={signal.name: np.full(SAMPLES, at[signal.name]) for signal in signals},
        error_estimate=1e-9,
        substeps=1,
    )


def changed(run: Run, name: str, value: float, samples: slice = slice(50, 60)) -> Run:
    values = {key: column.copy() for key, column in run.values.items()}
    values[name][samples] = value
    return replace(run, values=values)


@pytest.fixture
def trial(resting, controller):
    """Return a function that makes a trial from its two errors, two wears and peak."""

    def make(name, errors=(1.0, 1.0), wears=(1.0, 1.0), peak=1.5, run=resting, warnings=()):
        scores = {
            "iae[level_1]": errors[0],
            "iae[level_2]": errors[1],
            "ise[level_1]": 1 / errors[0] if errors[0] else 0.0,
            "total_variation[pump_1]": wears[0],
            "total_variation[pump_2]": wears[1],
        }
        named = replace(controller, name=name)
        return Trial(named, replace(run, controller=named), scores, peak, warnings)

    return make


def order(trials) -> list[str]:
    """Return the names in order of rank, the same from whatever order the trials come in."""
    results = set()
    for arrangement in itertools.permutations(trials):
        ranking = rank(arrangement)
        assert [candidate.rank for candidate in ranking] == list(range(1, len(trials) + 1))
        results.add(tuple(candidate.controller.name for candidate in ranking))
    assert len(results) == 1, results
    return list(results.pop())


def test_the_smaller_error_comes_first(trial):
    assert order([trial("b", (2, 1)), trial("a", (1, 1)), trial("c", (2, 2))]) == ["a", "b", "c"]


def test_each_error_counts_as_a_multiple_of_the_best_one(trial):
    """Means of multiples: 1.1 for a, 1.25 for b, though b's sum of errors is far smaller."""
    a = trial("a", (120.0, 1.0))
    b = trial("b", (100.0, 1.5))
    assert order([a, b]) == ["a", "b"]
    first, second = rank([a, b])
    assert "1.10 times the smallest integral absolute error" in first.reason
    assert "1.25 times the smallest integral absolute error" in second.reason


def test_robust_before_stable_before_unsafe_whatever_the_error(trial, resting):
    overflowing = changed(resting, "tank_1.level", 0.21)
    robust = trial("robust", (9, 9), peak=2.0)
    stable = trial("stable", (3, 3), peak=2.01)
    unstable = trial("unstable", (1, 1), peak=math.inf)
    spilling = trial("spilling", (2, 2), peak=1.1, run=overflowing)
    assert order([unstable, spilling, stable, robust]) == [
        "robust",
        "stable",
        "unstable",
        "spilling",
    ]
    standings = [t.standing for t in (robust, stable, unstable, spilling)]
    assert standings == [Standing.ROBUST, Standing.STABLE, Standing.UNSAFE, Standing.UNSAFE]
    reasons = {c.controller.name: c.reason for c in rank([unstable, spilling, stable, robust])}
    assert reasons["robust"].startswith("Robust (max|S| 2.00)")
    assert reasons["stable"].startswith("Stable with thin margins (max|S| 2.01)")
    assert reasons["unstable"].startswith("Unstable")
    assert reasons["spilling"].startswith("A level leaves its tank")


@pytest.mark.parametrize("peak", [math.inf, math.nan])
def test_a_peak_that_is_no_number_is_not_safe(trial, peak):
    assert trial("x", peak=peak).standing == Standing.UNSAFE


def test_within_two_percent_the_calmer_one_comes_first(trial):
    calm, quick = trial("calm", (1.019, 1.019), (1, 1)), trial("quick", (1, 1), (1.5, 1.5))
    assert order([calm, quick]) == ["calm", "quick"]
    calm = trial("calm", (1.021, 1.021), (1, 1))
    assert order([calm, quick]) == ["quick", "calm"]


def test_a_tie_never_crosses_standings(trial):
    calm = trial("calm", (1.0, 1.0), (1, 1), peak=2.5)
    wild = trial("wild", (1.01, 1.01), (9, 9), peak=1.5)
    assert order([calm, wild]) == ["wild", "calm"]


def test_of_three_within_two_percent_the_calmest_comes_first(trial):
    """All pairs are within 2 % of each other, so that only the wear decides."""
    trials = [
        trial("a", (1.000, 1.000), (3, 3)),
        trial("b", (1.010, 1.010), (2, 2)),
        trial("c", (1.015, 1.015), (1, 1)),
    ]
    assert order(trials) == ["c", "b", "a"]


def test_an_endless_error_comes_last_among_its_equals(trial):
    assert order([trial("lost", (math.inf, 1.0)), trial("slow", (50.0, 50.0))]) == ["slow", "lost"]


def test_scores_runs_and_warnings_go_with_their_controller(trial):
    first, second = trial("first", (1, 1)), trial("second", (2, 2), warnings=("It leaks.",))
    for candidate, made in zip(rank([second, first]), [first, second], strict=True):
        assert candidate.controller is made.controller
        assert candidate.run is made.run
        assert candidate.scores == made.scores
        assert candidate.maximum_sensitivity == made.maximum_sensitivity
        assert candidate.warnings == made.warnings


def test_a_single_trial_is_the_best_and_none_is_no_ranking(trial, process):
    (only,) = rank([trial("only", (7.0, 3.0), (2.0, 2.0))])
    assert "the smallest integral absolute error" in only.reason
    assert "the least total variation" in only.reason and "times" not in only.reason
    assert rank([]) == ()
    assert "No controller" in verdict(process, [])
    assert verdict(process, [only]).startswith("only controls Quadruple tank")


def test_the_multiple_of_the_least_wear_is_said(trial):
    quick, slow = rank([trial("quick", (1, 1), (30, 20)), trial("slow", (2, 2), (10, 10))])
    assert "2.50 times the least total variation" in quick.reason
    assert "; the least total variation" in slow.reason
    assert "2.00 times the smallest integral absolute error" in slow.reason


def test_the_rule_says_what_decides():
    for words in ("robust", "stable", "2.0", "integral absolute error", "2 %", "total variation"):
        assert words in RULE


def test_the_verdict_compares_the_errors_of_winner_and_best_rival(trial, process):
    sentence = verdict(process, rank([trial("a", (3, 3)), trial("b", (4, 4)), trial("c", (5, 5))]))
    assert sentence.startswith("a controls Quadruple tank")
    assert re.search(r"25 % below that of b", sentence)
    assert "1.50" in sentence


def test_the_verdict_names_robustness_where_it_decided(trial, process):
    sentence = verdict(process, rank([trial("a", (3, 3)), trial("b", (2, 2), peak=2.5)]))
    assert "robust where b is not" in sentence


def test_the_verdict_does_not_name_robustness_where_wear_decided(trial, process):
    """Both are robust, b even more so; a is first for its calm alone."""
    ranking = rank(
        [trial("a", (1.01, 1.01), (1, 1), peak=1.9), trial("b", (1, 1), (2, 2), peak=1.2)]
    )
    assert [candidate.controller.name for candidate in ranking] == ["a", "b"]
    assert "more robust" not in verdict(process, ranking)


def test_the_verdict_does_not_name_robustness_where_the_mean_decided(trial, process):
    """a has the smaller mean of multiples and the larger sum; both are robust."""
    ranking = rank([trial("a", (120.0, 1.0), peak=1.9), trial("b", (100.0, 1.5), peak=1.2)])
    assert [candidate.controller.name for candidate in ranking] == ["a", "b"]
    assert "more robust" not in verdict(process, ranking)


def test_the_verdict_says_what_to_watch(trial, process):
    ranking = rank([trial("a", warnings=("pump_1 stands at a limit for 12 % of the time.",))])
    assert "watch: pump_1 stands at a limit for 12 % of the time" in verdict(process, ranking)


def test_a_run_at_rest_has_nothing_to_warn_of(resting):
    assert run_warnings(resting) == ()
    assert not leaves_its_tanks(resting)


@pytest.mark.parametrize(
    ("name", "value", "leaves", "words"),
    [
        ("tank_2.level", 0.2001, True, "tank_2.level rises above its rim at 50 s"),
        ("tank_2.level", 0.2, False, ""),
        ("tank_3.level", 0.0, False, "tank_3.level runs empty at 50 s"),
        ("tank_3.level", -1e-3, True, "tank_3.level runs empty at 50 s"),
        ("tank_4.level", math.nan, True, "tank_4.level is not a number at 50 s"),
        ("pump_2", 10.0, False, "pump_2 stands at a limit for 10 % of the time"),
        ("pump_2", 0.0, False, "pump_2 stands at a limit for 10 % of the time"),
    ],
)
def test_what_is_unusual_is_said_with_its_number(resting, name, value, leaves, words):
    run = changed(resting, name, value)
    assert leaves_its_tanks(run) == leaves
    warnings = run_warnings(run)
    assert len(warnings) == bool(words)
    assert not words or warnings[0].startswith(words)


def test_a_coarse_integration_is_said(resting):
    (warning,) = run_warnings(replace(resting, error_estimate=3.2e-5))
    assert "3.2e-05" in warning
