"""What a report carries to run its loops again, run by a host that nobody here wrote."""

from dataclasses import replace

import numpy as np
import pytest
from hosted_report import law_at_rest, live_of, run, sums
from tools import need

import clepsydra as cl
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linearise import linearise
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.program.step_law import Equations, step_law
from clepsydra.report.live.sliders import bolder, sliders
from clepsydra.report.overlay import shown_signals
from clepsydra.studies.result import StudyResult

PROCESSES = [each.name for each in cl.catalogue()]
#: Of the range; the native kernel fuses multiplications into additions.
FUSED = 1e-9


@pytest.fixture(scope="module", params=PROCESSES)
def studied(request):
    need("wasmtime")
    result = cl.study(request.param)
    data = live_of(result)
    if data is None:
        pytest.skip(f"no setting of {request.param} moves")
    return result, data


def changed(live, factor):
    """Return the values of a controller made bolder, and each of its settings moved."""
    values = np.array(live["values"])
    for place, power in live["bolder"]:
        values[place] *= factor**power
    for loop in live["loops"]:
        for setting in loop["settings"]:
            if setting["logarithmic"]:
                values[setting["values"]] *= factor**0.5
            else:
                values[setting["values"]] = 0.6
    return values.tolist()


def close(found, expected, span):
    return np.max(np.abs(found - expected)) <= FUSED * max(span, np.ptp(expected))


@pytest.mark.sampled
def test_a_page_finds_what_the_ranking_has(studied):
    result, data = studied
    for live in data["controllers"]:
        candidate = result.ranking[live["controller"]]
        record, state = run(data, live, live["values"])
        for shown, place in zip(shown_signals(result), live["signals"], strict=True):
            if place is not None:
                found = record[:, place["column"]] * place["factor"]
                expected = shown.values(candidate.run)
                span = shown.signal.span * place["factor"]
                assert close(found, expected, span if np.isfinite(span) else 0.0), shown.name
        for key, value in sums(live, state).items():
            assert value == pytest.approx(candidate.scores[key], rel=1e-6, abs=1e-9), key


@pytest.mark.sampled
def test_a_page_runs_changed_settings_as_a_loop_does(studied):
    result, data = studied
    model = linearise(result.point)
    for live in data["controllers"]:
        candidate = result.ranking[live["controller"]]
        law, values = candidate.controller.law, changed(live, 0.8)
        named = dict(zip((each.name for each in law.parameters), values, strict=True))
        begun = law_at_rest(data, live, values).tolist()
        states = dict(zip((entry.name for entry in law.state), begun, strict=True))
        moved = replace(candidate.controller, values=named, initial_state=states)
        expected = Loop(moved, model).run(result.scenario, substeps=candidate.run.substeps)
        record, _ = run(data, live, values)
        for shown, place in zip(shown_signals(result), live["signals"], strict=True):
            if place is not None:
                span = shown.signal.span * place["factor"]
                assert close(
                    record[:, place["column"]] * place["factor"],
                    shown.values(expected),
                    span if np.isfinite(span) else 0.0,
                ), shown.name


def test_a_changed_setting_begins_where_with_values_begins():
    need("wasmtime")
    result = cl.study("quadruple-tank")
    data = live_of(result)
    live = data["controllers"][0]
    controller = result.ranking[live["controller"]].controller
    setting = live["loops"][0]["settings"][0]
    assert setting["symbol"] == "K"
    words = f"{2.0 * setting['value']!r} {setting['unit']}"
    expected = controller.with_values({live["loops"][0]["loop"]: {"K": words}})
    values = list(live["values"])
    for place in setting["values"]:
        values[place] = 2.0 * setting["value"] * setting["factor"]
    found = law_at_rest(data, live, values).tolist()
    names = [entry.name for entry in controller.law.state]
    assert dict(zip(names, found, strict=True)) == pytest.approx(expected.initial_state, rel=1e-12)


def test_a_law_without_a_state_has_sliders_and_its_run_is_that_of_python():
    need("wasmtime")
    plant = cl.load("three-tanks")
    pi = cl.design.simc(plant)
    gain = cl.Signal("level_3.proportional_gain", "m^3/s/m", low=0.0, high=1.0)
    at_rest = cl.Signal("feed.bias", "m^3/s", low=0.0, high=1.0)
    law = step_law(
        "proportional", inputs=pi.law.inputs, parameters=[at_rest, gain], state=[],
        outputs=pi.law.outputs,
        equations=lambda s: Equations({}, {
            "feed.out": s[at_rest.name] + s[gain.name] * (s["level_3.sp"] - s["level_3.pv"]),
            "feed.status": 1.0,
        }),
    )  # fmt: skip
    values = {at_rest.name: plant.point.as_dict()["feed"], gain.name: 1e-3}
    wires = pi.measurements, pi.setpoints, pi.manipulated
    own = Controller("P", "own", "As it was found.", law, values, {}, *wires)
    result = cl.study(plant, controllers=[own])
    data = live_of(result)
    (live,) = data["controllers"]
    (shown, *_), (place, *_) = shown_signals(result), live["signals"]
    record, _ = run(data, live, live["values"])
    expected = shown.values(result.ranking[0].run)
    assert close(record[:, place["column"]] * place["factor"], expected, 0.0)


def test_a_run_that_does_not_begin_at_rest_has_no_sliders():
    plant = cl.load("three-tanks")
    result = cl.study(plant, controllers=[cl.design.simc(plant)])
    begin = cl.simulate(plant, cl.design.simc(plant), start="empty").scenario.begin
    scenario = scenario_of_changes(plant.point, [], result.scenario.samples, begin=begin)
    assert isinstance(result, StudyResult)
    assert live_of(replace(result, scenario=scenario)) is None


def test_a_factor_makes_the_poles_of_feedback_linearisation_faster_by_it():
    plant = cl.load("quadruple-tank")
    controller = cl.design.feedback_linearisation(plant)
    names = [each.name for each in controller.law.parameters]
    powers = {names[place]: power for place, power in bolder(controller)}
    gain, integral = (
        controller.values[f"level_1.virtual_{each}"] for each in ("gain", "integral_gain")
    )
    bold = [value * 2.0 ** powers[f"level_1.virtual_{each}"]
            for each, value in (("gain", gain), ("integral_gain", integral))]  # fmt: skip
    np.testing.assert_allclose(np.roots([1.0, *bold]), 2.0 * np.roots([1.0, gain, integral]))


def test_the_gain_of_a_direct_loop_has_no_sign_on_its_slider():
    plant = cl.load("wet-well")
    (loop,) = sliders(cl.design.simc(plant))
    gain = loop["settings"][0]
    assert gain["value"] > 0.0 > gain["factor"]
    assert gain["low"] < gain["value"] < gain["high"]
    assert gain["least"] == 0.0


@pytest.mark.parametrize("design", ["fuzzy_pi", "lqi_extended_kalman"])
def test_a_law_whose_slopes_are_no_program_has_sliders_without_margins(design):
    plant = cl.load("three-tanks")
    result = cl.study(plant, controllers=[getattr(cl.design, design)(plant)])
    (live,) = live_of(result)["controllers"]
    assert live["slopes"] is None and live["bolder"]
