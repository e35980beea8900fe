"""A refusal holds only where the target cannot express what the program needs."""

import dataclasses
from importlib import resources

import pytest
from spoilt_programs import FMUS, item, level_control, quick_proof, quickly
from tools import need_compiler, need_grammar, need_importer

from clepsydra import InputError, Signal
from clepsydra.deploy.proof import interpreted_text
from clepsydra.deploy.proof.item import ProofItem, process_item
from clepsydra.deploy.proof.limits import DELAYS, LIMITS, PYTHON_LAW
from clepsydra.deploy.proof.proof import prove
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.reader import load_process
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

TEXT = "Structured Text, codesys"


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


def law(code: str = "", constant: float = 1.0, **more) -> Program:
    statements = (
        Operation(1, "constant", (), constant),
        Operation(2, code, (0, 1)[: 1 if code in ("tanh", "exp") else 2]),
    )
    return Program("law", (), (Signal("u", low=-2.0, high=2.0, initial=more.get("initial", 0.5)),),
                   (), (Signal("y"),), Block(1, statements, (2,)))  # fmt: skip


#: Program, and the targets that refuse it, each by the limit that it meets.
REFUSED = {
    "a hyperbolic function": (law("tanh"), {"Structured Text": "functions of Structured Text"}),
    "an angle of two numbers": (law("atan2"), {"Structured Text": "functions of Structured Text"}),
    "an infinite constant": (
        law("minimum", float("inf")), {"Structured Text": "infinity in Structured Text"},
    ),
    "a constant outside REAL": (law("add", 1e-60), {"single": "range of REAL"}),
    "an initial value that is too small": (
        law("add", initial=1e-60),
        {"single": "range of REAL", "matiec": "numbers that matiec reads"},
    ),
    "a count beyond 2^24": (
        dataclasses.replace(
            level_control(),
            inputs=(*level_control().inputs[:-1],
                    Signal("count", kind="integer", low=0.0, high=2.0**25)),
        ),
        {"single": "whole numbers of REAL"},
    ),
}  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize("name", REFUSED)
def test_what_a_target_cannot_express_it_refuses_by_name(name, monkeypatch):
    program, limits = REFUSED[name]
    proof = quick_proof(monkeypatch, program, without=FMUS)
    assert proof.holds
    refused = 0
    for row in proof.rows:
        met = {limit for part, limit in limits.items() if part in f"{row.target} {row.precision}"}
        if row.verdict == "refused":
            refused += 1
            assert row.limit in met, (row.target, row.precision, row.reason)
        else:
            assert not met or row.limit == "", (row.target, row.precision)
    assert refused >= 1 and len(proof.refusals) == refused


@pytest.mark.thorough
def test_transport_delays_have_no_model_exchange(tmp_path, monkeypatch):
    catalogue = resources.files("clepsydra.process.catalogue")
    text = (catalogue / "three-tanks.toml").read_text("utf-8")
    text = text.replace('destination = "tank_1"', 'destination = "pipe"', 1)
    path = tmp_path / "late.toml"
    path.write_text(text + '\n[delays.pipe]\ndestination = "tank_1"\ntime = "20 s"\n')
    quickly(monkeypatch, 300, without=FMUS)
    proof = prove([process_item(find_equilibrium(load_process(path)))], scans=300)
    refused = {row.target: row.limit for row in proof.refusals}
    assert set(refused) == {"FMU 3.0 exchange", "FMU 2.0 exchange"} and proof.holds
    assert set(refused.values()) == {"delays in model exchange"}
    prompt = process_item(find_equilibrium(load_process("three-tanks")))
    assert not DELAYS.meets(prompt)


@pytest.mark.thorough
def test_a_printer_that_refuses_without_need_fails_the_proof(monkeypatch):
    def refuse(program, **more):
        raise InputError("program law", "anything", "something else", "print it in C")

    monkeypatch.setattr(interpreted_text, "print_structured_text", refuse)
    proof = quick_proof(monkeypatch, without=FMUS)
    assert not proof.holds and not proof.refusals
    assert {row.target for row in proof.failures} >= {TEXT, "Structured Text"}
    assert all(row.verdict == "refused" for row in proof.failures)


def test_no_limit_is_met_by_an_ordinary_controller():
    assert not any(limit.meets(item()) for limit in LIMITS)


def test_limits_are_named_once_and_say_why():
    assert len({limit.name for limit in LIMITS}) == len(LIMITS)
    assert all(limit.reason for limit in LIMITS)
    assert not PYTHON_LAW.meets(ProofItem("nothing", 1.0))
