"""Schemes that cannot work are refused, each with its place and what to do."""

import pytest
from scheme_rig import FLOW, LEVEL, PUMP

from clepsydra import InputError, PidForm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock


def loop(name, form=None, outer=None):
    setpoint = outer or "level.sp"
    return PidBlock(
        name, name, form or PidForm(), LEVEL, PUMP, setpoint, inner=outer is not None, direct=False
    )


def refused(*blocks):
    with pytest.raises(InputError) as caught:
        structure_law("scheme", blocks, setpoints={"level": LEVEL}, measured=[LEVEL, FLOW])
    return caught.value


def test_loops_that_give_each_other_their_setpoints_run_in_a_circle():
    error = refused(
        loop("first", outer="second"), loop("second", outer="first"), loop("third"),
        OutputBlock(PUMP, "third"),
    )  # fmt: skip
    assert error.place == "control scheme scheme, first"
    assert "first" in str(error.value) and "second" in str(error.value)
    assert "third" not in str(error.value)
    assert "circle" in error.expected and error.remedy


@pytest.mark.parametrize("selection", ["low", "high"])
@pytest.mark.parametrize("anti_windup", ["conditional_integration", "clamping", "none"])
@pytest.mark.parametrize("algorithm", ["isa", "series", "parallel"])
@pytest.mark.parametrize("waiting", [0, 1])
def test_an_override_without_tracking(selection, anti_windup, algorithm, waiting):
    bad = PidForm("PI", algorithm, anti_windup=anti_windup)
    names = ["level_loop", "flow_loop"]
    error = refused(
        *(loop(name, bad if i == waiting else None) for i, name in enumerate(names)),
        SelectorBlock("selected", tuple(names), selection),
        OutputBlock(PUMP, "selected"),
    )
    assert error.place == f"control scheme scheme, {names[waiting]}, anti_windup"
    assert error.value == anti_windup
    assert "back_calculation" in error.expected and "selected" in error.expected
    assert 'anti_windup = "back_calculation"' in error.remedy


def test_an_override_behind_another_one_needs_tracking_too():
    bad = PidForm(anti_windup="none")
    error = refused(
        loop("a"), loop("b", bad), loop("c"),
        SelectorBlock("inner", ("a", "b"), "low"), SelectorBlock("outer", ("inner", "c"), "high"),
        OutputBlock(PUMP, "outer"),
    )  # fmt: skip
    assert error.place == "control scheme scheme, b, anti_windup"


@pytest.mark.parametrize(
    "form",
    [PidForm("P", anti_windup="none"), PidForm("PI", "velocity", anti_windup="none"), PidForm()],
    ids=["no-integral", "velocity", "tracking"],
)
def test_an_override_of_what_cannot_wind_up_is_accepted(form):
    structure_law(
        "scheme",
        [
            loop("a", form), loop("b", form),
            SelectorBlock("selected", ("a", "b"), "low"), OutputBlock(PUMP, "selected"),
        ],
        setpoints={"level": LEVEL}, measured=[LEVEL, FLOW],
    )  # fmt: skip


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"actions": "ID"}, "PID form, actions"),
        ({"algorithm": "ideal"}, "PID form, algorithm"),
        ({"derivative_on": "setpoint"}, "PID form, derivative_on"),
        ({"error": "cubed"}, "PID form, error"),
        ({"anti_windup": "off"}, "PID form, anti_windup"),
        ({"actions": "P", "algorithm": "velocity"}, "PID form, actions"),
        ({"actions": "PD", "algorithm": "velocity"}, "PID form, actions"),
        ({"error": "gap", "algorithm": "series"}, "PID form, error"),
        ({"error": "squared", "algorithm": "velocity"}, "PID form, error"),
    ],
)
def test_a_form_that_does_not_exist(options, words):
    with pytest.raises(InputError) as caught:
        PidForm(**options)
    assert caught.value.place == words
    assert caught.value.value in options.values()
    assert caught.value.remedy
