"""The name that was probably meant."""

import inspect

import pytest

import clepsydra as cl
from clepsydra.base.suggestion import suggestion

OF_A_LOOP = ["gain", "integral_time", "derivative_time", "derivative_filter", "setpoint_weight"]


@pytest.mark.parametrize(
    ("symbol", "meant"),
    [
        ("K", "gain"),
        ("Kp", "gain"),
        ("KC", "gain"),
        ("Ti", "integral_time"),
        ("ti", "integral_time"),
        ("Tn", "integral_time"),
        ("Td", "derivative_time"),
        ("Tv", "derivative_time"),
        ("b", "setpoint_weight"),
    ],
)
def test_a_symbol_of_a_loop_leads_to_its_key(symbol, meant):
    assert suggestion(symbol, OF_A_LOOP, "choose one") == f"perhaps '{meant}' was meant"


@pytest.mark.parametrize("symbol", ["tau_c", "lambda", "lambda_", "Tcl"])
@pytest.mark.parametrize("design", ["simc", "lambda_", "disturbance_rejection", "fuzzy_pi"])
def test_a_symbol_leads_to_the_argument_of_a_design(symbol, design):
    found = suggestion(
        symbol, inspect.signature(getattr(cl.design, design)).parameters, "choose one"
    )
    assert found == "perhaps 'closed_loop_time_constant' was meant"


def test_a_name_leads_to_the_symbol_of_a_table():
    assert suggestion("Kp", ["K", "Ti", "b"], "choose one") == "perhaps 'K' was meant"
    assert suggestion("integral_time", ["K", "Ti"], "choose one") == "perhaps 'Ti' was meant"


def test_a_symbol_of_nothing_known_leads_nowhere():
    assert suggestion("Td", ["pairing", "form"], "choose one") == "choose one"


@pytest.mark.parametrize(
    ("verb", "call"),
    [
        ("processes", "catalogue"),
        ("papers", "audit"),
        ("designs", "design"),
        ("new", "new_process"),
    ],
)
def test_a_verb_of_the_command_line_leads_to_its_call(verb, call):
    assert suggestion(verb, cl.__all__, "choose one") == f"perhaps '{call}' was meant"
