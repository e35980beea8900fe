"""A whole study: its ranking against its numbers, its seed, and what does not apply."""

import math
import re
from functools import cache
from importlib import resources
from pathlib import Path

import numpy as np
import pandas
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError
from clepsydra.studies.designs import DESIGNS

PLANT = cl.load("quadruple-tank")
NONMINIMUM = "quadruple-tank-nonminimum-phase"


@cache
def some() -> cl.Study:
    """Return the study of some designs, which have different standings."""
    return cl.study(
        PLANT,
        [
            cl.design.simc(PLANT),
            cl.design.phase_margin(PLANT),
            cl.design.lqi(PLANT),
            cl.design.lqi_kalman(PLANT),
            cl.design.ziegler_nichols(PLANT),
            cl.design.ziegler_nichols(PLANT, as_published=True).named("as published"),
        ],
    )


def test_some_designs_have_different_standings():
    standings = [candidate.standing.name for candidate in some().ranking]
    assert standings == ["ROBUST"] * 4 + ["NERVOUS", "STABLE"]


@pytest.fixture(params=["some", pytest.param(NONMINIMUM, marks=pytest.mark.thorough)])
def result(request, studied) -> cl.Study:
    return some() if request.param == "some" else studied(request.param)


@pytest.mark.thorough
def test_every_design_is_ranked_or_listed_with_its_reason(studied):
    result = studied(NONMINIMUM)
    ranked = [candidate.controller.name for candidate in result.ranking]
    refused = [name for name, _ in result.not_applicable]
    assert sorted(ranked + refused) == sorted([*DESIGNS, "PI, SIMC, tuned", "PID, SIMC, tuned"])
    assert [candidate.rank for candidate in result.ranking] == list(range(1, len(ranked) + 1))
    assert len(ranked) >= 2


def group(candidate) -> int:
    """Return the standing by the printed rule, from the trajectories themselves."""
    levels = [candidate.run.values[signal.name] for signal in candidate.run.process.state]
    # Johansson's tanks are 20 cm high.
    inside = all(np.all((level >= 0.0) & (level <= 0.2)) for level in levels)
    if not inside or not math.isfinite(candidate.maximum_sensitivity):
        return 3
    if candidate.maximum_sensitivity > 2.0 + 1e-5:
        return 2
    noisy = np.any(candidate.run.scenario.noise != 0, axis=1)
    for pump in ("pump_1", "pump_2"):
        # Moves from sample to sample of white noise are √2 times as large as the noise.
        moves = np.diff(candidate.run.values[pump][noisy])
        if float(np.std(moves)) / np.sqrt(2.0) > 0.05 * 10.0:
            return 1
    return 0


def multiples(result: cl.Study, score: str) -> list[float]:
    """Return the mean over both signals of a score as multiples of the best of the first group.

    An error below 0.001 % of the 10 V of a sensor, in the mean over the run, counts as that much.
    """
    time = result.ranking[0].run.time
    nothing = 1e-5 * 10.0 * (time[-1] - time[0]) if score.startswith("iae") else 0.0
    keys = [key for key in result.ranking[0].scores if key.startswith(score + "[")]
    assert len(keys) == 2
    first = [c for c in result.ranking if group(c) == group(result.ranking[0])]
    best = {key: max(min(candidate.scores[key] for candidate in first), nothing) for key in keys}
    return [
        sum(max(candidate.scores[key], nothing) / best[key] for key in keys) / 2
        for candidate in result.ranking
    ]


def errors_of(result: cl.Study) -> list[tuple[float, float]]:
    """Return setpoint error and load error of each candidate."""
    return list(zip(multiples(result, "iae_setpoint"), multiples(result, "iae_load"), strict=True))


