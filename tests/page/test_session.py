"""The worker's share of a live report, in Node: what it posts to the page."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hosted_report import live_of, run
from tools import need

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.linear.linearise import linearise
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.overlay import event_windows, shown_signals

from .conftest import source

#: A session whose clock goes on by `given.step` whenever it is looked at; while it breathes, the
#: messages of `given.later` come in, one at a time.
SCRIPT = f"""
import {{ Session }} from "{source("live/session.ts")}";
const posted = [];
const later = [...given.later ?? []];
let now = 0;
const session = new Session({{
  post: (message) => posted.push(message),
  now: () => (now += given.step ?? 0),
  breathe: async () => {{ if (later.length) void session.take(later.shift()); }},
}});
{{}}
await session.take({{ kind: "load", data: given.data, samples: given.samples }});
for (const message of given.messages ?? []) await session.take(message);
answer(posted);
"""
#: Of the range; the native kernel fuses multiplications into additions, a module does not.
FUSED = 1e-9
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
    """The events that the report shows."""
    result, data = studied
    first = [result.ranking[live["controller"]] for live in data["controllers"]]
    return event_windows(result, shown_signals(result), first)


@pytest.fixture
def session(studied, windows, node):
    """Run a session with the study's data, and return what it posts."""
    _, data = studied
    starts = zip(windows, data["starts"], strict=True)
    samples = [(window.samples - start).tolist() for window, start in starts]

    def posted(before="", **given):
        script = SCRIPT.replace("{}\n", f"{before}\n", 1)
        return node(script, {"data": data, "samples": samples, **given})

    return posted


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


@pytest.mark.parametrize("controller", [0, 1])
def test_it_finds_again_what_the_report_says(controller, runs, asked, studied, windows):
    result, data = studied
    live = data["controllers"][controller]
    candidate = result.ranking[live["controller"]]
    ran, analysed = runs(asked(7, controller))
    assert (ran["kind"], ran["run"], ran["controller"]) == ("ran", 7, controller)
    assert ran["whole"] and ran["samples"] == result.scenario.samples
    for window, curves in zip(windows, ran["curves"], strict=True):
        for signal, found in zip(shown_signals(result), curves, strict=True):
            expected = signal.values(candidate.run)
            far = np.abs(np.array(found) - expected[window.samples])
            assert np.max(far) <= FUSED * np.ptp(expected)
    expected = [number_of(column, live, candidate) for column in data["columns"]]
    assert ran["numbers"] == pytest.approx(expected, rel=1e-6, nan_ok=True)
    assert sum(math.isnan(number) for number in expected) == 1  # the peak
    (limit,), (moved,) = ran["limits"], result.process.inputs
    saturated = candidate.scores[f"time_in_saturation[{moved.name}]"]
    assert limit["name"] == moved.name
    assert limit["low"] + limit["high"] == pytest.approx(saturated, abs=1e-6)
    assert analysed["stable"] and analysed["run"] == 7
    assert analysed["peak"] == pytest.approx(candidate.maximum_sensitivity, rel=2 * RISE)
    told = margin_table(candidate.response)
    margins = {
        each["name"]: [each[key] for key in ("gain", "phase", "crossover", "delay", "peak")]
        for each in analysed["margins"]
    }
    assert list(margins) == list(told)
    numbers = [list(each.values()) for each in told.values()]
    np.testing.assert_allclose(list(margins.values()), numbers, rtol=1e-9)


def number_of(column, live, candidate):
    """Return what the report has in a column, in the unit that the page shows."""
    if column["kind"] == "figure":
        return max(
            candidate.scores[live["scores"][part["score"]]["key"]] * part["scale"]
            for part in column["parts"]
        )
    wear, error = candidate.wear, candidate.relative_error
    return {"relative error": error, "total variation, × least": wear}.get(
        column["title"], candidate.criteria.get(column["title"].removesuffix(", × best"), math.nan)
    )


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
