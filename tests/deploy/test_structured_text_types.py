"""Integers and truth values of Structured Text compute what the engine computes with numbers."""

import operator
import random

import casadi as ca
import numpy as np
import pytest
from law_of_blocks import law_of_blocks
from tools import need_grammar

from clepsydra.base.signal import Signal
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.engine.kernel import Kernel
from clepsydra.program.program import Block, Program
from clepsydra.program.reader import program_of, structured_program_of
from clepsydra.program.step_law import Equations, step_law

SCANS = 40
KINDS = ("real", "boolean", "integer")


def _signals(letter, kinds):
    return [
        Signal(f"{letter}{k}", kind=kind, **({"low": 0, "high": 20} if kind == "integer" else {}))
        for k, kind in enumerate(kinds)
    ]


def _integer(value):
    # An integer has no negative zero.
    return ca.fmin(ca.fmax(value, 0), 20)


def _grown(choose, known):
    """Another value over known ones, and its kind."""

    def any_of(kind):
        return choose.choice(known[kind])

    def number():
        return any_of(choose.choice(KINDS))

    whole, truth, real = (lambda k=kind: any_of(k) for kind in ("integer", "boolean", "real"))
    rounded = choose.choice([ca.floor, ca.ceil])
    return choose.choice([
        lambda: ("boolean", number() < number()),
        lambda: ("boolean", whole() == choose.choice([0, 1, 7])),
        lambda: ("boolean", ca.logic_and(truth(), ca.logic_not(truth()))),
        lambda: ("boolean", ca.logic_or(truth(), truth())),
        lambda: ("boolean", whole() <= rounded(real())),
        lambda: ("boolean", rounded(real()) < whole()),
        lambda: ("integer", _integer(whole() + whole())),
        lambda: ("integer", _integer(whole() - whole())),
        lambda: ("integer", _integer(whole() * choose.choice([truth(), 3]))),
        lambda: ("integer", choose.choice([ca.fmin, ca.fmax])(whole(), whole())),
        lambda: ("integer", ca.if_else(truth(), whole(), choose.choice([whole(), 5]))),
        lambda: ("integer", ca.floor(whole() / choose.choice([2, 8]))),
        lambda: ("integer", _integer(4 * truth() + truth())),
        lambda: ("real", ca.if_else(truth(), number(), number() / number())),
        lambda: ("real", choose.choice([operator.add, operator.mul, ca.fmax])(number(), real())),
    ])()  # fmt: skip


def _law(seed):
    choose = random.Random(seed)
    inputs = [*_signals("u", (*KINDS, "real")), Signal("cold", kind="boolean")]
    state = _signals("x", [choose.choice(KINDS) for _ in range(4)])
    outputs = _signals("y", [choose.choice(KINDS) for _ in range(3)])

    def equations(s):
        known = {kind: [s[q.name] for q in inputs if q.kind == kind] for kind in KINDS}
        for signal in state:
            begun = ca.if_else(s["cold"], 0.0, s[signal.name])
            known[signal.kind].append(choose.choice([begun, s[signal.name]]))
        for _ in range(15):
            kind, value = _grown(choose, known)
            known[kind].append(value)
        following = {signal.name: choose.choice(known[signal.kind]) for signal in state}
        return Equations(
            following, {q.name: choose.choice(known[q.kind][1:] or known[q.kind]) for q in outputs}
        )

    return step_law(
        "typed", inputs=inputs, parameters=[], state=state, outputs=outputs, equations=equations
    )


@pytest.mark.parametrize("seed", range(40))
def test_values_in_their_types_are_those_of_the_engine(seed):
    need_grammar()
    program, numbers = program_of(_law(seed)), np.random.default_rng(seed)
    reals = numbers.normal(size=(2, SCANS)) * 5
    reals[numbers.random(reals.shape) < 0.1] = np.nan
    inputs = {
        "u0": reals[0], "u1": (numbers.random(SCANS) < 0.5) * 1.0, "u3": reals[1],
        "u2": numbers.integers(0, 21, SCANS) * 1.0, "cold": (numbers.random(SCANS) < 0.1) * 1.0,
    }  # fmt: skip
    run = Kernel(program).run(SCANS, inputs=inputs)
    expected = np.column_stack([run.output(signal.name)[0] for signal in program.outputs])
    for dialect in DIALECT_NAMES:
        found = InterpretedText(program, dialect=dialect).run(inputs)[:, : len(program.outputs)]
        np.testing.assert_array_equal(found, expected)
        signs = [np.signbit(np.where(np.isnan(each), 1.0, each)) for each in (found, expected)]
        np.testing.assert_array_equal(*signs)


def test_blocks_read_like_written_by_hand():
    """States begin in a line each and are read directly, and integers are limited as such."""
    _, filter_block, *_ = print_structured_text(structured_program_of(law_of_blocks())).split(
        "\n\n"
    )
    body = filter_block.split("END_VAR\n")[-1].split("\n")
    assert "IF restart OR NOT begun THEN kept := start_kept; END_IF;" in body
    assert "IF restart OR NOT begun THEN scans := 0; END_IF;" in body
    assert "scans := MIN(limited, 8) + 1;" in body
    assert "high := (kept > 1.0) OR (NOT restart AND begun AND was_high);" in body


def test_a_signal_may_be_called_as_a_parameter_of_sel():
    """Siemens wants the parameters of SEL by name; G is one of them, and here an input too."""
    need_grammar()
    law = step_law(
        "chosen",
        inputs=[Signal("g", kind="boolean"), Signal("in0"), Signal("in1")],
        parameters=[],
        state=[],
        outputs=[Signal("y")],
        equations=lambda s: Equations({}, {"y": 2 * ca.if_else(s["g"], s["in0"], s["in1"])}),
    )
    text = print_structured_text(program_of(law), dialect="scl")
    assert "#y := LREAL#2.0 * SEL(G := #g, IN0 := #in1, IN1 := #in0);" in text.split("\n")
    inputs = {"g": np.array([0.0, 1.0]), "in0": np.array([1.0, 2.0]), "in1": np.array([3.0, 4.0])}
    assert InterpretedText(program_of(law), dialect="scl").run(inputs).tolist() == [[6.0], [4.0]]


def test_a_name_that_is_longer_than_a_line_is_not_broken_in_two():
    need_grammar()
    names = "level", "x" * 130, "flow"
    block = Block(1, (), (0, 0, 0))
    program = Program("law", (), (Signal("u"),), (), tuple(map(Signal, names)), block)
    found = InterpretedText(program, dialect="codesys").run({"u": np.array([0.25])})
    assert found.tolist() == [[0.25, 0.25, 0.25]]