def test_the_printed_rule_holds(result):
    """Those within 2 % of the least error that is left stand together, the calmest first."""
    groups = [group(candidate) for candidate in result.ranking]
    errors = [sum(pair) / 2 for pair in errors_of(result)]
    wears = multiples(result, "total_variation")
    waiting, expected = sorted(range(len(groups)), key=lambda i: (groups[i], errors[i])), []
    while waiting:
        least, of = errors[waiting[0]], groups[waiting[0]]
        tied = [i for i in waiting if groups[i] == of and errors[i] <= 1.02 * least]
        expected += sorted(tied, key=lambda i: wears[i])
        waiting = waiting[len(tied) :]
    assert expected == list(range(len(groups)))


def test_the_reasons_in_words_match_the_numbers(result):
    wears = multiples(result, "total_variation")
    for candidate, errors, wear in zip(result.ranking, errors_of(result), wears, strict=True):
        name = candidate.controller.name
        said = re.search(r"\(max\|S\| ([\d.]+)\)", candidate.reason)
        assert (said is None) == (group(candidate) == 3), name
        assert said is None or float(said[1]) == round(candidate.maximum_sensitivity, 2), name
        said = re.search(r"Setpoint error ([\d.]+) and load error ([\d.]+) times", candidate.reason)
        assert said is not None, name
        for number, exact in zip(said.groups(), errors, strict=True):
            assert float(number) == pytest.approx(exact, abs=0.0051), (name, number)
        assert list(candidate.criteria.values()) == pytest.approx(errors, rel=1e-9), name
        assert candidate.mean_error == pytest.approx(sum(errors) / 2, rel=1e-9), name
        assert candidate.wear == pytest.approx(wear, rel=1e-9), name
        assert ("noise moves its outputs" in candidate.reason) == (group(candidate) == 1), name
        said = re.search(r"(?:([\d.]+) times )?the least total variation", candidate.reason)
        assert said is not None, name
        assert float(said[1] or 1.0) == pytest.approx(wear, abs=0.0051), name


def test_the_verdict_names_the_first_and_what_decided(result):
    if not result.verdict.startswith(f"Use {result.ranking[0].controller.title} on "):
        assert result.verdict.endswith(": the simplest that is good enough.")
        return
    said = re.search(r"with ([\d.]+) % less .+ on average than (.+)\.$", result.verdict)
    assert said is not None
    than, tie, tied = said[2].partition("; ")
    if tie:  # what is as good takes the second place, and the third is the next one
        assert tied == f"{result.ranking[1].controller.title} is as good"
    place = 2 if tie else 1
    assert than == result.ranking[place].controller.title
    first, second = (sum(errors_of(result)[k]) / 2 for k in (0, place))
    assert float(said[1]) == pytest.approx(100 * (1 - first / second), abs=0.51)


def test_the_scores_are_those_of_the_trajectories(result):
    for candidate in result.ranking:
        name, run = candidate.controller.name, candidate.run
        for i in (1, 2):
            pump = run.values[f"pump_{i}"]
            variation = float(np.sum(np.abs(np.diff(pump))))
            assert candidate.scores[f"total_variation[pump_{i}]"] == pytest.approx(
                variation, rel=1e-12
            ), (name, i)
            # The true level in volts, without noise, along a line: the setpoint is
            # held over each sample, and the level goes on to the next.
            level = 50.0 * run.values[f"tank_{i}.level"]
            setpoint = run.values[f"level_{i}.setpoint"][:-1]
            a, b = setpoint - level[:-1], setpoint - level[1:]
            areas = (np.abs(a) + np.abs(b)) / 2
            # Two triangles where the error changes its sign on the way.
            turns = a * b < 0
            c, d = np.abs(a[turns]), np.abs(b[turns])
            areas[turns] = (c**2 + d**2) / (2 * (c + d))
            assert candidate.scores[f"iae[level_{i}]"] == pytest.approx(areas.sum(), rel=1e-9), (
                name,
                i,
            )


def test_every_run_met_its_error_estimate_or_says_so(result):
    for candidate in result.ranking:
        name, estimate = candidate.controller.name, candidate.run.error_estimate
        assert estimate is not None, name
        assert estimate <= 1e-6 or any("accuracy" in each.about for each in candidate.caveats), name


