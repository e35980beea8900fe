"""Programs for the proof's own tests: a controller that holds, and ones that are spoilt."""

import dataclasses
import math
from collections.abc import Iterable
from functools import lru_cache

from clepsydra import PidForm, program_of
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.deploy.proof import proof
from clepsydra.deploy.proof.item import ProofItem, controller_item
from clepsydra.deploy.proof.targets import runs_of
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES
from clepsydra.program.defaults import with_defaults
from clepsydra.program.operation import Operation
from clepsydra.program.program import Conditional, ForLoop, Program


@lru_cache
def level_control() -> Program:
    law = multiloop_pid_law(["level_1"], ["pump_1"], PidForm())
    values = {"level_1.proportional_gain": 2.7, "level_1.integral_time": 31.0,
              "level_1.setpoint_weight": 0.7, "pump_1.high_limit": 10.0, "pump_1.last_output": 3.0,
              "level_1.integral": 3.0}  # fmt: skip
    return with_defaults(program_of(law), values)


def item(program: Program | None = None) -> ProofItem:
    return ProofItem("level control", 1.0, program or level_control())


def items_of(study, settings=None) -> list[ProofItem]:
    """The controllers of a study in the order of its ranking."""
    point = study.analysis.operating_point
    controllers = [candidate.controller for candidate in study.ranking]
    return [controller_item(each, point, study.scenario, settings) for each in controllers]


#: The slowest targets to build.
FMUS = ("FMU 3.0", "FMU 2.0")
TEXTS = tuple(f"Structured Text, {dialect}" for dialect in DIALECT_NAMES)


def quickly(monkeypatch, scans: int = 1000, *, without: Iterable[str] = ()) -> None:
    """Let proofs run fewer scans than one for a plant needs, on all targets but some."""
    monkeypatch.setattr(proof, "FEWEST", scans)
    monkeypatch.setattr(
        proof,
        "runs_of",
        lambda *given: [run for run in runs_of(*given) if run.name not in without],
    )


def quick_proof(
    monkeypatch, program: Program | None = None, *, without: Iterable[str] = (), **more
):
    """A proof over a thousand scans."""
    quickly(monkeypatch, without=without)
    return proof.prove([item(program)], scans=1000, **more)


def spoilt(program: Program, place: int, change) -> Program:
    """Replace the operation at a place among the plain statements of the block."""
    statements = list(program.block.statements)
    old = statements[place]
    assert isinstance(old, Operation)
    statements[place] = change(old)
    block = dataclasses.replace(program.block, statements=tuple(statements))
    return dataclasses.replace(program, block=block)


def places(program: Program, *codes: str) -> list[int]:
    return [
        place
        for place, statement in enumerate(program.block.statements)
        if not isinstance(statement, (ForLoop, Conditional)) and statement.code in codes
    ]


def dropped(operation: Operation) -> Operation:
    """An addition without its second operand: it becomes the maximum of one value with itself."""
    first = operation.arguments[0]
    return dataclasses.replace(operation, code="maximum", arguments=(first, first))


def turned(operation: Operation) -> Operation:
    """A comparison, a subtraction or a choice with its operands exchanged."""
    *rest, first, second = operation.arguments
    return dataclasses.replace(operation, arguments=(*rest, second, first))


def one_unit_more(operation: Operation) -> Operation:
    """A constant that is larger by one unit in its last place."""
    return dataclasses.replace(operation, constant=math.nextafter(operation.constant, math.inf))
