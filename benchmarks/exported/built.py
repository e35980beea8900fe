"""Exported C, built: its sizes by the compiler's own tools, and a driver that runs many scans."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.cplusplus import CompilerMissing
from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.exportable import Exportable
from clepsydra.program.precision import Precision

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
EXACT = "-ffp-contract=off"
_TYPES = {"integer": "int32_t", "boolean": "bool"}
_REAL = {"double": "double", "single": "float"}


@dataclass(frozen=True)
class CodeSize:
    """Machine code with its constants [bytes], optimised for speed and for size."""

    fast: int
    small: int


@dataclass(frozen=True)
class DataSize:
    """What the structures of an instance take [bytes]."""

    state: int
    parameters: int
    inputs: int
    outputs: int


def compiler() -> str:
    """Return the command of a C compiler.

    Raises
    ------
    CompilerMissing
    """
    return _tool("cc", "gcc", "clang")


def compiler_version() -> str:
    """Return the first line that the compiler says of itself."""
    return _ran(compiler(), "--version").splitlines()[0]


def compiler_family() -> str:
    """Return "clang" or "gcc", by the macros that the compiler predefines."""
    return "clang" if "__clang__" in _ran(compiler(), "-dM", "-E", "-xc", os.devnull) else "gcc"


class ExportedC:
    """The exported C of a controller, as objects for its size and as a library to run.

    Parameters
    ----------
    ready : Exportable
    precision : {"double", "single"}
    folder : Path
        Where it is built.

    Raises
    ------
    CompilerMissing
        There is no compiler, or no `size`.
    RuntimeError
        The code does not compile without a warning, or keeps data outside its structures.
    """

    def __init__(self, ready: Exportable, precision: Precision, folder: Path) -> None:
        program = ready.program
        self._outputs = len(program.outputs)
        printed = print_c(program, origin=ready.origin, precision=precision)
        folder.mkdir(parents=True)
        (folder / printed.header_name).write_text(printed.header, encoding="utf-8")
        source, driver = folder / printed.source_name, folder / "driver.c"
        source.write_text(printed.source, encoding="utf-8")
        driver.write_text(
            _driver(program.name, program.inputs, program.outputs, _REAL[precision]),
            encoding="utf-8",
        )
        fast, small = (compiled(source, level) for level in ("-O2", "-Os"))
        self.code = CodeSize(code_in(fast), code_in(small))
        library = folder / "library.so"
        driven = compiled(driver, "-O2")
        _ran(compiler(), "-shared", "-o", str(library), str(driven), str(fast), "-lm")
        self._library = ctypes.CDLL(str(library))
        self._library.size_of.restype = ctypes.c_size_t
        self.data = DataSize(*(self._library.size_of(which) for which in range(4)))

    def prepare(self, inputs: Mapping[str, np.ndarray]) -> Scans:
        """Lay the inputs of many scans out in the structures of the code."""
        return Scans(self._library, self.data, self._outputs, np.column_stack([*inputs.values()]))


class Scans:
    """A run of exported C over inputs that lie ready."""

    def __init__(
        self, library: ctypes.CDLL, data: DataSize, outputs: int, table: np.ndarray
    ) -> None:
        self._library = library
        self._table = np.ascontiguousarray(table, dtype=float)
        self._count = ctypes.c_size_t(len(table))
        self._inputs = np.zeros(len(table) * data.inputs, dtype=np.uint8)
        self._outputs = np.zeros(len(table) * data.outputs, dtype=np.uint8)
        self._found = np.zeros((len(table), outputs))
        library.take(_pointer(self._table), _pointer(self._inputs), self._count)

    def run(self) -> None:
        """Start an instance and run all scans: one call from here, no Python in between."""
        self._library.run(_pointer(self._inputs), _pointer(self._outputs), self._count)

    def outputs(self) -> np.ndarray:
        """Return what the last run found [scans, outputs]."""
        self._library.give(_pointer(self._outputs), _pointer(self._found), self._count)
        return self._found.copy()


def _pointer(values: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(values.ctypes.data)


def _driver(name: str, inputs: Sequence[Signal], outputs: Sequence[Signal], real: str) -> str:
    def taken(signal: Signal, column: int) -> str:
        entry = f"table[k * {len(inputs)} + {column}]"
        if signal.kind == "boolean":
            return f"inputs[k].{signal.identifier} = {entry} != 0.0;"
        return f"inputs[k].{signal.identifier} = ({_TYPES.get(signal.kind, real)}){entry};"

    def given(signal: Signal, column: int) -> str:
        return f"table[k * {len(outputs)} + {column}] = (double)outputs[k].{signal.identifier};"

    sizes = ", ".join(f"sizeof({name}_{s})" for s in ("state", "parameters", "inputs", "outputs"))
    prototypes = (
        "size_t size_of(int which)",
        f"void take(const double *table, {name}_inputs *inputs, size_t scans)",
        f"void run(const {name}_inputs *inputs, {name}_outputs *outputs, size_t scans)",
        f"void give(const {name}_outputs *outputs, double *table, size_t scans)",
    )
    return "\n".join(
        [
            "#include <stddef.h>",
            f'#include "{name}.h"',
            *(f"{prototype};" for prototype in prototypes),
            prototypes[0],
            "{",
            f"  const size_t sizes[] = {{ {sizes} }};",
            "  return sizes[which];",
            "}",
            prototypes[1],
            "{",
            "  for (size_t k = 0; k < scans; ++k) {",
            *(f"    {taken(signal, column)}" for column, signal in enumerate(inputs)),
            "  }",
            "}",
            prototypes[2],
            "{",
            f"  {name}_parameters parameters;",
            f"  {name}_state state;",
            f"  {name}_default_parameters(&parameters);",
            f"  {name}_initialise(&state);",
            "  for (size_t k = 0; k < scans; ++k) {",
            f"    {name}_step(&parameters, &state, &inputs[k], &outputs[k]);",
            "  }",
            "}",
            prototypes[3],
            "{",
            "  for (size_t k = 0; k < scans; ++k) {",
            *(f"    {given(signal, column)}" for column, signal in enumerate(outputs)),
            "  }",
            "}",
            "",
        ]
    )


def compiled(source: Path, level: str) -> Path:
    """Compile a source file without a warning and return its object file."""
    target = source.with_name(f"{source.stem}{level}.o")
    _ran(compiler(), *STRICT, level, EXACT, "-fPIC", "-c", "-o", str(target), str(source))
    return target


def code_in(target: Path) -> int:
    """Return the bytes of machine code and constants in an object file that keeps no data."""
    sections = {
        name: int(size)
        for name, size in re.findall(
            r"^(\.\S+)\s+(\d+)\s+\d+$", _ran(_tool("size"), "-A", str(target)), re.MULTILINE
        )
    }
    kept = sum(size for name, size in sections.items() if re.match(r"\.(data|bss)\b", name))
    if kept:
        raise RuntimeError(f"{target.name} keeps {kept} bytes outside its structures")
    return sum(size for name, size in sections.items() if re.match(r"\.(text|rodata)\b", name))


def _tool(*names: str) -> str:
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        raise CompilerMissing(f"{' or '.join(names)} is not installed; the benchmarks need it")
    return found


def _ran(*command: str) -> str:
    answer = subprocess.run(command, capture_output=True, text=True)
    if answer.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} failed:\n{answer.stderr}")
    return answer.stdout