@pytest.mark.thorough
def test_both_phases_are_told_apart(studied):
    both = minimum, nonminimum = [some(), studied(NONMINIMUM)]
    assert minimum.analysis.minimum_phase and not nonminimum.analysis.minimum_phase
    slowest = [min(c.scores["settling_time[level_1]"] for c in r.ranking) for r in both]
    assert slowest[1] > slowest[0]


def test_the_dictionary_says_the_same(result):
    said = result.as_dict()
    assert said["process"] == result.process.name
    assert said["verdict"] == result.verdict
    assert [entry["controller"] for entry in said["ranking"]] == [
        candidate.controller.name for candidate in result.ranking
    ]
    assert [entry["scores"] for entry in said["ranking"]] == [
        candidate.scores for candidate in result.ranking
    ]
    assert said["scenario"]["seed"] == 1
    assert len(said["scenario"]["segments"]) == len(result.scenario.segments)


@pytest.mark.parametrize("design", ["lqi_kalman", pytest.param("simc", marks=pytest.mark.thorough)])
def test_the_same_seed_gives_the_same_bits_and_another_seed_other_noise(design):
    controller = getattr(cl.design, design)(PLANT)
    first, again, other = (cl.study(PLANT, [controller], seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(first.scenario.noise, again.scenario.noise)
    assert again.verdict == first.verdict
    (a,), (b,), (c,) = (study.ranking for study in (first, again, other))
    assert (a.controller.name, a.scores, a.reason) == (b.controller.name, b.scores, b.reason)
    assert a.maximum_sensitivity == b.maximum_sensitivity
    for name, values in a.run.values.items():
        assert values.tobytes() == b.run.values[name].tobytes(), name
    assert other.scenario.seed == 2
    assert np.array_equal(first.scenario.setpoints, other.scenario.setpoints)
    noisy = np.any(first.scenario.noise != 0, axis=1)
    assert np.count_nonzero(noisy) > 100
    assert np.all(first.scenario.noise[noisy] != other.scenario.noise[noisy])
    quiet = int(np.argmax(noisy))
    for name, values in a.run.values.items():
        assert np.array_equal(values[:quiet], c.run.values[name][:quiet]), name
    assert not np.array_equal(a.run.values["pump_1"], c.run.values["pump_1"])


def test_a_file_of_the_same_text_is_the_same_study(tmp_path):
    """A process file of the catalogue's text, and a study file that asks for the designs."""
    (tmp_path / "mine.toml").write_text(catalogue_text())
    asked = {"PI, SIMC": "simc", "PI, phase margin": "phase_margin"}
    text = "".join(f'[controllers."{name}"]\ndesign = "{key}"\n' for name, key in asked.items())
    (tmp_path / "study.toml").write_text(f'process = "mine.toml"\n{text}')
    found = cl.study(tmp_path / "study.toml")
    whole = some()
    assert [c.controller.name for c in found.ranking] == [
        c.controller.name for c in whole.ranking if c.controller.name in asked
    ]
    for candidate in found.ranking:
        name = candidate.controller.name
        assert candidate.scores == whole[name].scores, name


MIXED = """process = "quadruple-tank"
[scenario]
duration = "5 min"
noise = false
[[scenario.setpoint]]
signal = "level_1"
at = "10 s"
by = "1 V"
[controllers.hand.loops.one]
measurement = "level_1"
output = "pump_1"
actions = "PI"
action = "reverse"
gain = "3 %/%"
integral_time = "60 s"
[controllers.simc]
design = "simc"
"""


@pytest.mark.thorough
def test_controllers_of_different_inputs_are_compared_and_written(tmp_path):
    (tmp_path / "mixed.toml").write_text(MIXED)
    result = cl.study(tmp_path / "mixed.toml")
    result.save(tmp_path / "mixed.parquet")
    table = pandas.read_parquet(tmp_path / "mixed.parquet")
    by_hand = table["controller"] == "hand"
    assert by_hand.sum() == result.scenario.samples
    # Only one of them moves pump 2 and has a status for it.
    assert table.loc[by_hand, "pump_2.status"].isna().all()
    assert not table.loc[~by_hand, "pump_2.status"].isna().any()


def test_a_score_that_no_run_has_is_refused(tmp_path):
    text = MIXED + '[ranking]\nscores = ["total_variation[level_1]"]\n'
    (tmp_path / "mixed.toml").write_text(text)
    with refused(value="total_variation[level_1]"):
        cl.study(tmp_path / "mixed.toml")


def catalogue_text() -> str:
    folder = resources.files("clepsydra.process") / "catalogue"
    return (folder / "quadruple-tank.toml").read_text(encoding="utf-8")


def without_sensor(number: int, folder: Path) -> Path:
    text = catalogue_text()
    start = text.index(f"[sensors.level_{number}]")
    end = text.find("[sensors.", start + 1)
    path = folder / "partly-measured.toml"
    path.write_text(text[:start] + (text[end:] if end > 0 else ""))
    return path


A_MINUTE = """[scenario]
duration = "1 min"
noise = false
[[scenario.setpoint]]
signal = "level_1"
at = "10 s"
by = "5 %"
"""
NAMED = {
    "LQI, Bryson": "lqi",
    "PI, SIMC": "simc",
    "PI, phase margin": "phase_margin",
    "LQI with Kalman filter": "lqi_kalman",
}


def study_of(path: Path, *names: str) -> cl.Study:
    """Return the study of some designs on a process file, for a step of a minute."""
    text = "".join(f'[controllers."{name}"]\ndesign = "{NAMED[name]}"\n' for name in names)
    file = path.with_name("study.toml")
    file.write_text(f'process = "{path.name}"\n{A_MINUTE}{text}')
    return cl.study(file)


@pytest.mark.parametrize("number", [3, pytest.param(4, marks=pytest.mark.thorough)])
def test_a_design_that_needs_a_missing_sensor_is_listed_with_the_level(number, tmp_path):
    result = study_of(without_sensor(number, tmp_path), "LQI, Bryson", "LQI with Kalman filter")
    reasons = dict(result.not_applicable)
    assert f"tank_{number}.level is not measured" in reasons["LQI, Bryson"]
    ranked = {c.controller.name: c for c in result.ranking}
    assert set(ranked) == {"LQI with Kalman filter"}
    # What is not measured is estimated from what is.
    measurements = ranked["LQI with Kalman filter"].controller.measurements
    assert f"level_{number}" not in measurements and len(measurements) >= 2
    listed = {"controller": "LQI, Bryson", "reason": reasons["LQI, Bryson"]}
    assert listed in result.as_dict()["not_applicable"]


def test_an_unknown_process_is_refused_with_those_that_are_known():
    with pytest.raises(InputError) as refusal:
        cl.study("quadruple-tonk")
    assert "quadruple-tonk" in str(refusal.value) and "quadruple-tank" in str(refusal.value)


def test_a_design_whose_numbers_no_controller_takes_does_not_end_the_study(tmp_path):
    """Ten million times the volts, ten million times the gains: LQI's pass 1e9 V/m, PI's do not."""
    path = tmp_path / "high-voltage.toml"
    text = (Path(__file__).parents[1] / "one-tank.toml").read_text()
    for volts, of_high_voltage in (
        ("3.33 cm", "3.33e-7 cm"),
        ("10 V", "1e8 V"),
        ("1.5 V", "1.5e7 V"),
    ):
        text = text.replace(volts, of_high_voltage)
    path.write_text(text)
    result = study_of(path, "LQI, Bryson", "PI, SIMC", "PI, phase margin")
    reasons = dict(result.not_applicable)
    assert "its pump_1.feedback.level_1 would be 1." in reasons["LQI, Bryson"]
    assert "a controller takes a number from -1e+09 to 1e+09 V/m" in reasons["LQI, Bryson"]
    assert {"PI, SIMC", "PI, phase margin"} == {c.controller.name for c in result.ranking}


@pytest.mark.thorough
def test_an_interrupted_tuning_is_told_and_goes_on(tmp_path):
    """Control-C in the middle of the search: the best so far now, the same end afterwards."""
    file = tmp_path / "tuned.toml"
    file.write_text(
        'process = "three-tanks"\n[scenario]\nduration = "30 min"\nnoise = false\n'
        '[[scenario.setpoint]]\nsignal = "level_3"\nat = "1 min"\nby = "2 cm"\n'
        '[controllers.a]\ndesign = "simc"\ntune = {}\n'
    )
    calls = []

    def interrupt(progress):
        calls.append(progress)
        if len(calls) == 6:
            raise KeyboardInterrupt

    (cut,) = cl.study(file, progress=interrupt, folder=tmp_path).ranking
    assert cut.tuning.interrupted and "interrupted after" in cut.caveats[0].words
    (kept,) = tmp_path.glob("*.tuning.json")
    (ended,) = cl.study(file, folder=tmp_path).ranking
    assert not kept.exists()
    (whole,) = cl.study(file).ranking
    assert not whole.tuning.interrupted and not any(
        each.about == "tuning" for each in whole.caveats
    )
    assert ended.controller.values == whole.controller.values
    assert ended.tuning.objective == whole.tuning.objective <= cut.tuning.objective


TUNED = (
    'process = "three-tanks"\n[scenario]\nduration = "10 min"\nnoise = false\n'
    '[[scenario.setpoint]]\nsignal = "level_3"\nat = "1 min"\nby = "2 cm"\n'
    '[controllers.a]\ndesign = "simc"\n'
    'tune = {parameters = {"level_3.integral_time" = ["60 s", "900 s"]}}\n'
)


@pytest.fixture
def cut_short(tmp_path):
    """Return a study file of one tuning, and the state that an interrupted run of it has left."""

    told = []

    def interrupt(progress):
        told.append("local search" in progress.name)
        if told.count(True) == 1:
            raise KeyboardInterrupt

    file = tmp_path / "tuned.toml"
    file.write_text(TUNED)
    cl.study(file, progress=interrupt, folder=tmp_path)
    (kept,) = tmp_path.glob("*.tuning.json")
    return file, kept


def test_a_tuning_of_a_study_that_has_changed_begins_afresh_and_says_so(cut_short):
    file, kept = cut_short
    file.write_text(TUNED.replace("2 cm", "1 cm"))
    (found,) = cl.study(file, folder=file.parent).ranking
    assert not found.tuning.interrupted
    (said,) = [each.words for each in found.caveats if "afresh" in each.words]
    assert str(kept) in said and "another problem" in said
    (alone,) = cl.study(file).ranking
    assert found.controller.values == alone.controller.values
    assert not any("afresh" in each.words for each in alone.caveats)


def test_a_damaged_state_of_a_tuning_is_refused_by_its_own_path(cut_short):
    file, kept = cut_short
    kept.write_text(kept.read_text()[:-10])
    with refused(place=str(kept), value="something else, or changed since"):
        cl.study(file, folder=file.parent)


def test_the_rule_that_is_told_is_the_one_that_ranked(tmp_path):
    text = 'title = "Calm or quick"\n' + MIXED + '[ranking]\nscores = ["overshoot[level_1]"]\n'
    (tmp_path / "mixed.toml").write_text(text)
    result = cl.study(tmp_path / "mixed.toml")
    assert (result.title, list(result.ranking[0].criteria)) == (
        "Calm or quick",
        ["Overshoot of level_1"],
    )
    result.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "mean of overshoot of level_1, each" in page and "Calm or quick" in page
    assert "mean of setpoint error and load error" not in page


def test_only_the_controller_that_is_asked_for_is_made():
    result = cl.study("quadruple-tank", only="PI, SIMC")
    assert [candidate.controller.name for candidate in result.ranking] == ["PI, SIMC"]


def test_a_name_of_no_controller_is_refused():
    with refused(remedy="perhaps 'PI, SIMC' was meant"):
        cl.study("quadruple-tank", only="PI SIMC")
