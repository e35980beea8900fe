"""The worker's share of whole reports, in Node: with the report's settings it finds its numbers."""

import math
from pathlib import Path

import numpy as np
import pytest
from hosted_report import live_of

import clepsydra as cl
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.overlay import shown_signals, shown_span

from .conftest import shown_windows

#: A plant whose analyser takes its time and reports once a minute.
SELDOM = f"{Path(__file__).parents[3] / 'docs' / 'examples' / 'analyser.toml'}:seldom"
#: Of the range; the native kernel fuses multiplications into additions, a module does not.
FUSED = 1e-9
#: Each search for a peak stops where a maximum can rise by no more than this share.
RISE = 1e-9


@pytest.mark.sampled
@pytest.mark.parametrize("process", [entry.name for entry in cl.catalogue()])
def test_it_finds_again_what_the_report_says(process, studied, report_session):
    result = studied(process)
    data = live_of(result)
    if data is None:
        pytest.skip("no setting of its first controllers moves")
    assert_found_again(result, data, report_session)


def test_it_finds_again_what_an_analyser_tells_late_and_seldom(report_session):
    plant = cl.load(SELDOM)
    result = cl.study(plant, controllers=[cl.design.simc(plant), cl.design.amigo(plant)])
    assert_found_again(result, live_of(result), report_session)


def assert_found_again(result, data, report_session):
    messages = [
        {"kind": "run", "run": place, "controller": place, "values": live["values"]}
        for place, live in enumerate(data["controllers"])
    ]
    response = result.ranking[data["controllers"][0]["controller"]].response
    session = report_session(result, data)
    ready, *posted = session(messages=messages, frequencies=response.frequencies.tolist())
    assert ready == {"kind": "ready"} and len(posted) == 2 * len(messages)
    for live, ran, analysed in zip(data["controllers"], posted[::2], posted[1::2], strict=True):
        candidate = result.ranking[live["controller"]]
        assert_same_run(result, candidate, live, ran)
        expected = [number_of(column, live, candidate) for column in data["columns"]]
        np.testing.assert_allclose(ran["numbers"], expected, rtol=1e-6, atol=1e-9)
        assert analysed["stable"]
        assert analysed["peak"] == pytest.approx(candidate.maximum_sensitivity, rel=2 * RISE)
        assert_same_margins(candidate, analysed)
    sizes = np.linalg.svd(response.at_output, compute_uv=False)[:, 0]
    np.testing.assert_allclose(posted[1]["sensitivity"], sizes, rtol=1e-9)


def assert_same_run(result, candidate, live, ran):
    assert ran["whole"] and ran["samples"] == result.scenario.samples
    signals = shown_signals(result)
    spans = [shown_span(signal.signal) for signal in signals]
    for window, curves in zip(shown_windows(result), ran["curves"], strict=True):
        for signal, span, place, found in zip(signals, spans, live["signals"], curves, strict=True):
            assert (found is None) is (place is None)
            if found is not None:
                expected = signal.values(candidate.run)
                far = np.abs(np.array(found) - expected[window.samples])
                assert np.max(far) <= FUSED * span, signal.name
    for limit in ran["limits"]:
        expected = candidate.scores[f"time_in_saturation[{limit['name']}]"]
        assert limit["low"] + limit["high"] == pytest.approx(expected, rel=1e-9)


def number_of(column, live, candidate):
    """Return what the report has in a column, in the unit that the page shows."""
    if column["kind"] == "figure":
        keys = [live["scores"][part["score"]]["key"] for part in column["parts"]]
        found = [
            candidate.scores[key] * part["scale"]
            for key, part in zip(keys, column["parts"], strict=True)
            if key in candidate.scores
        ]
        return max(found, default=math.nan)
    wear, error = candidate.wear, candidate.relative_error
    return {"relative error": error, "total variation, × least": wear}.get(
        column["title"], candidate.criteria.get(column["title"].removesuffix(", × best"), math.nan)
    )


def assert_same_margins(candidate, analysed):
    told, keys = margin_table(candidate.response), ("gain", "phase", "crossover", "delay", "peak")
    assert [each["name"] for each in analysed["margins"]] == list(told)
    found = [[each[key] for key in keys] for each in analysed["margins"]]
    np.testing.assert_allclose(found, [list(each.values()) for each in told.values()], rtol=1e-9)
