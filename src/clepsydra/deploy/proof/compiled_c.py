"""Printed C, compiled and called: one instance of its state in a shared library."""

from __future__ import annotations

import ctypes
import functools
import hashlib
from collections.abc import Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.printer import CSource, print_c
from clepsydra.deploy.c99.structures import instances
from clepsydra.deploy.compiler import (
    CompilationError,
    Compiler,
    find_compiler,
    library_name,
)
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.instance import (
    Array,
    Instance,
    Scans,
    given_parameters,
    scan_count,
)
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
_KINDS = {"real": float, "integer": int, "boolean": bool}
#: So many scans are run before their outputs and states are read.
_CHUNK = 1000


class CompiledC(Instance):
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
        What was printed of the program in this precision; it is printed if omitted.

    Raises
    ------
    InputError
        The program cannot be printed, or there is no compiler.
    CompilationError
        The compiler does not accept what was printed, or its structures are others.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
    ...     adding = CompiledC(program, Path(folder))
    ...     adding.run({"u": np.array([0.5, 0.25])}).tolist()
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
        super().__init__(program)
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
        self._structures = [
            _structure(_fields(program.parameters, real))(),
            _structure(_state_fields(form, real))(),
            _structure(_fields(program.inputs, real))(),
            _structure(_fields(program.outputs, real))(),
        ]
        sizes = list((ctypes.c_uint64 * 4).in_dll(library, f"{program.name}_sizes"))
        if sizes != [ctypes.sizeof(structure) for structure in self._structures]:
            raise CompilationError(f"{printed.header_name}: its structures have other members")
        self.parameters, self.memory, self._inputs, self._outputs = self._structures
        defaults = library[f"{program.name}_default_parameters"]
        defaults.restype = None
        defaults(ctypes.byref(self.parameters))
        #: The structure that holds a state, and the name of the member.
        self.members: list[tuple[ctypes.Structure, str]] = [
            (functools.reduce(getattr, above, self.memory), name) for *above, name in self._paths
        ]
        self._printed = type(self.parameters).from_buffer_copy(self.parameters)
        self._start = library[f"{program.name}_initialise"]
        self._start.restype = None
        self.initialise()

    def initialise(self) -> None:
        """Go back to the initial state."""
        self._start(ctypes.byref(self.memory))

    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in order."""
        for signal in self.program.inputs:
            setattr(self._inputs, signal.identifier, _KINDS[signal.kind](inputs[signal.name]))
        for signal in given_parameters(self.program, inputs):
            value, name = inputs[signal.name], signal.identifier
            own = getattr(self._printed, name) if value != value else _KINDS[signal.kind](value)
            setattr(self.parameters, name, own)
        self._step(*map(ctypes.addressof, self._structures))
        outputs = self._outputs
        return [float(attrgetter(s.identifier)(outputs)) for s in self.program.outputs]

    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""
        found = []
        for entry, (holder, name) in zip(self.program.state, self.members, strict=True):
            value = getattr(holder, name)
            if is_ring(entry):
                value = value[getattr(holder, f"{name}_position")]
            found.append(float(value))
        return found

    def run(self, inputs: Scans) -> Array:
        """Run all scans; returns outputs and then states [scans, q + n]."""
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
        before : ndarray [scans, n]
            The state that each scan starts from; of a delay ring its oldest value.
        inputs : mapping
            As for `run`. Of a ring the value is returned that a scan writes.
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
        found = np.zeros(scans, dtype=np.dtype(type(self._outputs)))
        memories = np.zeros(scans, np.dtype(type(self.memory))) if before is None else before
        given = self._rows(self._inputs, program.inputs, inputs)
        tuned = given_parameters(program, inputs)
        parameters = self._rows(self._printed if tuned else self.parameters, tuned, inputs)
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
        for entry, (*above, name) in zip(program.state, self._paths, strict=True):
            held = _inside(memories, above)
            column = held[name]
            if is_ring(entry):
                place = held[f"{name}_position"] if before is None else 0
                column = column[np.arange(scans), place]
            columns.append(column)
        return np.column_stack(columns).astype(float) if columns else np.zeros((scans, 0))

    def _rows(
        self, structure: ctypes.Structure, signals: Sequence[Signal], inputs: Scans
    ) -> np.ndarray:
        """Return a structure for each scan; what is not a number stays as it is printed."""
        row = np.frombuffer(bytes(structure), dtype=np.dtype(type(structure)))
        table = np.repeat(row, scan_count(inputs))
        for signal in signals:
            column = inputs[signal.name]
            kept = np.isnan(column) & (structure is self._printed)
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
