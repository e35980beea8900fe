"""Single precision that leaves the simulation is marked; an unstable law is compared by scans."""

import numpy as np
import pytest
from spoilt_programs import FMUS, TEXTS, quick_proof
from tools import need_compiler, need_grammar, need_importer

import clepsydra as cl
from clepsydra import Signal
from clepsydra.deploy.proof.words import result_sentence
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

U, Y = Signal("u", low=0.0, high=0.1), Signal("y", low=0.0, high=0.1)


#: All but C.
OTHERS = (*TEXTS, "Structured Text", *FMUS)


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


def constant(target: int, value: float) -> Operation:
    return Operation(target, "constant", (), value)


def test_what_diverges_is_marked_and_named(monkeypatch):
    """y = (u + 1e9) - 1e9: a single holds 1e9 in steps of 64."""
    lost = Program(
        "lost", (), (U,), (), (Y,),
        Block(1, (constant(1, 1e9), Operation(2, "add", (0, 1)), Operation(3, "subtract", (2, 1))),
              (3,)),
    )  # fmt: skip
    found = quick_proof(monkeypatch, lost, without=OTHERS)
    (row,) = found.diverging
    assert (row.target, row.precision, row.verdict) == ("C", "single", "diverges")
    assert found.holds and not found.failures
    name = row.subject
    said = result_sentence(found)
    assert said.startswith("The proof holds in double precision: ")
    assert said.endswith(f"In single precision {name} diverges from the simulation.")
    assert "does not follow the simulation: C in single precision (y is " in screen_text(found)


def screen_text(found) -> str:
    return " ".join(str(cl.Proof(**vars(found))).split())


def test_a_law_that_is_unstable_by_itself_is_compared_in_single_scans(monkeypatch):
    """x⁺ = 2.1 x + u - 0.9 w, with w the x of two scans ago, begun anew where u is small."""
    x, ring = Signal("x", low=0.0, high=0.1), DelayRing(Signal("w", low=0.0, high=0.1), 2)
    block = Block(
        3,
        (constant(3, 2.1), constant(4, 0.9), constant(5, 0.002), constant(6, 0.0),
         Operation(7, "multiply", (0, 3)), Operation(8, "add", (7, 2)),
         Operation(9, "multiply", (1, 4)), Operation(10, "subtract", (8, 9)),
         Operation(11, "less", (2, 5)), Operation(12, "select", (11, 6, 10))),
        (12, 0, 12), frozenset({11}),
    )  # fmt: skip
    found = quick_proof(
        monkeypatch, Program("grows", (x, ring), (U,), (), (Y,), block), without=OTHERS
    )
    row = found.rows[-1]
    assert (row.target, row.precision, row.verdict) == ("C", "single", "reported")
    # A few roundings of numbers within ten ranges.
    assert 0.0 < row.largest < 40 * np.finfo(np.float32).eps
    assert "the law magnifies every rounding, in double precision too" in row.reason
    assert result_sentence(found).startswith("The proof holds: ")
    assert not found.diverging
