"""Every formula of the documents that is called right stops being so with one thing changed in it.

What is printed is changed in each of its letters, numbers and signs, and what is derived by less
than a floating point shows.
"""

import ast
import re
from contextlib import suppress
from fractions import Fraction
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from clepsydra import papers
from clepsydra.papers.averaging_tank import closed_loops, model
from clepsydra.papers.averaging_tank.symbols import K1, K2, s
from clepsydra.papers.eight_tanks import polynomials
from clepsydra.papers.exact_matrix import inverse, matrix
from clepsydra.papers.four_tank_variable_structure import linearisation
from clepsydra.papers.printed import Printed
from clepsydra.papers.rational_function import RationalFunction, exact, symbols
from clepsydra.papers.row import Row
from clepsydra.papers.three_tanks import PRINTED as THREE_TANKS
from clepsydra.papers.three_tanks import equations

TINY = Fraction(1, 10**40)
#: Those that compare formulas.
EXPERIMENTS = sorted(
    f"{path.parent.name}.{path.stem}"
    for path in Path(papers.__file__).parent.glob("*/*.py")
    if re.search(r"\.formula(s|_in)?\(", path.read_text("utf-8"))
)


def rows_of(found):
    return {row.name: row for row in found if isinstance(row, Row)}


SUMS = {ast.Add: ast.Sub, ast.Sub: ast.Add}
PRODUCTS = {ast.Mult: ast.Div, ast.Div: ast.Mult}


def changed(text, swaps=SUMS | PRODUCTS, others=lambda name: [f"other_{name}"]):
    """Return a formula with each name, number and sign changed in turn."""
    for place, _ in enumerate(ast.walk(ast.parse(text))):
        tree = ast.parse(text)
        node = [*ast.walk(tree)][place]
        match node:
            case ast.Name(id=name):
                for other in others(name):
                    node.id = other
                    yield ast.unparse(tree)
                continue
            case ast.Constant(value=number):
                node.value = number + 1
            case ast.BinOp(op=sign) if type(sign) in swaps:
                node.op = swaps[type(sign)]()
            case ast.UnaryOp(operand=operand):
                node.operand = ast.UnaryOp(ast.USub(), operand)
            case _:
                continue
        yield ast.unparse(tree)


@pytest.fixture
def compared(monkeypatch):
    """Every formula that an experiment compares: its line, what was derived, and its names."""
    found = []
    formula = Printed.formula

    def kept(line, computed, *, names=None):
        found.append((line, computed, names))
        return formula(line, computed, names=names)

    monkeypatch.setattr(Printed, "formula", kept)

    def of(experiment):
        tuple(import_module(f"clepsydra.papers.{experiment}").run())
        monkeypatch.undo()
        return found

    return of


@pytest.mark.sampled
@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_no_formula_stays_right_with_one_thing_changed_in_it(experiment, compared):
    right = 0
    for line, computed, names in compared(experiment):
        noted = Printed(line.place, line.name, line.line, line.text, note="Changed.")
        if noted.formula(computed, names=names).verdict != "reproduced":
            continue
        right += 1
        assert noted.formula(computed + TINY, names=names).verdict == "misprint"
        if computed != 0:
            assert noted.formula(computed * (1 + TINY), names=names).verdict == "misprint"
        for text in changed(line.text):
            other = Printed(line.place, line.name, line.line, text, note="Changed.")
            assert other.formula(computed, names=names).verdict == "misprint", text
    assert right > 0


#: Matrices of one shape, which may stand in each other's place.
ALIKE = ("APQ", "BX", "Ru")


def alike(name):
    return [other for shape in ALIKE for other in shape if name in shape and other != name]


@pytest.fixture(scope="module")
def judged():
    """The formulas in matrices: their names, text, and what was derived."""
    found = []

    class Kept(equations.Symbols):
        def judged(self, line, right, derived):
            found.append((line, dict(self.names), derived))
            return super().judged(line, right, derived)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(equations, "Symbols", Kept)
        tuple(equations.run())
    return found


def test_no_formula_in_matrices_stays_right_with_one_thing_changed_in_it(judged):
    assert len(judged) == 9
    of = equations.Symbols()
    for line, names, derived in judged:
        of.names, compared = names, 0
        assert of.are_equal(line.text, derived)
        assert not of.are_equal(line.text, derived + TINY)
        for text in changed(line.text, SUMS, alike):
            with suppress(ValueError, ZeroDivisionError):  # no product of these shapes
                assert not of.are_equal(text, derived), text
                compared += 1
        assert compared >= 4
        with pytest.raises(AssertionError):
            of.judged(line, f"2*({line.text})", derived)


def test_a_wrong_transfer_function_of_the_three_tanks_is_a_misprint(monkeypatch):
    for wrong in changed(THREE_TANKS["(5)", "G(s)"].text):
        line = Printed("(5)", "G(s)", 1, wrong, note="Changed.")
        monkeypatch.setitem(THREE_TANKS, ("(5)", "G(s)"), line)
        assert next(iter(equations.run())).verdict == "misprint", wrong


