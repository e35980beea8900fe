"""That the proof can fail: printers that make one small mistake are found out."""

import dataclasses
import math

import numpy as np
import pytest
from spoilt_programs import (
    FMUS,
    dropped,
    level_control,
    one_unit_more,
    places,
    quick_proof,
    spoilt,
    turned,
)
from tools import need_compiler, need_grammar, need_importer

from clepsydra import InputError
from clepsydra.deploy.proof import compiled_c, interpreted_text
from clepsydra.deploy.proof.comparison import compare, shown_signals
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.program.operation import Operation

MISTAKES = {
    "an addition is dropped": (("add",), dropped),
    "a subtraction is turned round": (("subtract",), turned),
    "a comparison is turned round": (("less", "less_equal"), turned),
    "a choice is turned round": (("select",), turned),
}

FIRST, *OTHERS = MISTAKES
ONE_IN_THE_FAST_TIER = [FIRST, *(pytest.param(m, marks=pytest.mark.thorough) for m in OTHERS)]


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


@pytest.mark.parametrize("mistake", ONE_IN_THE_FAST_TIER)
def test_a_mistake_of_the_c_printer_fails_the_proof(mistake, monkeypatch):
    codes, change = MISTAKES[mistake]
    print_c = compiled_c.print_c
    place = places(level_control(), *codes)[0]
    monkeypatch.setattr(
        compiled_c,
        "print_c",
        lambda program, **more: print_c(spoilt(program, place, change), **more),
    )
    proof = quick_proof(monkeypatch, without=FMUS)
    verdicts = {(row.target, row.precision): row.verdict for row in proof.rows}
    assert not proof.holds
    assert verdicts["C", "double"] == "differs"
    assert verdicts["Structured Text, matiec", "double"] == "equal"
    # It is not the law with its operations rounded, which the engine computes too.
    assert verdicts["C", "single"] == "differs"
    # The Structured Text in single precision is right, so that it differs from the wrong C.
    assert verdicts["Structured Text", "single"] == "differs"
    row = next(row for row in proof.rows if row.verdict == "differs")
    assert row.differing > 0 and (row.signal or row.decisions)


@pytest.mark.parametrize("mistake", ONE_IN_THE_FAST_TIER)
def test_a_mistake_of_the_text_printer_fails_the_proof(mistake, monkeypatch):
    codes, change = MISTAKES[mistake]
    printed = interpreted_text.print_structured_text
    place = places(level_control(), *codes)[0]

    def wrong(program, *, dialect, **more):
        program = spoilt(program, place, change) if dialect == "scl" else program
        return printed(program, dialect=dialect, **more)

    monkeypatch.setattr(interpreted_text, "print_structured_text", wrong)
    proof = quick_proof(monkeypatch, without=FMUS)
    assert [row.target for row in proof.failures] == ["Structured Text, scl"]
    assert not proof.holds


@pytest.mark.thorough
def test_a_number_that_is_one_unit_larger_fails_the_proof(monkeypatch):
    """A parameter as it is printed in the C, and an initial value as it is in the text."""
    print_c, printed = compiled_c.print_c, interpreted_text.print_structured_text

    def more(signal):
        return dataclasses.replace(signal, initial=math.nextafter(signal.initial, math.inf))

    def wrong_c(program, **choices):
        gain, *rest = program.parameters
        return print_c(dataclasses.replace(program, parameters=(more(gain), *rest)), **choices)

    def wrong_text(program, *, dialect, **choices):
        if dialect == "matiec":
            integral, *rest = program.state
            program = dataclasses.replace(program, state=(more(integral), *rest))
        return printed(program, dialect=dialect, **choices)

    monkeypatch.setattr(compiled_c, "print_c", wrong_c)
    monkeypatch.setattr(interpreted_text, "print_structured_text", wrong_text)
    # With this seed the first scan is in automatic, which leaves the integral as it is printed, and
    # for half of the scans nobody tunes, which would replace the gain.
    proof = quick_proof(monkeypatch, without=FMUS, seed=5)
    wrong = [row for row in proof.failures if row.precision == "double"]
    assert [row.target for row in wrong] == ["C", "Structured Text, matiec"]
    # One unit in the last place is some 1e-16 of gain or output.
    assert all(0.0 < row.largest < 1e-13 for row in wrong)


@pytest.mark.thorough
def test_a_mistake_of_the_fmu_fails_the_proof(monkeypatch):
    from clepsydra.deploy.fmi import write

    print_c = write.print_c
    place = places(level_control(), "add")[-1]
    monkeypatch.setattr(
        write, "print_c", lambda program, **more: print_c(spoilt(program, place, dropped), **more)
    )
    proof = quick_proof(monkeypatch)
    assert [row.target for row in proof.failures] == ["FMU 3.0", "FMU 2.0"]


@pytest.mark.thorough
def test_a_text_that_is_none_fails_the_proof(monkeypatch):
    printed = interpreted_text.print_structured_text
    monkeypatch.setattr(
        interpreted_text,
        "print_structured_text",
        lambda program, **more: printed(program, **more).replace("THEN", "", 1),
    )
    proof = quick_proof(monkeypatch, without=FMUS)
    failed = [row for row in proof.rows if row.verdict == "fails"]
    assert len(failed) == 4 and not proof.holds
    assert "the grammar does not accept" in failed[0].reason


@pytest.mark.thorough
def test_nearly_every_single_mistake_is_found():
    """Each operation spoilt on its own; a few mistakes change nothing that any scan can show."""
    program = level_control()
    inputs = random_scans(program, 1_000, 1, 1.0)
    expected = engine_run(program, inputs)
    missed, tried = [], 0
    every = {**MISTAKES, "a constant is one unit larger": (("constant",), one_unit_more)}
    for name, (codes, change) in every.items():
        for place in places(program, *codes):
            wrong = spoilt(program, place, change)
            tried += 1
            try:
                found = InterpretedText(wrong).run(inputs)
            except InputError:
                continue  # a status word that may be any number is not even printed
            if compare(shown_signals(program), expected, found).differing == 0:
                missed.append((name, program.block.statements[place]))
    assert tried > 50
    assert len(missed) <= 0.1 * tried, missed


@pytest.mark.thorough
def test_the_engine_itself_is_compared_and_not_assumed(monkeypatch):
    """Where the engine is wrong and the printers are right, every target differs."""
    from clepsydra.deploy.proof import job

    run = job.engine_run

    def half(operation: Operation) -> Operation:
        return dataclasses.replace(operation, code="add")

    def spoilt_run(program, inputs, **more):
        return run(spoilt(program, places(program, "multiply")[-1], half), inputs, **more)

    monkeypatch.setattr(job, "engine_run", spoilt_run)
    proof = quick_proof(monkeypatch)
    wrong = {row.target for row in proof.failures if row.precision == "double"}
    assert wrong == {row.target for row in proof.rows if row.precision == "double"}


@pytest.mark.thorough
def test_a_program_that_does_nothing_proves_nothing(monkeypatch):
    program = level_control()
    constant = Operation(program.block.arguments, "constant", (), 3.0)
    block = dataclasses.replace(
        program.block, statements=(constant,), results=(constant.target,), truths=frozenset()
    )
    still = dataclasses.replace(program, state=(), outputs=program.outputs[:1], block=block,
                                inputs=(*program.state, *program.inputs))  # fmt: skip
    proof = quick_proof(monkeypatch, still)
    assert not proof.failures and proof.idle == ("level control",) and not proof.holds
    assert np.isfinite(proof.seconds)
