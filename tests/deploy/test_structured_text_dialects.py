"""What the dialects of Structured Text write differently, and that they compute the same."""

import dataclasses
import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refused
from structured_text_programs import every_kind, flow_of_pipe, pipe
from tools import need

from clepsydra import InputError, Signal
from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES, dialect_of
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.deploy.structured_text.statements import StructuredText
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

FLOAT = st.floats(width=32, allow_nan=False, allow_infinity=False)


def wording(dialect: str, precision="double") -> StructuredText:
    return StructuredText(dialect_of(dialect), precision)


def doubling(name: str, kind: str = "real", initial: float = 0.0) -> Program:
    block = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    entry = Signal(name, kind=kind, initial=initial)
    return Program("law", (), (entry,), (), (Signal("y"),), block)


def applied(code: str, *more: Operation, arguments: tuple[int, ...] = (0,)) -> Program:
    block = Block(1, (*more, Operation(9, code, arguments)), (9,))
    return Program("law", (), (Signal("u"),), (), (Signal("y"),), block)


CODESYS = """\
FUNCTION_BLOCK every_kind
VAR_INPUT
  (* inputs of one sample *)
  u : LREAL := 0.5; (* [m] 0 to 2 *)
  good : BOOL := FALSE; (* truth value *)
  (* parameters *)
  gain : LREAL := 0.3; (* [V/m]; found by hand *)
END_VAR
VAR_OUTPUT
  y : LREAL; (* [V] *)
  then_u : LREAL; (* [m] *)
  fine : BOOL; (* truth value *)
END_VAR
VAR RETAIN
  count : DINT := -2; (* [1]; scans so far; found by hand *)
  late : ARRAY[0..2] OF LREAL := [0.25, 0.25, 0.25]; (* [m]; delayed by 3 samples; at rest *)
  late_position : DINT := 0; (* [1] place of the oldest value *)
END_VAR
"""
TABLE = "weights_table : ARRAY[0..3] OF LREAL := [1.0, 0.5, 0.25, 0.1];"
#: Where the system reads 1e300, what is not a number is told by a constant with a name.
CONSTANTS = {
    "codesys": f"""\
VAR CONSTANT
  (* numbers *)
  largest_number : LREAL := 1.0E300; (* [1]; a value beyond it is not a number *)
  (* tables *)
  {TABLE}
END_VAR
""",
    "matiec": f"VAR CONSTANT {TABLE} END_VAR\n",
}
ORIGIN = Origin("The law", "a tank", "By hand.", 1.0, {"late": "at rest"}, "found by hand")


def test_the_interface_in_every_dialect():
    texts = {name: print_structured_text(every_kind(), origin=ORIGIN, dialect=name)
             for name in DIALECT_NAMES}  # fmt: skip
    assert all(CODESYS + constants in texts[name] for name, constants in CONSTANTS.items())
    assert texts["codesys"].count("1.0E300") == 1
    for text in texts.values():
        opened = text.rpartition("END_FUNCTION\n")[2] if text == texts["scl"] else text
        head = " ".join(line.strip("(*/ )") for line in opened.splitlines()[:13])
        assert "The law for a tank, sampled every 1 s." in head and "Design: By hand." in head
    scl = texts["scl"]
    title, optimised, version, *rest = scl[scl.index("FUNCTION_BLOCK") :].splitlines()
    assert title == 'FUNCTION_BLOCK "every_kind"'
    assert (optimised, version) == ("{ S7_Optimized_Access := 'TRUE' }", "VERSION : 0.1")
    assert rest[0].startswith("// every_kind: one sample")
    assert (
        "  late : ARRAY[0..2] OF LREAL := [0.25, 0.25, 0.25]; // [m]; delayed by 3" in texts["scl"]
    )
    assert "(*" not in texts["scl"] and texts["scl"].count("VAR CONSTANT") == 1
    assert re.search(r"VAR CONSTANT\s+largest_number : LREAL := 1.0E300;", texts["scl"])
    assert "VAR weights_table : ARRAY[0..3]" in texts["scl"]


def test_scl_marks_each_local_name_and_nothing_else():
    functions, _, statements = print_structured_text(every_kind(), dialect="scl").rpartition(
        "BEGIN\n"
    )
    locals_ = ["u", "good", "gain", "y", "then_u", "fine", "count", "late", "late_position"]
    for line in statements.splitlines()[:-1]:
        code = line.partition("//")[0]
        for name in re.findall(r"[A-Za-z_]\w*", re.sub(r"LREAL#[-\d.E]+", "", code)):
            marked = f"#{name}" in code
            given = f"{name} := " in code.partition("FC_Min")[2]  # an input of the function
            function = name.isupper() or name.startswith(("DINT_TO", "LREAL_TO", "FC_")) or given
            assert marked != function, (name, line)
        for name in locals_:
            assert not re.search(rf"(?<!#)\b{name}\b", code), line
    assert "TRUNC_DINT(" in functions and "LREAL#-0.1" in statements


def test_a_single_turn_is_no_loop():
    """matiec would leave it before its first turn."""
    text = print_structured_text(every_kind())
    assert text.count("FOR ") == 1 and "(* single: 1 turn *)" in text


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_every_dialect_computes_the_same(dialect, precision):
    need("tree_sitter_iec61131_3_st")
    real = np.float64 if precision == "double" else np.float32
    block = InterpretedText(every_kind(), precision, dialect)
    drawn = np.random.default_rng(7).uniform(-2e9, 2e9, 20)
    given = [0.5, -0.5, 1.75, -2.25, math.nan, math.inf, -0.0, 8388607.5, -1e30, *drawn.tolist()]
    kept, count = [real(0.25)] * 3, -2
    for k, u in enumerate(map(real, given)):
        count = min(count + 1, 3)
        total = real(0.0)
        for weight in (1.0, 0.5, 0.25, 0.1):
            total = total + real(weight) * real(0.3)
        expected = total + real(7.0) + np.floor(u) * real(-0.1)
        good = k % 2 == 0
        y, then_u, fine = block({"u": float(u), "good": float(good)})
        assert np.array_equal(real(y), expected, equal_nan=True)
        assert real(then_u) == kept.pop(0) or math.isnan(then_u)
        assert bool(fine) == (good and bool(np.isfinite(u)))
        kept.append(u)
        assert block.state()[0] == count


