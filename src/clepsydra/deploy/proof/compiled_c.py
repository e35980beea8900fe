"""Printed C, compiled and called: one instance of its state in a shared library."""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.interface import instances
from clepsydra.deploy.c99.printer import CSource, print_c
from clepsydra.deploy.compiler import (
    CompilationError,
    Compiler,
    find_compiler,
    library_name,
)
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.instance import Array, Scans, given_parameters, scan_count
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import own_state, state_paths, with_owned_state
from clepsydra.program.precision import Precision
from clepsydra.program.program import Program

_REALS = {"double": ctypes.c_double, "single": ctypes.c_float}
#: Tells the sizes of the structures, so that a member more or less does not pass unseen.
_PROBE = """\
#include "{name}.h"
extern const uint64_t {name}_sizes[4];
const uint64_t {name}_sizes[4] = {{
  sizeof({name}_parameters), sizeof({name}_state), sizeof({name}_inputs), sizeof({name}_outputs)
}};
"""
#: So many scans are run before their outputs and states are read.
_CHUNK = 1000


class CompiledC:
    """The C of a program as a shared library, one instance of its state.

    Parameters
    ----------
    program : Program
    folder : Path
        Where header, source and library are written; made if it is not there.
    precision : {"double", "single"}
    compiler : Compiler, optional
        That of this machine if omitted.
    printed : CSource, optional
        What is compiled; printed if omitted.

    Raises
    ------
    InputError
        There is no compiler, or the program is not printable.
    CompilationError
        The compiler refuses the source, or its structures have other members than the program.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.program.program import Block, Operation
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     CompiledC(program, Path(folder)).run({"u": np.array([0.5, 0.25])}).tolist()
    [[0.5, 0.5], [0.75, 0.75]]
    """

    def __init__(
        self,
        program: Program,
        folder: Path,
        precision: Precision = "double",
        compiler: Compiler | None = None,
        printed: CSource | None = None,
    ) -> None:
        self.program = program
        compiler = compiler or find_compiler("proof of C")
        printed = printed or printed_c(program, precision)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / printed.header_name).write_text(printed.header, encoding="utf-8")
        source = folder / printed.source_name
        source.write_text(printed.source, encoding="utf-8")
        probe = folder / f"{program.name}_sizes.c"
        probe.write_text(_PROBE.format(name=program.name), encoding="utf-8")
        # A system that has loaded a library gives it again for the same path.
        content = hashlib.sha256((printed.header + printed.source).encode()).hexdigest()[:12]
        target = folder / library_name(f"{program.name}_{content}")
        library = ctypes.CDLL(str(compiler.build([source, probe], target)))
        self._step = getattr(library, f"{program.name}_step")
        self._step.restype, self._step.argtypes = None, [ctypes.c_void_p] * 4
        real, form = _REALS[precision], with_owned_state(program)
        self._paths = state_paths(form)
        structures = [
            _structure(_fields(program.parameters, real)),
            _structure(_state_fields(form, real)),
            _structure(_fields(program.inputs, real)),
            _structure(_fields(program.outputs, real)),
        ]
        sizes = list((ctypes.c_uint64 * 4).in_dll(library, f"{program.name}_sizes"))
        if sizes != [ctypes.sizeof(structure) for structure in structures]:
            raise CompilationError(f"{printed.header_name}: its structures have other members")
        #: As they are printed, and what lives from scan to scan.
        self._parameters, self.memory = structures[0](), structures[1]()
        self._inputs, self._outputs = structures[2](), structures[3]
        defaults = library[f"{program.name}_default_parameters"]
        defaults.restype = None
        defaults(ctypes.byref(self._parameters))
        self._start = library[f"{program.name}_initialise"]
        self._start.restype = None
        self.initialise()

    def initialise(self) -> None:
        """Go back to the initial state."""
        self._start(ctypes.byref(self.memory))

    def run(self, inputs: Scans) -> Array:
        """Run all scans; returns outputs and then states [scans, q + n].

        Of a delay ring the state is the value that the next scan reads.
        """
        scans = scan_count(inputs)
        parts = [
            self._chunk({name: column[start : start + _CHUNK] for name, column in inputs.items()})
            for start in range(0, scans, _CHUNK)
        ]
        return np.concatenate(parts)

    def scan_by_scan(self, before: Array, inputs: Scans) -> Array:
        """Run scans that do not follow each other; returns outputs and then states [scans, q + n].

        Parameters
        ----------
        before : array
            State before each scan [scans, n]; of a delay ring what the scan reads.
        inputs : mapping

        Returns
        -------
        array
            Of a delay ring what the scan wrote into it.
        """
        memories = self._rows(self.memory, (), inputs)
        with np.errstate(all="ignore"):
            for column, entry, (*above, name) in zip(
                before.T, self.program.state, self._paths, strict=True
            ):
                held = _inside(memories, above)
                if is_ring(entry):
                    held[name][:, 0], held[f"{name}_position"] = column, 0
                else:
                    held[name] = column
        return self._chunk(inputs, memories)

    def _chunk(self, inputs: Scans, before: np.ndarray | None = None) -> Array:
        scans, program = scan_count(inputs), self.program
        found = np.zeros(scans, dtype=np.dtype(self._outputs))
        memories = np.zeros(scans, np.dtype(type(self.memory))) if before is None else before
        given = self._rows(self._inputs, program.inputs, inputs)
        tuned = given_parameters(program, inputs)
        parameters = self._rows(self._parameters, tuned, inputs)
        memory = ctypes.addressof(self.memory)
        size = ctypes.sizeof(self.memory)
        for k in range(scans):
            if before is not None:
                ctypes.memmove(memory, memories.ctypes.data + k * size, size)
            self._step(
                parameters.ctypes.data + k * parameters.itemsize,
                memory,
                given.ctypes.data + k * given.itemsize,
                found.ctypes.data + k * found.itemsize,
            )
            ctypes.memmove(memories.ctypes.data + k * size, memory, size)
        columns = [_inside(found, signal.identifier.split(".")) for signal in program.outputs]
        columns += self._states(memories, follow=before is None)
        return np.column_stack(columns).astype(float) if columns else np.zeros((scans, 0))

    def _states(self, memories: np.ndarray, *, follow: bool) -> list[np.ndarray]:
        """Return the states in memories; of a ring what is read next, or what lies at its start."""
        columns = []
        for entry, (*above, name) in zip(self.program.state, self._paths, strict=True):
            held = _inside(memories, above)
            column = held[name]
            if is_ring(entry):
                place = held[f"{name}_position"] if follow else 0
                column = column[np.arange(len(memories)), place]
            columns.append(column)
        return columns

    def _rows(
        self, structure: ctypes.Structure, signals: Sequence[Signal], inputs: Scans
    ) -> np.ndarray:
        """Return a structure for each scan; what is not a number stays as it is printed."""
        row = np.frombuffer(bytes(structure), dtype=np.dtype(type(structure)))
        table = np.repeat(row, scan_count(inputs))
        for signal in signals:
            column = inputs[signal.name]
            kept = np.isnan(column) & (structure is self._parameters)
            with np.errstate(all="ignore"):
                table[signal.identifier][~kept] = column[~kept]
        return table


