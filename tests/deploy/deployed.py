"""Printed programs made to run: C by the system's compiler, Structured Text by its interpreter."""

import ctypes
import importlib.util
import math
import os
import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program

COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror"]
_CTYPES = {"real": ctypes.c_double, "integer": ctypes.c_int32, "boolean": ctypes.c_bool}


def need_compiler() -> str:
    return COMPILER or _missing("no C compiler (cc, gcc or clang) is installed")


def need_grammar() -> None:
    if importlib.util.find_spec("tree_sitter_iec61131_3_st") is None:
        _missing("the package tree-sitter-iec61131-3-st is not installed")


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


class CompiledC:
    """The C of a program as a shared library, one instance of its state."""

    def __init__(self, program: Program, folder: Path) -> None:
        compiler, printed = need_compiler(), print_c(program)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / printed.header_name).write_text(printed.header, encoding="utf-8")
        source = folder / printed.source_name
        source.write_text(printed.source, encoding="utf-8")
        target = folder / f"{program.name}.so"
        command = [compiler, *STRICT, "-ffp-contract=off", "-shared", "-fPIC"]
        built = subprocess.run(
            [*command, "-o", str(target), str(source), "-lm"], capture_output=True, text=True
        )
        assert built.returncode == 0, built.stderr + printed.source
        library = ctypes.CDLL(str(target))
        self._program = program
        self._step = getattr(library, f"{program.name}_step")
        self._step.restype = None
        self._structures = [
            _structure(entries)()
            for entries in (program.parameters, program.state, program.inputs, program.outputs)
        ]
        self.parameters, self.memory, self._inputs, self._outputs = self._structures
        library[f"{program.name}_default_parameters"](ctypes.byref(self.parameters))
        library[f"{program.name}_initialise"](ctypes.byref(self.memory))

    def __call__(self, inputs: dict[str, float]) -> list[float]:
        """Run one sample and return the outputs in order."""
        for signal in self._program.inputs:
            kind = {"real": float, "integer": int, "boolean": bool}[signal.kind]
            setattr(self._inputs, signal.identifier, kind(inputs[signal.name]))
        self._step(*map(ctypes.byref, self._structures))
        return [float(getattr(self._outputs, s.identifier)) for s in self._program.outputs]

    def state(self) -> list[float]:
        """The state in order; of a delay ring the value that the next sample reads."""
        found = []
        for entry in self._program.state:
            name = entry.name.replace(".", "_")
            value = getattr(self.memory, name)
            if isinstance(entry, DelayRing) and entry.length > 1:
                value = value[getattr(self.memory, f"{name}_position")]
            found.append(float(value))
        return found


def _structure(entries) -> type[ctypes.Structure]:
    fields: list[tuple] = []
    for entry in entries:
        ring = isinstance(entry, DelayRing)
        signal = entry.signal if ring else entry
        kind = _CTYPES[signal.kind]
        if ring and entry.length > 1:
            fields.append((signal.identifier, kind * entry.length))
            fields.append((f"{signal.identifier}_position", ctypes.c_int32))
        else:
            fields.append((signal.identifier, kind))
    return type("Members", (ctypes.Structure,), {"_fields_": fields or [("n", ctypes.c_char)]})


class InterpretedText:
    """The Structured Text of a program, one instance of its function block."""

    def __init__(self, program: Program) -> None:
        need_grammar()
        from structured_text_interpreter import FunctionBlock

        self._program = program
        self.block = FunctionBlock(print_structured_text(program))

    def __call__(self, inputs: dict[str, float]) -> list[float]:
        """Run one sample and return the outputs in order."""
        given = {signal.identifier: inputs[signal.name] for signal in self._program.inputs}
        found = self.block(**given)
        return [float(found[signal.identifier.lower()]) for signal in self._program.outputs]

    def state(self) -> list[float]:
        """The state in order; of a delay ring the value that the next sample reads."""
        found, memory = [], self.block.state
        for entry in self._program.state:
            name = entry.name.replace(".", "_").lower()
            value = memory[name]
            if isinstance(entry, DelayRing) and entry.length > 1:
                value = value[memory[f"{name}_position"]]
            found.append(float(value))
        return found


def run_both(
    program: Program, folder: Path, inputs: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Run C and text over all samples; returns outputs and states of each [samples, q + n]."""
    printed = CompiledC(program, folder), InterpretedText(program)
    samples = len(next(iter(inputs.values())))
    tables = []
    for instance in printed:
        rows = []
        for k in range(samples):
            outputs = instance({name: float(column[k]) for name, column in inputs.items()})
            rows.append([*outputs, *instance.state()])
        tables.append(np.array(rows))
    return tables[0], tables[1]
