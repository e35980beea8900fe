"""Every law computes with its blocks called what it computes flat."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from pid_rig import name_of, winding_forms
from scan_rig import designed
from scheme_rig import SCHEMES
from test_every_law import APPLIES_TO, EVERY, recorded, tuned, whatever_all_bring

from clepsydra import InputError, PidForm
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.polynomial_controller import PolynomialShape
from clepsydra.controllers.smith_predictor import PredictorShape, smith_predictor_law
from clepsydra.controllers.variable_structure_pid import variable_structure_pid_law
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.printing.whole_numbers import check_whole_results
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.defaults import with_defaults
from clepsydra.program.owned_state import with_owned_state
from clepsydra.program.precision import in_precision
from clepsydra.program.program import Call
from clepsydra.program.reader import program_of, structured_program_of

FORMS = {name_of(form): form for form in winding_forms()} | {
    "ramp": PidForm(setpoint_ramp=True),
    "remote": PidForm("PID", remote_setpoint=True, setpoint_ramp=True),
    "gap": PidForm(error="gap"),
    "squared": PidForm("PID", error="squared"),
}


def is_refused(program, precision):
    try:
        check_whole_results(in_precision(program, precision), precision)
    except InputError:
        return True
    return False


def check_same(law, values, period):
    """Return the structured program, which computes what the flat one does."""
    flat, structured = (
        with_defaults(read(law), values) for read in (program_of, structured_program_of)
    )
    owned = with_owned_state(structured)
    random = np.random.default_rng(5)
    inputs = whatever_all_bring(flat, random, period)
    inputs |= {signal.name: tuned(signal, random) for signal in flat.parameters}
    expected = recorded(flat, inputs)
    assert np.ptp(expected, axis=0).max() > 0.0
    for kept in (structured, owned):
        np.testing.assert_array_equal(recorded(kept, inputs), expected)
    for precision in ("double", "single"):
        assert is_refused(owned, precision) <= is_refused(flat, precision)
    named = replace(structured, name=f"{structured.name}_law")
    assert print_structured_text(named) and print_c(named)
    instances = Counter(call.instance for call in structured.calls)
    assert set(instances.values()) == {1}
    check_one_of_a_name(owned)
    return structured


def check_one_of_a_name(program, known=None):
    """Blocks of one name are one block, within whatever it is called."""
    known = {} if known is None else known
    for call in program.block.statements:
        if isinstance(call, Call):
            assert known.setdefault(call.program.name, call.program) == call.program
            check_one_of_a_name(call.program, known)


@pytest.mark.parametrize("name", EVERY)
def test_the_law_of_every_design(name):
    controller, plant = designed(name, APPLIES_TO.get(name, "quadruple-tank"))
    values = {**controller.values, **controller.initial_state}
    check_same(controller.law, values, plant.process.sampling_period)


@pytest.mark.parametrize("rate_limited", [False, True])
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_two_loops_of_every_form_are_two_instances_of_one_block(form, rate_limited):
    law = multiloop_pid_law(
        ["level_1", "level_2"], ["pump_1", "pump_2"], form, rate_limited=rate_limited
    )
    first, second = check_same(law, {}, 1.0).calls[:2]
    assert first.program == second.program and first.instance != second.instance


@pytest.mark.parametrize("decoupling", ["static", "dynamic"])
def test_decoupled_loops(decoupling):
    check_same(
        multiloop_pid_law(["level_1", "level_2"], ["pump_1", "pump_2"], decoupling=decoupling),
        {},
        1.0,
    )


def test_variable_structure():
    check_same(
        variable_structure_pid_law(["level_1", "level_2"], ["pump_1", "pump_2"], PidForm("PID")),
        {},
        1.0,
    )


@pytest.mark.parametrize("scheme", SCHEMES)
def test_control_schemes(scheme):
    check_same(SCHEMES[scheme], {}, 1.0)


def test_smith_predictors_of_two_shapes():
    plain, integrating = PolynomialShape(2, 1, 1), PolynomialShape(1)
    shapes = [
        PredictorShape(plain, order=2, tail=3, delay=4),
        PredictorShape(integrating, order=1, tail=1, delay=0, error_feedback=True),
        PredictorShape(plain, order=2, tail=3, delay=7),
    ]
    law = smith_predictor_law(["level", "depth", "stage"], ["pump", "valve", "feed"], shapes)
    check_same(law, {p.name: 0.3 for p in law.parameters if p.initial == 0.0}, 1.0)