@given(FLOAT)
@settings(max_examples=60, deadline=None)
def test_rounding_in_single_precision(value):
    need("tree_sitter_iec61131_3_st")
    for code, function in (("floor", np.floor), ("ceiling", np.ceil)):
        block = ROUNDING.setdefault(code, InterpretedText(applied(code), "single"))
        found, expected = np.float32(block({"u": value})[0]), function(np.float32(value))
        assert found.tobytes() == expected.tobytes()


ROUNDING: dict[str, InterpretedText] = {}


@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_rings_of_loops(dialect):
    need("tree_sitter_iec61131_3_st")
    given = np.random.default_rng(2).normal(size=40)
    found = InterpretedText(pipe(), dialect=dialect).run({"u": given})[:, 0]
    assert found.tolist() == flow_of_pipe(given.tolist())


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_that_matiec_cannot_read_are_exact_products(value):
    words = wording("matiec")
    text = words.literal(value)
    if not words.products:
        assert float(text) == value and (value == 0 or 2.0**-126 <= abs(value) < 2.0**128)
        return
    ((name, (number, factors)),) = words.products.items()
    assert text == name and number == value
    product = float(factors[0])
    for factor in factors[1:]:
        assert 2.0**-126 <= float(factor) < 2.0**128
        product *= float(factor)
    assert product == value and 2.0**-126 <= abs(float(factors[0])) < 2.0**128


def test_numbers_with_and_without_type():
    number = Expression("add", (variable("x"), Expression("constant", number=np.float32(-0.1))))
    assert wording("codesys").expression(number) == f"x + ({float(np.float32(-0.1))!r})"
    for dialect in DIALECT_NAMES:
        assert wording(dialect, "single").expression(number) == "x + REAL#-0.1"
    truth = variable("x").to("boolean")
    assert wording("codesys", "single").expression(truth) == "x <> REAL#0.0"


def test_the_power_of_scl_is_an_operator():
    power = Expression("pow", (Expression("add", (variable("a"), variable("b"))), variable("c")))
    times = Expression("multiply", (variable("d"), power))
    assert wording("scl").expression(times) == "d * ((a + b) ** c)"
    assert wording("codesys").expression(times) == "d * EXPT(a + b, c)"


def test_the_absolute_value_of_a_negative_zero():
    size = Expression("absolute", (variable("x"),))
    compared = Expression("less", (size, variable("limit")))
    assert wording("matiec").expression(size) == "ABS(x) + 0.0"
    assert wording("matiec").expression(compared) == "ABS(x) < limit"
    assert wording("codesys").expression(size) == "ABS(x)"
    assert wording("matiec").assign("y", size) == ["y := ABS(x) + 0.0;"]


@pytest.mark.parametrize("dialect", DIALECT_NAMES)
def test_functions_that_no_system_has_without_libraries(dialect):
    for code in ("atan2", "tanh", "hypot"):
        arguments = (0,) if code == "tanh" else (0, 0)
        with pytest.raises(InputError, match=f"operation {code}"):
            print_structured_text(applied(code, arguments=arguments), dialect=dialect)


def test_words_and_names_of_one_dialect():
    for word, refusing in (("integral", "matiec"), ("Ramp", "matiec"), ("ST", "codesys")):
        with refused(expected="no word of Structured Text"):
            print_structured_text(doubling(word), dialect=refusing)
        for other in set(DIALECT_NAMES) - {refusing}:
            print_structured_text(doubling(word), dialect=other)
    long = dataclasses.replace(doubling("u"), name="a" * 126)
    print_structured_text(long)
    with refused(expected="at most 125 characters for Siemens TIA Portal"):
        print_structured_text(long, dialect="scl")


def test_what_is_no_dialect_and_no_precision():
    with refused(place="dialect", value="st", expected="one of matiec, codesys, scl"):
        print_structured_text(doubling("u"), dialect="st")
    with refused(place="precision", value="half"):
        print_structured_text(doubling("u"), precision="half")


def test_initial_values_that_matiec_cannot_read():
    for value in (1e300, -1e-50):
        program = doubling("u", initial=value)
        assert f"u : LREAL := {'1.0E300' if value > 0 else '-1.0E-50'};" in print_structured_text(
            program
        )
        with refused(place="initial value of u", expected="OpenPLC and Beremiz"):
            print_structured_text(program, dialect="matiec")
    with refused(remedy="print it in double precision"):
        print_structured_text(doubling("u", initial=1e39), precision="single")


@pytest.mark.thorough
@pytest.mark.parametrize("precision", ["double", "single"])
def test_codesys_text_parses_under_the_grammar_of_twincat(precision):
    need("blark")
    from blark.parse import parse_source_code

    text = print_structured_text(every_kind(), origin=ORIGIN, precision=precision)
    assert parse_source_code(text).exception is None
    assert parse_source_code(text.replace("END_IF", "END_ID")).exception is not None


def test_lines_are_no_longer_than_they_need_be():
    for dialect in ("codesys", "matiec"):
        text = print_structured_text(every_kind(), origin=ORIGIN, dialect=dialect)
        assert max(map(len, text.splitlines())) <= 100
