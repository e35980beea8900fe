"""A routine in every target: loops over arrays, the same bits as in the engine."""

import numpy as np
import pytest
from matiec import CompiledByMatiec, Matiec
from solved import by_lists, least, solving
from strucpp import CompiledByStrucpp, Strucpp
from test_random_exports import OddJob, proved
from tools import need, need_compiler, need_grammar, need_importer

from clepsydra import program_of
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.text.tree import StructuredTextError
from clepsydra.deploy.structured_text.printer import print_structured_text

SIZE, SIDES, SCANS = 4, 2, 200
#: What the compiler of OpenPLC cannot read.
TINY = 2.0**-900
#: L D Lᵀ as Golub and Van Loan print it, column by column.
FACTORS = """\
FOR k := 0 TO 3 DO
  pivot[k] := matrix[5 * k];
  FOR j := 0 TO k - 1 DO
    pivot[k] := pivot[k] - lower[4 * k + j] * lower[4 * k + j] * pivot[j];
  END_FOR;
  FOR i := k + 1 TO 3 DO
"""


#: The same for systems that leave `FOR j := 0 TO 0` before its only turn.
FACTORS_BY_WHILE = """\
FOR k := 0 TO 3 DO
  pivot[k] := matrix[5 * k];
  j := 0;
  WHILE j <= k - 1 DO
    pivot[k] := pivot[k] - lower[4 * k + j] * lower[4 * k + j] * pivot[j];
    j := j + 1;
  END_WHILE;
  i := k + 1;
  WHILE i <= 3 DO
"""


def scans(sides: int = SIDES) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    random = np.random.default_rng(7)
    a = random.normal(size=(SCANS, SIZE, SIZE))
    a = a @ a.transpose(0, 2, 1) + np.eye(SIZE)
    b = random.normal(size=(SCANS, SIZE, sides))
    named = {f"a_{i}_{j}": a[:, i, j] for i in range(SIZE) for j in range(SIZE)}
    return a, b, named | {f"b_{i}_{j}": b[:, i, j] for i in range(SIZE) for j in range(sides)}


def bits(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=float).view(np.int64)


def test_the_engine_solves_as_lists_do():
    a, b, named = scans()
    expected = [np.concatenate([x.ravel(), pivot]) for x, pivot in map(by_lists, a, b)]
    found = engine_run(program_of(solving(SIZE, SIDES)), named)
    assert np.array_equal(bits(found), bits(np.array(expected)))


def test_it_reads_as_in_a_textbook():
    program = program_of(solving(SIZE, SIDES))
    assert FACTORS in print_structured_text(program)
    assert FACTORS_BY_WHILE in print_structured_text(program, dialect="matiec")
    assert "for (int32_t i = k + 1; i < 4; ++i) {" in print_c(program).source


def test_no_turn_of_a_loop_hangs_on_a_for_that_a_system_leaves_out():
    """Loops of one turn: of the only right side, and inside of every other loop."""
    need_grammar()
    program, (_, _, named) = program_of(solving(SIZE, 1)), scans(1)
    found = InterpretedText(program, dialect="matiec").run(named)
    assert np.array_equal(bits(found), bits(engine_run(program, named)))
    usual = InterpretedText(program, dialect="matiec", text=print_structured_text(program))
    with pytest.raises(StructuredTextError, match="a FOR from 0 to 0"):
        usual.run(named)


@pytest.mark.parametrize("law", [solving(3, 1), least(2, 4)], ids=["solving", "least"])
def test_odd_numbers_give_the_same_in_every_target(law):
    """Pivots of zero, what is not a number, what is too large: C, three dialects, FMU."""
    need_compiler()
    need_grammar()
    need_importer()
    item = ProofItem(law.name, 1.0, program_of(law))
    proved(item, ("C", "Structured Text, codesys", "Structured Text", "FMU 3.0"), job=OddJob)


def test_what_is_known_is_a_table_of_the_text():
    program = program_of(solving(2, 1, np.array([[4.0, 2.0], [2.0, 3.0]])))
    assert "matrix : ARRAY[0..3] OF LREAL := [4.0, 2.0, 2.0, 3.0]" in print_structured_text(program)
    given = {"b_0_0": np.array([2.0, 0.0]), "b_1_0": np.array([5.0, 0.0])}
    need("tree_sitter_iec61131_3_st")
    for each in (engine_run(program, given), InterpretedText(program).run(given)):
        assert each.tolist() == [[-0.5, 2.0, 4.0, 2.0], [0.0, 0.0, 4.0, 2.0]]


def test_a_number_that_a_system_cannot_read_is_assigned():
    """As a product, where the others of its array are there from the beginning."""
    program = program_of(solving(2, 1, np.array([[np.nan, 0.0], [TINY, 0.5]])))
    text = print_structured_text(program, dialect="matiec")
    assert "matrix : ARRAY[0..3] OF LREAL := [0.0, 0.0, 0.0, 0.5];" in text
    assert "matrix[2] := small_number;" in text
    need("tree_sitter_iec61131_3_st")
    given = {"a_0_0": TINY, "b_0_0": 2 * TINY, "b_1_0": 3 * TINY}
    given = {name: np.array([value]) for name, value in given.items()}
    run = InterpretedText(program, dialect="matiec").run(given)
    assert run.tolist() == [[2.0, 2 * TINY, TINY, 0.5]]


@pytest.mark.thorough
@pytest.mark.parametrize("sides", [1, SIDES])
@pytest.mark.parametrize("compiler", ["matiec", "STruC++"])
def test_compilers_of_openplc_take_it(compiler, sides, tmp_path):
    program, (_, _, named) = program_of(solving(SIZE, sides)), scans(sides)
    if compiler == "matiec":
        Matiec()
        found = CompiledByMatiec(program, tmp_path).run(named)
    else:
        Strucpp()
        found = CompiledByStrucpp(program, tmp_path).run(named)
    assert np.array_equal(bits(found), bits(engine_run(program, named)))
