"""The printed rule of the ranking, on trials made by hand, and the words against the numbers."""

import itertools
import math
import re
from dataclasses import replace
from importlib import resources
from types import SimpleNamespace

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.loop.motion_block import recorded_signals
from clepsydra.process.process import Process
from clepsydra.studies.ranking import RULE, Standing, Trial, rank, verdict
from clepsydra.studies.warnings.after import caveats_after, run_warnings
from clepsydra.studies.warnings.harm import harms

SAMPLES = 100


@pytest.fixture(scope="module")
def plant() -> cl.Plant:
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def process(plant) -> Process:
    return plant.process


@pytest.fixture(scope="module")
def controller(plant) -> cl.Controller:
    return cl.design.simc(plant)


@pytest.fixture(scope="module")
def resting(plant, controller) -> cl.Run:
    """A run in which nothing moves, not even by rounding."""
    run = cl.simulate(plant, controller, [], duration=SAMPLES)
    return still(run, plant)


def still(run: cl.Run, plant: cl.Plant) -> cl.Run:
    """Return a run with the states and inputs of a plant at rest in place of its own."""
    at, process = plant.point.as_dict(), plant.process
    signals = (*process.state, *process.inputs, *recorded_signals(process))
    rest = {signal.name: at.get(signal.name, signal.initial) for signal in signals}
    values = {name: np.full(SAMPLES, value) for name, value in rest.items()}
    return replace(run, process=process, signals=signals, values=values)


def changed(run: cl.Run, name: str, value: float, samples: slice = slice(50, 60)) -> cl.Run:
    values = {key: column.copy() for key, column in run.values.items()}
    values[name][samples] = value
    return replace(run, values=values)


