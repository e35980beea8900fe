"""Printed programs made to run, by the package's own proof: C compiled, text interpreted."""

import importlib.util
import math
import os
import shutil
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from clepsydra.deploy import compiler
from clepsydra.deploy.proof import compiled_c, interpreted_text
from clepsydra.program.program import Program

COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
STRICT = list(compiler.STRICT)


def need_compiler() -> str:
    return COMPILER or _missing("no C compiler (cc, gcc or clang) is installed")


def need_grammar() -> None:
    if importlib.util.find_spec("tree_sitter_iec61131_3_st") is None:
        _missing("the package tree-sitter-iec61131-3-st is not installed")


def need_importer() -> None:
    if importlib.util.find_spec("fmpy") is None:
        _missing("the package FMPy is not installed")


def _missing(reason: str):
    if os.environ.get("CLEPSYDRA_REQUIRE_TOOLS") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


def bits(value: float) -> int:
    """The bits of a number; every not-a-number counts as the same one."""
    return -1 if math.isnan(value) else struct.unpack("<Q", struct.pack("<d", value))[0]


def all_bits(values: np.ndarray) -> np.ndarray:
    values = np.ascontiguousarray(values, dtype=float)
    return np.where(np.isnan(values), -1, values.view(np.int64))


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
