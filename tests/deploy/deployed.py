"""Printed programs made to run, by the package's own proof: C compiled, text interpreted."""

import math
import struct
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from tools import need_compiler, need_grammar

from clepsydra.deploy import compiler
from clepsydra.deploy.proof import compiled_c, interpreted_text
from clepsydra.deploy.target import target_of
from clepsydra.program.program import Program

STRICT = list(compiler.STRICT)


def bits(value: float) -> int:
    """The bits of a number; every not-a-number counts as the same one."""
    return -1 if math.isnan(value) else struct.unpack("<Q", struct.pack("<d", value))[0]


def all_bits(values: np.ndarray) -> np.ndarray:
    values = np.ascontiguousarray(values, dtype=float)
    return np.where(np.isnan(values), -1, values.view(np.int64))


def files_of(ready, to, **options):
    """The files of an export, name to content."""
    target, chosen = target_of(to, options)
    return target.controller(SimpleNamespace(ready=ready), chosen).files


class CompiledC(compiled_c.CompiledC):
    """The C of a program, built by the system's compiler under `STRICT`."""

    def __init__(self, program: Program, folder: Path, precision: str = "double") -> None:
        need_compiler()
        strict = replace(compiler.find_compiler("tests"), flags=tuple(STRICT))
        super().__init__(program, folder, precision, strict)


class InterpretedText(interpreted_text.InterpretedText):
    """The Structured Text of a program, where the grammar is installed."""

    def __init__(
        self, program: Program, precision: str = "double", dialect: str = "codesys"
    ) -> None:
        need_grammar()
        super().__init__(program, precision, dialect)


def run_both(
    program: Program, folder: Path, inputs: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Run C and text over all samples; returns outputs and states of each [samples, q + n]."""
    return CompiledC(program, folder).run(inputs), InterpretedText(program).run(inputs)
