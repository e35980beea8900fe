"""What a report computes while one drags, beside Python: every bit of an unfused kernel's curves.

The messages between page and worker are written down, so that all digits of a curve are there.
"""

import json
import re

import numpy as np
import pytest
from beside_python import Changed
from hosted_report import live_of, windows_of

import clepsydra as cl

pytestmark = pytest.mark.browser
#: One with four tanks, one with a tank that averages, and one with 56,800 samples.
PROCESSES = ["quadruple-tank", "equalisation-tank", "laboratory-four-tanks"]
WRITTEN_DOWN = """
const Plain = Worker;
window.asked = [];
window.said = [];
window.Worker = class extends Plain {
    constructor(...given) {
        super(...given);
        this.addEventListener("message", ({ data }) => said.push(data));
    }
    postMessage(message, ...more) {
        asked.push(message);
        super.postMessage(message, ...more);
    }
};
"""
LAST = """() => {
    const last = asked.filter(each => each.kind === "run").pop();
    const own = last ? said.filter(each => each.run === last.run) : [];
    const ran = own.find(each => each.kind === "ran" && each.whole);
    const analysed = own.find(each => each.kind === "analysed");
    if (!ran || !analysed) return null;
    return JSON.stringify({ last, ran, analysed }, (_, value) =>
        value instanceof Float64Array ? Array.from(value)
        : typeof value === "number" && !Number.isFinite(value) ? String(value) : value);
}"""


@pytest.fixture(scope="module", params=PROCESSES)
def studied(request, report):
    """A study, and where its report is."""
    return cl.study(request.param), report(request.param)


def dragged(page, presses):
    """Move every slider of the controller that is shown, and return what was computed of it."""
    page.get_by_text("Try other settings", exact=True).last.click()
    panel = page.locator("#live")
    panel.get_by_role("row", name="max|S|").wait_for()
    for slider in panel.get_by_role("slider").all():
        slider.focus()
        for press in presses:
            page.keyboard.press(press)
    found = page.wait_for_function(LAST).json_value()
    return read(found)


def read(text):
    words = {"NaN": np.nan, "Infinity": np.inf, "-Infinity": -np.inf}

    def number(value):
        if isinstance(value, dict):
            return {key: number(each) for key, each in value.items()}
        if isinstance(value, list):
            return [number(each) for each in value]
        return words.get(value, value) if isinstance(value, str) else value

    return number(json.loads(text))


@pytest.mark.parametrize("presses", [["ArrowRight"], ["PageUp", "PageUp"], ["PageDown"]], ids=str)
def test_curves_scores_and_margins_are_those_of_python(studied, presses, opened):
    result, path = studied
    told = dragged(opened(path, first=WRITTEN_DOWN), presses)
    data = live_of(result)
    changed = Changed(result, data, told["last"])
    assert told["last"]["values"] != data["controllers"][told["last"]["controller"]]["values"]
    changed.run()
    signals, windows = windows_of(result)
    for window, curves in zip(windows, told["ran"]["curves"], strict=True):
        for shown, curve in zip(signals, curves, strict=True):
            expected, bits = changed.curve(shown), changed.bits(shown)[window.samples]
            away = np.max(np.abs(curve - expected[window.samples]))
            assert away <= 1e-9 * max(np.ptp(expected), 1e-12), shown.name
            assert np.array_equal(np.array(curve).view(np.int64), bits.view(np.int64)), shown.name
    numbers, peak, margins = changed.judged(data["columns"])
    assert np.isfinite(numbers).sum() >= 4
    assert told["ran"]["numbers"] == pytest.approx(numbers, rel=1e-6, abs=1e-9, nan_ok=True)
    assert told["analysed"]["peak"] == pytest.approx(peak, rel=1e-6)
    assert [each["name"] for each in told["analysed"]["margins"]] == list(margins)
    for each in told["analysed"]["margins"]:
        found = [each[key] for key in ("gain", "phase", "crossover", "delay")]
        expected = list(margins[each["name"]].values())[:4]
        assert found == pytest.approx(expected, rel=1e-6, nan_ok=True), each["name"]


def test_noise_above_what_the_ranking_calls_quiet_is_told(report, opened):
    page = opened(report("quadruple-tank"))
    page.get_by_text("Try other settings", exact=True).last.click()
    panel = page.locator("#live")
    panel.get_by_role("row", name=re.compile(r"^max\|S\| \d")).wait_for()
    assert panel.get_by_text("Noise moves").count() == 0
    panel.get_by_role("slider").first.focus()
    for _ in range(6):
        page.keyboard.press("PageUp")
    told = panel.get_by_text("Noise moves a manipulated variable by")
    told.first.wait_for()
    assert "above 5\u00a0%" in told.first.inner_text()
