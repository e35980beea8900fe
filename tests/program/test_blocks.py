"""Blocks kept in a program compute what they compute in place."""

import casadi as ca
import numpy as np
import pytest
from refusals import refused

from clepsydra.base.signal import Signal
from clepsydra.engine.kernel import Kernel
from clepsydra.program.block import Block
from clepsydra.program.owned_state import with_owned_state
from clepsydra.program.reader import program_of, structured_program_of
from clepsydra.program.step_law import Equations, step_law

FILTER = Block(
    "filter",
    (Signal("x"), Signal("share")),
    (Signal("kept", initial=3.0), Signal("scans", low=0, high=9, kind="integer")),
    (Signal("y"), Signal("high", kind="boolean")),
    lambda s: Equations(
        {
            "kept": s["kept"] + s["share"] * (s["x"] - s["kept"]),
            "scans": ca.fmin(8, ca.fmax(0, s["scans"])) + 1,
        },
        {"y": 2 * s["kept"] + s["scans"], "high": s["kept"] > 1},
    ),
)
STATE = (
    Signal("a", initial=3.0),
    Signal("n", kind="integer"),
    Signal("b", initial=4.0),
    Signal("m", kind="integer"),
)


def _two(s):
    first = FILTER("first", {"x": s["x"], "share": 0.5}, {"kept": s["a"], "scans": s["n"]})
    given = {"x": first.outputs["y"] * first.outputs["high"], "share": s["share"]}
    second = FILTER("second", given, {"kept": s["b"], "scans": s["m"]})
    following = [*first.next_state.values(), *second.next_state.values()]
    names = [signal.name for signal in STATE]
    return Equations(dict(zip(names, following, strict=True)), {"y": second.outputs["y"]})


PAIR = Block("pair", (Signal("x"), Signal("share")), STATE, (Signal("y"),), _two)


def _begun(s, condition, first):
    """The states of a sample, or where a condition holds their first values."""
    return {name: ca.if_else(condition, value, s[name]) for name, value in first.items()}


def _law(*, shown: bool = False):
    """The pair with a cold start; where `shown`, state b is also read beside it."""

    def equations(s):
        first = {"a": 3.0, "n": 0.0, "b": 4.0, "m": 0.0}
        pair = PAIR("pair", {"x": s["u"], "share": s["share"]}, _begun(s, s["cold"], first))
        beside = s["b"] if shown else 0.0
        return Equations(pair.next_state, {"y": pair.outputs["y"] + beside})

    return step_law(
        "law",
        inputs=[Signal("u"), Signal("cold", kind="boolean")],
        parameters=[Signal("share", initial=0.25)],
        state=STATE,
        outputs=[Signal("y")],
        equations=equations,
    )


@pytest.mark.parametrize("shown", [False, True])
def test_calls_compute_the_bits_of_the_flat_program(shown):
    law = _law(shown=shown)
    random = np.random.default_rng(1)
    inputs = {"u": random.normal(size=60), "cold": (random.random(60) < 0.1) * 1.0}
    structured = structured_program_of(law)
    forms = [program_of(law), structured, with_owned_state(structured)]
    flat, *kept = [Kernel(form).run(60, inputs=inputs).output("y")[0] for form in forms]
    assert np.ptp(flat) > 1.0
    for found in kept:
        np.testing.assert_array_equal(found, flat)


def test_a_block_is_one_program_however_often_it_is_called():
    (pair,) = with_owned_state(structured_program_of(_law())).calls
    first, second = pair.program.calls
    assert first.program == second.program
    assert [signal.name for signal in pair.program.state] == ["a", "n", "b", "m"]


def test_what_is_read_beside_a_call_stays_with_the_caller():
    (pair,) = with_owned_state(structured_program_of(_law(shown=True))).calls
    assert [signal.name for signal in pair.program.state] == ["a", "n", "m"]
    assert [signal.name for signal in pair.program.outputs] == ["y", "next_b"]
    (second,) = (call for call in pair.program.calls if call.instance == "second")
    assert [signal.name for signal in second.program.state] == ["scans"]


def test_an_instance_is_told_where_its_state_begins():
    (pair,) = with_owned_state(structured_program_of(_law())).calls
    names = [signal.name for signal in pair.program.inputs]
    assert names == ["x", "share", "restart", "start_a", "start_b"]


def _restarted(first_scans: float, condition=lambda s: s["cold"]):
    """A filter that the law restarts."""

    def equations(s):
        first = {"kept": 3.0, "scans": first_scans}
        given = {"x": s["u"], "share": 0.5}
        found = FILTER("filter", given, _begun(s, condition(s), first))
        return Equations(found.next_state, found.outputs)

    return step_law(
        "law",
        inputs=[Signal("u"), Signal("cold", kind="boolean")],
        parameters=[],
        state=FILTER.state,
        outputs=FILTER.outputs,
        equations=equations,
    )


@pytest.mark.parametrize(("first", "owned"), [(0.0, ["kept", "scans"]), (2.0, ["kept"])])
def test_a_whole_number_that_begins_otherwise_than_its_block_says_stays_with_the_caller(
    first, owned
):
    (call,) = with_owned_state(structured_program_of(_restarted(first))).calls
    assert [signal.name for signal in call.program.state] == owned


def test_a_truth_value_of_a_block_restarts_another_as_it_is():
    over = Block(
        "over", (Signal("x"),), (), (Signal("high", kind="boolean"),),
        lambda s: Equations({}, {"high": s["x"] > 1}),
    )  # fmt: skip

    def high(s):
        return over("over", {"x": s["u"]}, {}).outputs["high"]

    law = _restarted(0.0, high)
    first, second = with_owned_state(structured_program_of(law)).calls
    place = [signal.name for signal in second.program.inputs].index("restart")
    assert second.arguments[len(FILTER.state) + place] == first.targets[0]


def called(instance="first", state=None, **inputs):
    given = {"x": ca.SX.sym("x"), "share": ca.SX(0.5)} | inputs
    kept = {"kept": ca.SX.sym("kept"), "scans": ca.SX.sym("scans")} if state is None else state
    return FILTER(
        instance, {name: value for name, value in given.items() if value is not None}, kept
    )


@pytest.mark.parametrize(
    ("wrong", "place", "value", "remedy"),
    [
        ({"share": None}, "", "no value for share", "wire the port"),
        ({"state": {"kept": ca.SX(3)}}, "", "no value for scans", "wire the port"),
        ({"x": ca.SX.sym("x", 2)}, ", x", "2 by 1 values", "wire one of them"),
    ],
)
def test_a_block_that_is_wired_wrongly_says_where(wrong, place, value, remedy):
    whole = f"block filter, instance first{place}"
    with refused(place=whole, value=value, remedy=remedy):
        called(**wrong)


def test_two_instances_of_one_name_are_refused_where_they_are_printed():
    law = step_law(
        "twins", inputs=[Signal("u")], parameters=[], state=STATE, outputs=[Signal("y")],
        equations=lambda s: _twins(s),
    )  # fmt: skip
    with refused(place="twins, instances", value="same", expected="a name of its own"):
        structured_program_of(law)


def _twins(s):
    both = [
        FILTER("same", {"x": s["u"], "share": 0.5}, {"kept": s[kept], "scans": s[scans]})
        for kept, scans in (("a", "n"), ("b", "m"))
    ]
    following = [value for each in both for value in each.next_state.values()]
    names = [signal.name for signal in STATE]
    return Equations(
        dict(zip(names, following, strict=True)), {"y": both[0].outputs["y"] + both[1].outputs["y"]}
    )
