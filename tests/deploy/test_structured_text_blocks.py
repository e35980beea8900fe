"""Structured Text of a law of blocks: a function block each, printed once, with the same bits."""

import re

import casadi as ca
import numpy as np
import pytest
from families import family
from law_of_blocks import FILTER, law_of_blocks
from plants import plant
from structured_text_programs import plcopen_of
from tools import need_grammar

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.deploy.structured_text.project import Project, print_test_project
from clepsydra.engine.kernel import Kernel
from clepsydra.program.block import Block
from clepsydra.program.counted_loop import Table, counted_loop
from clepsydra.program.reader import program_of, structured_program_of
from clepsydra.program.step_law import Equations, step_law

SCANS = 400


def scans():
    random = np.random.default_rng(3)
    return {
        "u": random.normal(1.0, 1.0, SCANS),
        "cold": (random.random(SCANS) < 0.05) * 1.0,
        "most": random.integers(0, 9, SCANS) * 1.0,
    }


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_function_blocks_compute_the_bits_of_the_flat_block(dialect, precision):
    need_grammar()
    law, inputs = law_of_blocks(), scans()
    found = InterpretedText(structured_program_of(law), precision, dialect).run(inputs)
    flat = InterpretedText(program_of(law), precision, dialect).run(inputs)
    assert np.ptp(found[:, 0]) > 1.0 and set(found[:, 1]) == {0.0, 1.0}
    np.testing.assert_array_equal(found, flat)


def test_function_blocks_compute_the_bits_of_the_kernel():
    need_grammar()
    law, inputs = law_of_blocks(), scans()
    found = InterpretedText(structured_program_of(law)).run(inputs)
    run = Kernel(program_of(law)).run(SCANS, inputs=inputs)
    for column, name in enumerate(("y", "high")):
        np.testing.assert_array_equal(found[:, column], run.output(name)[0])


@pytest.mark.parametrize("name", ["PI, variable structure", "Feedback linearisation"])
def test_no_variable_is_called_by_a_letter_and_a_number(name):
    """What the law gives no name is named by what it is; 1e300 stands once a block, with a name."""
    program = family(name)[1].program
    source = print_c(program)
    for text in (print_structured_text(program), source.source):
        assert not re.findall(r"\bt\d+\b", text)
        assert re.search(r"\b(sum|difference|condition)(_\d+)?\b", text)
    blocks = print_structured_text(program).split("END_FUNCTION_BLOCK")
    assert max(block.count("1.0E300") for block in blocks) == 1
    assert all("largest_number : LREAL := 1.0E300" in b for b in blocks if "E300" in b)


@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_instances_of_a_block_share_a_declaration_but_for_matiec(dialect):
    """It crashes on some declarations of several instances; those of several numbers it takes."""
    need_grammar()
    text = print_structured_text(family("PI, gain scheduling")[1].program, dialect=dialect)
    words = text.replace('"', "")
    blocks = re.findall(r"^FUNCTION_BLOCK (\w+)", words, re.MULTILINE)
    held = [re.findall(rf"^\s*(\w[^:;]*?) : {each}\b", words, re.MULTILINE) for each in blocks]
    alone = dialect == "matiec"
    assert (max(map(len, held)) > 1) == alone
    assert bool([names for found in held for names in found if "," in names]) != alone
    assert re.search(r"^\s*\w+, \w+.* : L?REAL", words, re.MULTILINE)


@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_a_block_is_printed_once_before_those_that_call_it(dialect):
    lines = print_structured_text(structured_program_of(law_of_blocks()), dialect=dialect).split(
        "\n"
    )
    titles = [line.replace('"', "") for line in lines if line.startswith("FUNCTION_BLOCK")]
    assert titles == [
        "FUNCTION_BLOCK FB_Filter",
        "FUNCTION_BLOCK FB_FilterPair",
        "FUNCTION_BLOCK two_filters",
    ]
    assert max(map(len, lines)) <= 100


def test_a_state_is_declared_where_it_lives():
    *_, main = print_structured_text(structured_program_of(law_of_blocks())).split("\n\n")
    assert "kept" not in main.partition("END_VAR\nVAR RETAIN")[2].partition("END_VAR")[0]


def test_plcopen_has_a_pou_for_each_block():
    text = plcopen_of(structured_program_of(law_of_blocks()))
    assert text.count("<pou ") == 3 and '<derived name="FB_Filter" />' in text