def printed_c(program: Program, precision: Precision, origin: Origin | None = None) -> CSource:
    """Return the C of a program, as `clepsydra export` writes it.

    Examples
    --------
    See `CompiledC`.
    """
    return print_c(program, origin=origin, precision=precision)


def _inside(table: np.ndarray, members: Sequence[str]) -> np.ndarray:
    for name in members:
        table = table[name]
    return table


def _structure(fields: Sequence[tuple[str, Any]]) -> type[ctypes.Structure]:
    return type("Members", (ctypes.Structure,), {"_fields_": fields or [("n", ctypes.c_char)]})


def _state_fields(program: Program, real: Any) -> list[tuple[str, Any]]:
    """Return what a program keeps, with what its instances keep inside."""
    inside = [
        (c.identifier, _structure(_state_fields(c.program, real))) for c in instances(program)
    ]
    return [*_fields(own_state(program), real), *inside]


def _fields(entries: Sequence[Entry], real: Any) -> list[tuple[str, Any]]:
    kinds = {"real": real, "integer": ctypes.c_int32, "boolean": ctypes.c_bool}
    fields: list[tuple[str, Any]] = []
    records: dict[str, list[tuple[str, Any]]] = {}
    for entry in entries:
        signal = signal_of(entry)
        kind = kinds[signal.kind]
        if signal.record:
            fields += [(signal.variable, None)] if signal.variable not in records else []
            records.setdefault(signal.variable, []).append((signal.part, kind))
        elif is_ring(entry):
            fields.append((signal.identifier, kind * entry.length))
            fields.append((f"{signal.identifier}_position", ctypes.c_int32))
        else:
            fields.append((signal.identifier, kind))
    return [(n, _structure(records[n]) if n in records else kind) for n, kind in fields]
