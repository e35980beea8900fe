"""What a report computes while one drags, beside Python: every bit of an unfused kernel's curves.

The messages between page and worker are written down, so that all digits of a curve are there.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.engine.kernel import Kernel
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.figures import figures_of
from clepsydra.report.html import _shown_first
from clepsydra.report.overlay import event_windows, shown_signals
from clepsydra.report.quantities import display_factor
from clepsydra.studies.judge import Judge
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.trial import trial_of
from clepsydra.studies.tuning.resting_states import rested_elsewhere
from clepsydra.studies.warnings.loop_response import loop_response

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
    const columns = asked[0].data.columns.map(each => each.title);
    return JSON.stringify({ last, ran, analysed, columns }, (_, value) =>
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


def changed(candidate, values, model):
    """Return a controller of a study with other values, at rest."""
    controller = candidate.controller
    names = [each.name for each in controller.law.parameters]
    other = replace(controller, values=dict(zip(names, values, strict=True)))
    loops = Loop(controller, model), Loop(other, model)
    return replace(other, initial_state=rested_elsewhere(*loops))


def unfused(result, controller, substeps, model):
    """Return the runs of a loop by a kernel that fuses nothing."""
    loop = Loop(controller, model)
    program = closed_loop(
        result.process, controller, substeps=substeps, constant=loop.fixed(result.scenario),
        readings=True,
    )  # fmt: skip
    found = Kernel(program, fuse=False).run(
        result.scenario.samples,
        inputs=loop.inputs_of(result.scenario),
        state=loop.initial_state(),
        parameters=loop.law_parameters(),
    )
    return {signal.name: found.output(signal.name)[0] for signal in program.outputs}


@pytest.mark.parametrize("presses", [["ArrowRight"], ["PageUp", "PageUp"], ["PageDown"]], ids=str)
def test_curves_scores_and_margins_are_those_of_python(studied, presses, opened):
    result, path = studied
    page = opened(path, first=WRITTEN_DOWN)
    told = dragged(page, presses)
    model = linearise(result.point)
    first = _shown_first(result, recommend(result.ranking, result.accept))
    candidate, values = first[told["last"]["controller"]], told["last"]["values"]
    own = [candidate.controller.values[each.name] for each in candidate.controller.law.parameters]
    assert values != own
    controller = changed(candidate, values, model)
    run = Loop(controller, model).run(result.scenario, substeps=candidate.run.substeps)
    bits = unfused(result, controller, candidate.run.substeps, model)
    signals = shown_signals(result)
    for window, curves in zip(
        event_windows(result, signals, first), told["ran"]["curves"], strict=True
    ):
        for shown, curve in zip(signals, curves, strict=True):
            expected = shown.values(run)[window.samples]
            span = max(np.ptp(shown.values(run)), 1e-12)
            assert np.max(np.abs(curve - expected)) <= 1e-9 * span, shown.name
            exact = of_kernel(shown, bits)[window.samples]
            assert np.array_equal(np.array(curve).view(np.int64), exact.view(np.int64)), shown.name
    assert_figures(result, controller, run, told)
    assert_margins(controller, model, told["analysed"])


def of_kernel(shown, bits):
    """Return a row of charts of a kernel's outputs, in display units."""
    name = shown.signal.name
    for own in (f"{name}.true" if name == shown.measurement else name, f"{name}.running"):
        if own in bits:
            found = bits[own]
    return found * display_factor(shown.signal)


def assert_figures(result, controller, run, told):
    """Compare the numbers of the ranking's columns with those of a trial."""
    trial = trial_of(controller, linearise(result.point), result.scenario, run=run)
    best = [each for each in result.ranking if each.standing is result.ranking[0].standing]
    judge = Judge(result.ranking[0], best, ())
    criteria = judge.criteria(trial)
    least = result.ranking[0].mean_error
    expected = {f"{title}, × best": value for title, value in criteria.items()}
    expected |= {
        "relative error": float(np.mean(list(criteria.values()))) / least,
        "total variation, × least": judge.wear(trial),
    }
    for figure in figures_of(result.process):
        worst = figure.worst(result.process, trial)
        if worst is not None:
            scale = 100.0 if figure.is_share else 1.0
            expected[figure.title] = scale * figure.compared(result.process, *worst)
    columns = told["columns"]
    compared = 0
    for title, value in zip(columns, told["ran"]["numbers"], strict=True):
        if title in expected:
            compared += 1
            assert value == pytest.approx(expected[title], rel=1e-6, abs=1e-9), title
    assert compared >= 4


def assert_margins(controller, model, analysed):
    """Compare max|S| and margins with those of the sampled loop."""
    loop = sampled_loop(controller, model)
    assert analysed["stable"] == loop.is_stable
    assert analysed["peak"] == pytest.approx(loop.maximum_sensitivity, rel=1e-6)
    expected = margin_table(loop_response(controller, model)) if loop.is_stable else {}
    assert [each["name"] for each in analysed["margins"]] == list(expected)
    for each in analysed["margins"]:
        numbers = expected[each["name"]]
        keys = {"gain": "gain margin", "phase": "phase margin [deg]", "delay": "delay margin [s]",
                "crossover": "crossover [rad/s]"}  # fmt: skip
        for own, key in keys.items():
            assert each[own] == pytest.approx(numbers[key], rel=1e-6, nan_ok=True), (key, each)


def test_noise_above_what_the_ranking_calls_quiet_is_told(report, opened):
    page = opened(report("quadruple-tank"))
    page.get_by_text("Try other settings", exact=True).last.click()
    panel = page.locator("#live")
    panel.get_by_role("row", name="max|S|").wait_for()
    assert panel.get_by_text("Noise moves").count() == 0
    panel.get_by_role("slider").first.focus()
    for _ in range(6):
        page.keyboard.press("PageUp")
    told = panel.get_by_text("Noise moves a manipulated variable by")
    told.first.wait_for()
    assert "above 5\u00a0% (recommended" in told.first.inner_text()