def test_a_test_project_carries_the_blocks():
    program, process = (
        structured_program_of(law_of_blocks()),
        process_program(plant("three-tanks").point, 1),
    )
    text = print_test_project(Project(program, process, {}, 1.0))
    titles = [line for line in text.split("\n") if line.startswith(("FUNCTION_BLOCK", "PROGRAM"))]
    assert len(titles) == 5 and titles[0] == "FUNCTION_BLOCK FB_Filter"


def test_two_blocks_of_one_name_are_refused():
    other = Block(
        "filter", (Signal("x"),), (), (Signal("y"),), lambda s: Equations({}, {"y": s["x"]})
    )
    with pytest.raises(ValueError, match="two different blocks have the name filter"):
        print_structured_text(structured_program_of(law_of_blocks(other)))


def test_a_port_may_be_a_word_of_the_system():
    """RAMP is a function block that comes with matiec."""
    need_grammar()
    block = Block(
        "adder", (Signal("hysteresis"),), (Signal("ramp"),), (Signal("integral"),),
        lambda s: Equations({"ramp": s["ramp"] + s["hysteresis"]}, {"integral": s["ramp"]}),
    )  # fmt: skip

    def equations(s):
        found = block("sum", {"hysteresis": s["u"]}, {"ramp": s["x"]})
        return Equations({"x": found.next_state["ramp"]}, {"y": found.outputs["integral"]})

    law = step_law(
        "totals", inputs=[Signal("u")], parameters=[], state=[Signal("x", initial=2.0)],
        outputs=[Signal("y")], equations=equations,
    )  # fmt: skip
    inputs = {"u": scans()["u"]}
    found = InterpretedText(structured_program_of(law), dialect="matiec").run(inputs)
    np.testing.assert_array_equal(found, InterpretedText(program_of(law)).run(inputs))


@pytest.mark.parametrize(("instance", "name"), [("total", "total"), ("sum_total", "sum.total")])
def test_an_instance_may_have_the_name_of_a_signal(instance, name):
    """As in a block whose integral is computed by another block, called integral."""
    need_grammar()

    def equations(s):
        found = FILTER(instance, {"x": s["u"], "share": 0.5, "most": 3.0}, s)
        total = found.outputs["y"]
        return Equations(found.next_state, {"y": total * total + total}, {name: total})

    law = step_law(
        "adder", inputs=[Signal("u")], parameters=[], state=FILTER.state,
        outputs=[Signal("y")], equations=equations,
    )  # fmt: skip
    inputs = {"u": scans()["u"]}
    found = InterpretedText(structured_program_of(law), dialect="scl").run(inputs)
    np.testing.assert_array_equal(found, InterpretedText(program_of(law)).run(inputs))


def graded(words=None):
    """A block with a named real, a named integer, and a number that has no name."""
    told = {"span": "how far it is from the rest", "y": "the grade, (* never above the top *)"}

    def equations(s):
        span = ca.fabs(s["x"] - 0.3)
        y = ca.if_else(s["most"] < 7, span * 0.3 + 0.7, 0.7)
        return Equations({}, {"y": y}, {"span": span}, told if words is None else words)

    named = (
        Signal("rest", "m", initial=0.3, description="level at rest; operating point"),
        Signal("top", initial=7.0, kind="integer", description="the highest grade"),
        Signal("not_there", initial=11.0),
    )
    given = Signal("x"), Signal("most", low=0, high=99, kind="integer")
    return Block("graded", given, (), (Signal("y"),), equations, (), named)


@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_numbers_with_a_meaning_are_constants_and_steps_have_words(dialect):
    program = structured_program_of(law_of_blocks(graded()))
    text = print_structured_text(program, dialect=dialect)
    block = text.partition("FB_Graded")[2].partition("END_FUNCTION_BLOCK")[0].replace("#", "")
    opening, closing = ("// ", "") if dialect == "scl" else ("(* ", " *)")
    constants = block.partition("VAR CONSTANT")[2].partition("END_VAR")[0]
    assert constants.split("\n")[1:-1] == [
        f"  rest : LREAL := 0.3; {opening}[m]; level at rest; operating point{closing}",
        f"  top : DINT := 7; {opening}[1]; the highest grade{closing}",
    ]
    lines = block.split("\n")
    assert "0.3" not in block.replace(constants, "") and "not_there" not in block
    above = {line.partition(" :=")[0]: lines[k - 1] for k, line in enumerate(lines)}
    assert above["span"] == f"{opening}how far it is from the rest{closing}"
    assert f"{opening}the grade, ( * never above the top * ){closing}" in lines


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_named_constants_change_no_bit(dialect, precision):
    need_grammar()
    law, inputs = law_of_blocks(graded()), scans()
    found = InterpretedText(structured_program_of(law), precision, dialect).run(inputs)
    flat = InterpretedText(program_of(law), precision, dialect).run(inputs)
    np.testing.assert_array_equal(found, flat)