def test_a_loop_that_is_not_stable_for_positive_gains_fails_its_claim():
    for below, holds in ((s + K1, True), (s - K1, False), (s**3 + s**2 + s + K1, False)):
        closed = matrix([[1 / (s + K2), 0], [0, 1 / below]])
        row = closed_loops._stability("(52)", closed, 1)
        assert (row.verdict == "claim holds") is holds
        assert f"K_p2 + s and {closed[1, 1].denominator}" in row.reason


def test_a_loop_of_which_the_example_is_stable_holds_its_claim():
    for below, holds in ((s - K2, True), (s + K2, False)):
        closed = matrix([[1 / (s + K1), 0], [0, 1 / below]])
        assert (closed_loops._stability("(69)", closed, -1).verdict == "claim holds") is holds


def test_an_error_that_stays_fails_the_claim_that_none_does(monkeypatch):
    name = "steady state, (60)"
    section = closed_loops._SECTIONS[0]
    assert rows_of(closed_loops._derivative(section))[name].verdict == "claim holds"
    monkeypatch.setattr(closed_loops, "_steady_state", lambda error: matrix([[0, 0], [0, TINY]]))
    assert rows_of(closed_loops._derivative(section))[name].verdict == "claim fails"


def test_a_pole_elsewhere_fails_the_claim_of_a_negative_gain(monkeypatch):
    section, name = closed_loops._SECTIONS[1], "stability without the gain of -1"
    assert rows_of(closed_loops._plain(section, section.p, K1, K2))[name].verdict == "claim holds"
    loop = closed_loops.closed_loop
    monkeypatch.setattr(
        closed_loops,
        "closed_loop",
        lambda variant, by: loop(variant, by @ matrix([[1, 0], [0, 1]]) * -1),
    )
    assert rows_of(closed_loops._plain(section, section.p, K1, K2))[name].verdict == "claim fails"


def with_zero(name):
    """Return `symbols` with one symbol that is zero."""
    return lambda names: tuple(
        exact(0) if each == name else symbol
        for each, symbol in zip(names.split(), symbols(names), strict=True)
    )


def test_without_evaporation_the_claim_about_it_fails(monkeypatch):
    assert model._evaporation().verdict == "claim holds"
    monkeypatch.setattr(model, "symbols", with_zero("z"))
    assert model._evaporation().verdict == "claim fails"


def test_the_printed_balance_at_rest_would_be_right_without_an_inflow(monkeypatch):
    def verdict():
        return next(row.verdict for row in model._at_rest() if row.name == "f_V at rest")

    assert verdict() == "misprint"
    same = symbols("f_out0 f_out0 C_in0 C_0 V_0")
    monkeypatch.setattr(model, "symbols", lambda names: same)
    assert verdict() == "reproduced"


def test_a_wrong_feedforward_gain_is_a_misprint(monkeypatch):
    assert polynomials._feedforward().verdict == "reproduced"
    root = RationalFunction.root
    monkeypatch.setattr(RationalFunction, "root", lambda of, name: root(of, name) + TINY)
    assert polynomials._feedforward().verdict == "misprint"


@pytest.fixture(scope="module")
def derived():
    return linearisation.Derived()


def test_a_decoupling_matrix_that_is_singular_or_hangs_on_a_level_fails_its_claim(derived):
    name = "determinant of E"
    assert rows_of(linearisation._decoupling(derived))[name].verdict == "claim holds"
    right, h = derived.E, derived.h[0]
    for wrong in (matrix([right[0], 2 * right[0]]), right * h):
        spoilt = linearisation.Derived()
        spoilt.E = wrong
        rows = {}
        with pytest.MonkeyPatch.context() as patch:
            # Its other rows have no reason for what is not so.
            patch.setattr(Printed, "formula", lambda line, computed, names=None: line.remark(""))
            rows = rows_of(linearisation._decoupling(spoilt))
        assert rows[name].verdict == "claim fails"


def test_the_factor_of_the_input_would_be_as_printed_where_nothing_moves(derived, monkeypatch):
    name = "derivative in which the input appears"
    assert rows_of(linearisation._decoupling(derived))[name].verdict == "misprint"
    monkeypatch.setattr(linearisation, "matrix", lambda entries: np.array([exact(0)] * 2))
    assert rows_of(linearisation._decoupling(derived))[name].verdict == "reproduced"


def test_relative_gains_of_another_pairing_are_not_those_printed(monkeypatch):
    monkeypatch.setattr(closed_loops, "inverse", lambda of: 2 * inverse(of))
    rows = rows_of(row for row, _ in zip(closed_loops.run(), range(4), strict=False))
    assert rows["RGA12"].verdict == rows["RGA21"].verdict == "not reproducible"
