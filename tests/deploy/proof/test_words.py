"""What a proof says of single precision, of refusals and of numbers that are none."""

import dataclasses
import math

import pytest
from spoilt_programs import FMUS, quick_proof
from tools import need_compiler, need_grammar, need_importer

from clepsydra import Signal
from clepsydra.deploy.proof.answer import findings
from clepsydra.deploy.proof.coverage import Coverage
from clepsydra.deploy.proof.row import Proof, ProofRow, row_of
from clepsydra.deploy.proof.words import notes, result_sentence
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

ROW = ProofRow("PI", "C", "single", "engine in double", "0f", 10_000, 1, verdict="reported")


def scored(ranking, score, change, is_change):
    scores = {"ranking": ranking, "score": score, "change": change, "is_change": is_change}
    return Proof((dataclasses.replace(ROW, scores=scores),))


@pytest.mark.parametrize(
    ("ranking", "score", "change", "is_change", "sentence"),
    [
        (1.00123, "iae[level_1]", 0.1049, False,
         "PI: single precision does not change the ranking: its number differs by 0.12 %; the "
         "score that changes most is iae[level_1], by 10 %"),
        (0.98, "iae[level_1]", 1.5, True,
         "PI: single precision changes the ranking: its number differs by 2 %; the score that "
         "changes most is iae[level_1], by 150 %"),
        (1.0 + 1e-9, "travel[pump_1]", 3.456e-5, False,
         "PI: single precision does not change the ranking: its number differs by less than "
         "0.0001 %; the score that changes most is travel[pump_1], by 0.0035 %"),
        (1.0, "", 0.0, False, "PI: single precision changes no score of the loop"),
        (1.0, "settling_time[level_1]", None, False,
         "PI: single precision does not change the ranking; settling_time[level_1] is finite in "
         "one precision only"),
        (None, "iae[level_1]", 0.5, True,
         "PI: single precision changes the ranking: its number is finite in one precision only; "
         "the score that changes most is iae[level_1], by 50 %"),
    ],
)  # fmt: skip
def test_what_single_precision_does_is_said_in_plain_numbers(
    ranking, score, change, is_change, sentence
):
    assert notes(scored(ranking, score, change, is_change)) == [sentence]


def test_outputs_that_stand_still_are_named():
    seen = Coverage(("pump_1.status bit 0",), (), ("pump_2.out",), ("pump_1.out",))
    proof = Proof((ROW,), {"PI": seen})
    assert notes(proof) == ["PI: 1 of 1 status bits seen on and off; never moved: pump_2.out"]
    assert proof.holds
    still = Coverage(("pump_1.status bit 0",), (), ("pump_1.out", "pump_2.out"), ())
    proof = Proof((ROW,), {"PI": still})
    assert not proof.holds and "no real output moved" in result_sentence(proof)


@pytest.mark.thorough
def test_what_is_infinite_in_single_precision_only_fails_the_proof(monkeypatch):
    need_compiler()
    need_grammar()
    need_importer()
    square = Program(
        "square", (), (Signal("u", low=0.0, high=1e30),), (), (Signal("y"),),
        Block(1, (Operation(1, "multiply", (0, 0)),), (1,)),
    )  # fmt: skip
    proof = quick_proof(monkeypatch, square, without=FMUS)
    (failed,) = proof.failures
    assert (failed.target, failed.precision, failed.verdict) == ("C", "single", "differs")
    assert failed.overflows > 500 and failed.largest == math.inf and not proof.holds
    (said,) = findings(proof.rows)
    assert said.startswith("differs: C in single precision (y is infinite or not a number in scan")
    assert row_of(failed.as_dict()) == failed
    small = dataclasses.replace(square, inputs=(Signal("u", low=0.0, high=1e15),))
    assert quick_proof(monkeypatch, small, without=FMUS).rows[-1].verdict == "reported"