def test_words_of_what_is_not_computed_are_refused():
    with pytest.raises(ValueError, match=r"words for \['z'\]"):
        structured_program_of(law_of_blocks(graded({"z": "the last letter"})))


def test_loops_read_stretches_of_named_tables():
    """Two loops over parts of a named table and one over other numbers, in every precision."""
    need_grammar()
    share = Table("share", (0.1, 0.2, 0.7, 1.3, 2.9), 3, "share of each tank")

    def weighed(s):
        row, total, u = (ca.SX.sym(name) for name in ("row", "total", "u"))
        turn = ca.Function("turn", [row, total, u], [total + row * u])
        found = ca.SX(0)
        for name, numbers in (("low", (0.2, 0.7)), ("high", (1.3, 2.9)), ("other", (0.7, 0.2))):
            found = counted_loop(name, 2, turn, carried=found, tables=[numbers], invariants=s["u"])
        return Equations({}, {"y": found})

    block = Block("weigh", (Signal("u"),), (), (Signal("y"),), weighed, tables=(share,))
    ports = {"inputs": block.inputs, "outputs": block.outputs, "parameters": (), "state": ()}
    law = step_law("law", **ports, equations=lambda s: block("scale", s, {}))
    program, inputs = structured_program_of(law), {"u": scans()["u"]}
    text = print_structured_text(program)
    assert "share : ARRAY[0..4] OF LREAL := [0.1, 0.2, 0.7, 1.3, 2.9]; (* share of each" in text
    assert "other_table : ARRAY[0..1] OF LREAL := [0.7, 0.2];" in text
    for turns, entry in (("4 TO 5", "share[i - 3]"), ("6 TO 7", "share[i - 3]"), ("0 TO 1", "i]")):
        body = text[text.index(f"FOR i := {turns} DO") :]
        assert entry in body[: body.index("END_FOR")]
    expected = Kernel(program_of(law)).run(SCANS, inputs=inputs).output("y")[0]
    np.testing.assert_array_equal(InterpretedText(program).run(inputs)[:, 0], expected)
    single = InterpretedText(program, "single").run(inputs)[:, 0]
    assert np.ptp(single - expected) > 0.0
    np.testing.assert_allclose(single, expected, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("changed", [None, 7])
def test_numbers_are_computed_only_where_every_bit_is_theirs(changed):
    """Points at equal distances and a degree on lines over them, and both off by one bit."""
    need_grammar()
    points = np.linspace(-1.0, 3.0, 21)
    degrees = np.maximum(0.0, np.minimum(0.5 * (points + 1.0), 0.8 * (2.0 - points)))
    if changed:
        points[changed], degrees[changed] = np.nextafter((points[changed], degrees[changed]), 9.0)
    tables = (
        Table("point", tuple(points.tolist())),
        Table("degree", tuple(degrees.tolist()), 0, "", "point", ((0.5, -1.0), (-0.8, 2.0))),
    )

    def weighed(s):
        row, total, u = ca.SX.sym("row", 2), ca.SX.sym("total"), ca.SX.sym("u")
        turn = ca.Function("turn", [row, total, u], [total + row[0] * ca.fmin(row[1], u)])
        numbers = [table.values for table in tables]
        found = counted_loop("sum", 21, turn, carried=ca.SX(0), tables=numbers, invariants=s["u"])
        return Equations({}, {"y": found})

    block = Block("weigh", (Signal("u"),), (), (Signal("y"),), weighed, tables=tables)
    ports = {"inputs": block.inputs, "outputs": block.outputs, "parameters": (), "state": ()}
    law = step_law("law", **ports, equations=lambda s: block("scale", s, {}))
    program, inputs = structured_program_of(law), {"u": scans()["u"]}
    text = print_structured_text(program)
    assert ("point := 0.2 * DINT_TO_LREAL(i) - 1.0;" in text) is (changed is None)
    assert ("0.5 * (point + 1.0)" in text) is (changed is None)
    assert text.count("ARRAY[0..20]") == (2 if changed else 0)
    expected = Kernel(program_of(law)).run(SCANS, inputs=inputs).output("y")[0]
    np.testing.assert_array_equal(InterpretedText(program).run(inputs)[:, 0], expected)