@pytest.fixture
def trial(resting, controller):
    """Return a function that makes a trial from the errors of two levels, wears and peak.

    The errors are those of setpoint steps; those of load steps are the same unless given.
    """

    def make(
        name, errors=(1.0, 1.0), wears=(1.0, 1.0), peak=1.5, run=resting, warnings=(), loads=None
    ):
        loads = errors if loads is None else loads
        scores = {
            "iae[level_1]": 1 / errors[0] if errors[0] else 0.0,
            "iae[level_2]": 1 / errors[1] if errors[1] else 0.0,
            "iae_setpoint[level_1]": errors[0],
            "iae_setpoint[level_2]": errors[1],
            "iae_load[level_1]": loads[0],
            "iae_load[level_2]": loads[1],
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
    assert (
        "Setpoint error 1.10 and load error 1.10 times the best, 1.10 in the mean" in first.reason
    )
    assert (
        "Setpoint error 1.25 and load error 1.25 times the best, 1.25 in the mean" in second.reason
    )


def test_setpoint_and_load_weigh_the_same(trial):
    """The means of multiples are 1.25 for a, 1.5 for b, 1.45 for c."""
    a = trial("a", (10, 10), loads=(1.5, 1.5))
    b = trial("b", (20, 20), loads=(1, 1))
    c = trial("c", (19, 19), loads=(1, 1))
    assert order([a, b, c]) == ["a", "c", "b"]
    first, second, _ = rank([a, b, c])
    assert first.criteria == {"setpoint error": 1.0, "load error": 1.5}
    assert second.criteria == {"setpoint error": 1.9, "load error": 1.0}
    assert (first.mean_error, second.mean_error) == (1.25, 1.45)


def test_a_reader_recomputes_the_ranking_from_the_numbers_that_a_candidate_shows(trial):
    """Standing, the mean of the criteria, and the wear within 2 %: nothing else."""
    random = np.random.default_rng(4)
    trials = [
        trial(f"c{i}", random.uniform(1, 1.1, 2), random.uniform(1, 3, 2), random.uniform(1.5, 2.5))
        for i in range(12)
    ]
    left = {c.controller.name: c for c in rank(trials)}
    shown = []
    while left:
        standing = min(c.standing for c in left.values())
        group = {n: c for n, c in left.items() if c.standing == standing}
        means = {n: sum(c.criteria.values()) / len(c.criteria) for n, c in group.items()}
        tied = [n for n in group if means[n] <= 1.02 * min(means.values())]
        tied.sort(key=lambda name: group[name].wear)
        shown += tied
        left = {n: c for n, c in left.items() if n not in tied}
    assert shown == [c.controller.name for c in rank(trials)]


def test_where_a_score_is_missing_the_others_decide(trial):
    trials = []
    for name, error in (("a", 1.0), ("b", 2.0)):
        made = trial(name, (error, error), loads=(3 - error, 3 - error))
        kept = {k: v for k, v in made.scores.items() if "load" not in k}
        trials.append(replace(made, scores=kept))
    first, second = rank(trials)
    assert first.criteria == {"setpoint error": 1.0} and second.criteria == {"setpoint error": 2.0}
    assert second.reason.endswith("Behind a: its setpoint error is 100 % larger.")
    whole = [
        replace(
            t, scores={k: v for k, v in t.scores.items() if "_load" not in k and "_set" not in k}
        )
        for t in trials
    ]
    assert [c.criteria for c in rank(whole)] == [{"error": 1.0}, {"error": 2.0}]


def test_an_unsafe_controller_does_not_set_the_measure(trial):
    safe, quick = trial("safe", (4, 4)), trial("quick", (1, 1), peak=math.inf)
    first, second = rank([quick, safe])
    assert (first.controller.name, first.mean_error) == ("safe", 1.0)
    assert second.mean_error == 0.25


def test_rounding_makes_no_controller_many_times_worse(trial):
    """A load that does not reach a level leaves errors of 1e-17, none of which means a thing."""
    a = trial("a", (1, 1), loads=(1e-17, 2))
    b = trial("b", (1, 1), loads=(9e-16, 1))
    assert order([a, b]) == ["b", "a"]
    assert rank([a, b])[1].criteria["load error"] == 1.5


def test_an_error_that_no_sensor_shows_decides_nothing(trial, resting):
    """Of a second loop that a load hardly reaches, 0.0001 % and 0.0009 % of the range."""
    level = resting.process.signal("level_1")
    shown = 1e-5 * level.span * float(resting.time[-1] - resting.time[0])
    a = trial("a", (1, 1), loads=(0.1 * shown, 2))
    b = trial("b", (1, 1), loads=(0.9 * shown, 1))
    assert order([a, b]) == ["b", "a"]
    assert rank([a, b])[1].criteria["load error"] == 1.5
    more = trial("more", (1, 1), loads=(3.0 * shown, 1))
    assert rank([b, more])[1].criteria["load error"] == pytest.approx(2.0)
    assert "below 0.001 % of the range in the mean over the run counts as that much" in RULE


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
    nervous = replace(robust, scores=robust.scores | {"noise_movement[pump_1]": 0.51})
    assert nervous.standing == Standing.NERVOUS  # of 10 V
    quiet = replace(robust, scores=robust.scores | {"noise_movement[pump_1]": 0.49})
    assert quiet.standing == Standing.ROBUST
    standings = [t.standing for t in (robust, stable, unstable, spilling)]
    assert standings == [Standing.ROBUST, Standing.STABLE, Standing.UNSAFE, Standing.UNSAFE]
    reasons = {c.controller.name: c.reason for c in rank([unstable, spilling, stable, robust])}
    assert reasons["robust"].startswith("Robust (max|S| 2.00)")
    assert reasons["stable"].startswith("Stable with thin margins (max|S| 2.01)")
    assert reasons["unstable"].startswith("Unsafe: unstable by its linear model.")
    assert reasons["spilling"].startswith(
        "Unsafe: tank_1.level rises above its rim at 50 s (range 0 cm to 20 cm)."
    )
    assert reasons["robust"].endswith("Ahead of stable, which is not robust and quiet.")
    assert reasons["stable"].endswith("Behind robust, which is robust and quiet.")
    assert reasons["unstable"].endswith("Behind stable, which is stable.")


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
        assert candidate.controller is made.controller, candidate.controller.name
        assert candidate.run is made.run, candidate.controller.name
        assert candidate.scores == made.scores, candidate.controller.name
        assert candidate.maximum_sensitivity == made.maximum_sensitivity, candidate.controller.name
        assert candidate.warnings == made.warnings, candidate.controller.name


def test_a_single_trial_is_the_best_and_none_is_no_ranking(trial, process):
    (only,) = rank([trial("only", (7.0, 3.0), (2.0, 2.0))])
    assert only.reason == (
        "Robust (max|S| 1.50). Setpoint error 1.00 and load error 1.00 times the best, 1.00 in the "
        "mean; the least total variation."
    )
    assert rank([]) == ()
    assert "No controller" in verdict(process, [])
    said = verdict(process, [only])
    assert said == "Use only on Quadruple tank, minimum phase: the best that was tried."


def test_the_multiple_of_the_least_wear_is_said(trial):
    quick, slow = rank([trial("quick", (1, 1), (30, 20)), trial("slow", (2, 2), (10, 10))])
    assert "2.50 times the least total variation" in quick.reason
    assert "; the least total variation" in slow.reason
    assert (quick.wear, slow.wear) == (2.5, 1.0)


def test_each_is_compared_with_the_next_better_one_in_what_decided(trial):
    """Means 1, 1.3 and 1.8; b loses by the load error, c against b by the setpoint error."""
    ranking = rank(
        [
            trial("a", (1, 1), loads=(1, 1)),
            trial("b", (1.1, 1.1), loads=(1.5, 1.5)),
            trial("c", (2.4, 2.4), loads=(1.2, 1.2)),
        ]
    )
    ends = [candidate.reason.partition("variation. ")[2] for candidate in ranking]
    assert ends == [
        "Ahead of b, whose mean is 30 % larger, most of all by the load error (1.50 against 1.00).",
        "Behind a: its mean is 30 % larger, most of all by the load error (1.50 against 1.00).",
        "Behind b: its mean is 38 % larger, most of all by the setpoint error (2.40 against 1.10).",
    ]


def test_a_tie_is_said_with_the_wear_that_decided(trial):
    calm, wild = rank([trial("wild", (1, 1), (3, 3)), trial("calm", (1.01, 1.01), (2, 2))])
    assert calm.reason.endswith(
        "As good as wild to within 2 %, which moves its inputs 1.50 times as much."
    )
    assert wild.reason.endswith(
        "As good as calm to within 2 %, but moves its inputs 1.50 times as much."
    )


def test_an_error_without_end_is_said(trial):
    _, lost = rank([trial("lost", (1, 1), loads=(math.inf, 1.0)), trial("slow", (50.0, 50.0))])
    assert "load error without end" in lost.reason
    assert lost.reason.endswith("Behind slow: its load error has no end.")


def test_the_rule_says_what_decides():
    for words in (
        "robust",
        "stable",
        "2.0",
        "setpoint error",
        "load error",
        "integral absolute error",
        "without the stretch of noise",
        "outflow change",
        "outflow variance",
        "2 %",
        "total variation",
    ):
        assert words in RULE, words


@pytest.fixture(scope="module")
def averaging(resting):
    """Return a function that makes a trial of the equalisation tank from its scores."""
    at_rest = still(resting, cl.load("equalisation-tank"))

    def make(name, rate, ratio, error=1.0, **changes):
        run = at_rest
        for signal, value in changes.items():
            run = changed(run, signal.replace("__", "."), value)
        scores = {
            "iae_setpoint[level]": error,
            "iae_load[level]": error,
            "outflow_rate[level]": rate,
            "variance_ratio[level]": ratio,
            "total_variation[outflow]": 1.0,
        }
        controller = replace(resting.controller, name=name)
        return Trial(controller, run, scores, 1.2, ())

    return make


def test_a_buffer_is_ranked_by_its_outflow_and_not_by_its_level(averaging):
    tight = averaging("tight", rate=900.0, ratio=1.0, error=1.0)
    loose = averaging("loose", rate=300.0, ratio=0.8, error=80.0)
    first, second = rank([tight, loose])
    assert first.controller.name == "loose"
    assert first.criteria == {"outflow change": 1.0, "outflow variance": 1.0}
    assert second.criteria == {"outflow change": 3.0, "outflow variance": 1.25}
    assert second.reason.endswith("most of all by the outflow change (3.00 against 1.00).")
    sentence = verdict(first.run.process, [first, second])
    assert "with 53 % less outflow change and outflow variance on average than tight" in sentence


def test_a_buffer_that_overflows_is_no_good_however_smooth_its_outflow(averaging):
    tight = averaging("tight", rate=900.0, ratio=1.0)
    idle = averaging("idle", rate=0.0, ratio=0.0, basin__level=5.01)
    assert order([tight, idle]) == ["tight", "idle"]
    assert rank([idle, tight])[0].mean_error == 1.0


def test_a_pump_that_trips_is_unsafe(tmp_path, resting, controller):
    text = (
        (resources.files("clepsydra.process") / "catalogue" / "wet-well.toml")
        .read_text(encoding="utf-8")
        .replace(
            "running = true",
            'running = true\ntrip_below = { well = "0.2 m" }\nhysteresis = "0.1 m"',
            1,
        )
    )
    run = still(resting, plant_of(tmp_path, text))
    quiet = Trial(controller, run, {}, 1.2, ())
    assert quiet.standing is Standing.ROBUST
    tripped = changed(run, "duty.trips_well_below.count", 1.0, slice(50, None))
    assert replace(quiet, run=tripped).standing is Standing.UNSAFE


def test_the_verdict_compares_the_errors_of_winner_and_best_rival(trial, process):
    sentence = verdict(process, rank([trial("a", (3, 3)), trial("b", (4, 4)), trial("c", (5, 5))]))
    assert sentence.startswith("Use a on Quadruple tank")
    assert re.search(r"with 25 % less .* on average than b", sentence)


def test_the_verdict_names_who_is_as_good_beside_the_rival_that_is_not(trial, process):
    ranking = rank([trial("a", (3, 3)), trial("b", (3.03, 3.03), (2, 2)), trial("c", (4, 4))])
    assert re.search(r"25 % less .* on average than c; b is as good\.$", verdict(process, ranking))


def test_the_verdict_names_robustness_where_it_decided(trial, process):
    sentence = verdict(process, rank([trial("a", (3, 3)), trial("b", (2, 2), peak=2.5)]))
    assert "robust and quiet where b is not" in sentence


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


def test_a_multiple_of_next_to_nothing_is_not_made(trial):
    """Below a tenth of its range of 10 V in all a pump is idle: 1 mV and 0.9 V wear the same."""
    idle, calm, busy = rank(
        [
            trial("idle", (1.0, 1.0), (1e-3, 1e-3)),
            trial("calm", (1.1, 1.1), (0.9, 0.9)),
            trial("busy", (1.2, 1.2), (3.0, 1.0)),
        ]
    )
    assert (idle.wear, calm.wear, busy.wear) == (1.0, 1.0, pytest.approx(2.0))
    assert "below 10 % of the variable's range counts as that much" in RULE


@pytest.mark.parametrize(
    ("score", "words"),
    [("iae_setpoint", "with an IAE, setpoint 50 % below"), ("overshoot", "with an overshoot 50 %")],
)
def test_the_verdict_of_one_score_is_a_sentence(trial, process, score, words):
    few, many = trial("few"), trial("many")
    few.scores.update({f"{score}[level_{k}]": 5.0 for k in (1, 2)})
    many.scores.update({f"{score}[level_{k}]": 10.0 for k in (1, 2)})
    assert words in verdict(process, rank([few, many], [score]))


def test_of_a_score_of_which_more_is_better_the_largest_is_first(trial):
    most, half = trial("most"), trial("half")
    most.scores["volume_used[level_1]"], half.scores["volume_used[level_1]"] = 40.0, 20.0
    ranking = rank([half, most], ["volume_used"])
    assert [candidate.controller.name for candidate in ranking] == ["most", "half"]
    assert [candidate.mean_error for candidate in ranking] == [1.0, 2.0]


def test_a_thin_inner_loop_takes_a_controller_out_of_the_robust_ones(trial, process):
    thin, thick = (
        replace(trial(name), response=SimpleNamespace(inner_peak=("flow", peak)))
        for name, peak in (("thin", 2.1), ("thick", 1.9))
    )
    ranking = rank([thin, thick])
    assert [c.standing for c in ranking] == [Standing.ROBUST, Standing.STABLE]
    assert "(max|S| 1.50, 1.90 in the inner loop of flow)." in ranking[0].reason
    assert "thin margins (max|S| 1.50, 2.10 in the inner loop of flow)" in ranking[1].reason
    assert "also of inner loops" in RULE


def test_a_reader_at_a_prompt_sees_lines_and_no_flood(trial):
    best, second = rank([trial("a", (1, 1), (1, 3)), trial("b", (3, 3), warnings=("Hm.", "No."))])
    assert repr(best) == (
        "<Candidate 1: a; robust, max|S| 1.50; setpoint error 1, load error 1 times the best, "
        "moves 2 times the least; no warnings>"
    )
    assert repr(second).endswith("2 warnings>")


def test_a_run_at_rest_has_nothing_to_warn_of(resting):
    assert run_warnings(resting) == ()
    assert harms(resting) == ()


@pytest.mark.parametrize(
    ("name", "value", "harmed", "words"),
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
def test_what_is_unusual_is_said_with_its_number(resting, name, value, harmed, words):
    run = changed(resting, name, value)
    assert bool(harms(run)) == harmed
    warnings = run_warnings(run)
    assert len(warnings) == bool(words)
    assert not words or warnings[0].startswith(words)


def test_a_coarse_integration_is_said(resting):
    (caveat,) = caveats_after(replace(resting, error_estimate=3.2e-5))
    assert "0.0032 % of its range, more than the 0.0001 % aimed at" in caveat.words
    assert "empty" not in caveat.words  # the reason is not known
    assert caveats_after(replace(resting, error_estimate=0.9e-6)) == ()


@pytest.mark.parametrize("error", [1.0, 1.6, 4e7, math.inf])
def test_an_error_of_a_whole_range_is_no_number_to_believe(resting, error):
    (caveat,) = caveats_after(replace(resting, error_estimate=error))
    assert "by as much as its whole range" in caveat.words and "relied on" in caveat.words
    assert "%" not in caveat.words and caveat.seen
    (other,) = caveats_after(replace(resting, error_estimate=0.994))
    assert "wrong by 99 % of its range" in other.words
    assert other.about != caveat.about  # one run of no use does not speak for the others
