"""The worker's share of a live report, in Node: what it posts to the page."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hosted_report import live_of, run
from tools import need

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.linear.linearise import linearise

from .conftest import shown_windows

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"
#: Each search for a peak stops where a maximum can rise by no more than this share.
RISE = 1e-9


@pytest.fixture(scope="module")
def studied():
    need("wasmtime")
    plant = cl.load("three-tanks")
    result = cl.study(plant, controllers=[cl.design.simc(plant), cl.design.smith_predictor(plant)])
    return result, live_of(result)


@pytest.fixture(scope="module")
def windows(studied):
    return shown_windows(studied[0])


@pytest.fixture
def session(studied, report_session):
    return report_session(*studied)


@pytest.fixture
def runs(session):
    """Return what a session posts after it is ready."""

    def posted(*messages, **given):
        ready, *others = session(messages=messages, **given)
        assert ready == {"kind": "ready"}
        return others

    return posted


@pytest.fixture
def asked(studied):
    """Return the message that asks for a run, with the values of the report or with others."""

    def message(run=1, controller=0, values=None):
        own = studied[1]["controllers"][controller]["values"]
        return {
            "kind": "run", "run": run, "controller": controller,
            "values": own if values is None else values,
        }  # fmt: skip

    return message


def bolder(live, factor):
    values = np.array(live["values"])
    for place, power in live["bolder"]:
        values[place] *= factor**power
    return values.tolist()


@pytest.mark.parametrize("controller", [0, 1])
@pytest.mark.parametrize("factor", [0.4, 1.3])
def test_other_settings_are_run_as_by_another_host(
    controller, factor, runs, asked, studied, windows
):
    result, data = studied
    live = data["controllers"][controller]
    values = bolder(live, factor)
    expected, _ = run(data, live, values)
    ran, analysed = runs(asked(1, controller, values))
    for window, curves in zip(windows, ran["curves"], strict=True):
        for place, found in zip(live["signals"], curves, strict=True):
            column = expected[window.samples, place["column"]] * place["factor"]
            assert np.array_equal(found, column + 0.0)
    chosen = result.ranking[live["controller"]].controller
    names = [each.name for each in chosen.law.parameters]
    moved = replace(chosen, values=dict(zip(names, values, strict=True)))
    loop = sampled_loop(moved, linearise(result.point))
    assert analysed["stable"] == loop.is_stable
    assert analysed["peak"] == pytest.approx(loop.maximum_sensitivity, rel=2 * RISE)


def test_an_unstable_loop_is_told_so(runs, asked, studied):
    _, data = studied
    _, analysed = runs(asked(values=bolder(data["controllers"][0], 1e3)))
    assert analysed["peak"] == math.inf and not analysed["stable"]
    assert analysed["margins"] == []


def test_a_long_run_shows_what_there_is_after_a_tenth_of_a_second(runs, asked):
    part, whole, _ = runs(asked(), step=30)
    assert not part["whole"] and 0 < part["samples"] < whole["samples"] and whole["whole"]
    assert all(math.isnan(number) for number in part["numbers"])
    early, late = (
        np.concatenate([curve for event in each["curves"] for curve in event])
        for each in (part, whole)
    )
    known = ~np.isnan(early)
    assert known.any() and not known.all()
    assert np.array_equal(early[known], late[known])


@pytest.mark.parametrize(
    ("step", "posts"),
    [
        (1, [("whole", 1), ("whole", 2), ("whole", 3), ("analysed", 3)]),
        (30, [("part", 1), ("part", 2), ("part", 3), ("whole", 3), ("analysed", 3)]),
    ],
    ids=["quick", "slow"],
)
def test_a_newer_run_takes_the_place_of_one_that_has_shown_something(step, posts, runs, asked):
    posted = runs(asked(1), later=[asked(2), asked(3)], step=step)
    kinds = {True: "whole", False: "part", None: "analysed"}
    assert [(kinds[each.get("whole")], each["run"]) for each in posted] == posts


def test_what_is_asked_for_before_all_is_there_is_run_then(session, asked):
    posted = session(f"void session.take({json.dumps(asked(5))});")
    assert [each["kind"] for each in posted] == ["ready", "ran", "analysed"]


@pytest.mark.parametrize(
    ("before", "words"),
    [
        ("delete globalThis.WebAssembly;", "This browser has no WebAssembly"),
        ("delete globalThis.DecompressionStream;", "This browser has no DecompressionStream"),
        ("WebAssembly.compile = async () => { throw Error(); };", "WebAssembly is forbidden"),
        ("given.data.form = 2;", "another version of Clepsydra"),
        ("given.data.modules[0] = given.data.modules[0].slice(0, 400);", "is damaged"),
    ],
)
def test_what_cannot_run_is_told_in_a_sentence(before, words, session, asked):
    (refused,) = session(before, messages=[asked()])
    assert refused["kind"] == "refused" and words in refused["words"]
    assert refused["words"].endswith(".")


def test_a_run_that_breaks_off_is_told_and_the_next_one_runs(runs, asked):
    refused, ran, _ = runs(asked(1) | {"controller": 9}, asked(2))
    assert refused["kind"] == "refused" and refused["words"].startswith("The run broke off: ")
    assert ran["run"] == 2 and ran["whole"]


def test_a_level_that_a_softer_law_lets_out_of_its_band_is_told(report_session):
    need("wasmtime")
    plant = cl.load(EXAMPLES / "surge-drum.toml")
    result = cl.study(plant, controllers=[cl.design.arrest_time(plant)])
    data = live_of(result)
    (live,) = data["controllers"]
    values = bolder(live, 0.5)
    asked = {"kind": "run", "run": 1, "controller": 0, "values": values}
    _, ran, _ = report_session(result, data)(messages=[asked])
    chosen = result.ranking[0].controller
    names = [each.name for each in chosen.law.parameters]
    soft = chosen.with_values(dict(zip(names, values, strict=True)))
    expected = cl.simulate(plant, soft).scores["time_outside_band[level]"]
    assert expected > 0.0
    assert ran["bands"] == [{"name": "level", "seconds": pytest.approx(expected, rel=1e-6)}]


@pytest.mark.parametrize(
    "design", ["recomputed_lqi", "feedback_linearisation", "gain_scheduled_pid"]
)
def test_a_law_is_as_robust_as_where_it_rests_with_other_values(design, report_session):
    need("wasmtime")
    plant = cl.load("three-tanks")
    result = cl.study(plant, controllers=[getattr(cl.design, design)(plant)])
    data = live_of(result)
    values = bolder(data["controllers"][0], 1.3)
    asked = {"kind": "run", "run": 1, "controller": 0, "values": values}
    *_, analysed = report_session(result, data)(messages=[asked])
    chosen = result.ranking[0].controller
    names = [each.name for each in chosen.law.parameters]
    bold = chosen.with_values(dict(zip(names, values, strict=True)))
    expected = sampled_loop(bold, linearise(result.point)).maximum_sensitivity
    assert math.isfinite(expected) and analysed["stable"]
    assert analysed["peak"] == pytest.approx(expected, rel=1e-6)
