"""Structured Text in a proof: interpreted, in every dialect and in single precision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from clepsydra.deploy.proof.c_runs import printed_single_c
from clepsydra.deploy.proof.comparison import compare, double_bound, is_exact, shown_signals
from clepsydra.deploy.proof.instance import Instance
from clepsydra.deploy.proof.job import Contents, Job
from clepsydra.deploy.proof.limits import MATIEC_NUMBERS, OF_SINGLE, OF_TEXT, PYTHON_LAW
from clepsydra.deploy.proof.run import Measured, Run, version_of
from clepsydra.deploy.proof.text.interpreter import function_block
from clepsydra.deploy.proof.text.scl import standard_text
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES, dialect_of
from clepsydra.deploy.structured_text.instances import with_block_names
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.entries import is_ring
from clepsydra.program.owned_state import state_paths, with_owned_state
from clepsydra.program.precision import Precision
from clepsydra.program.program import Program

#: Largest difference of C in floats and Structured Text in REALs where the law uses functions of
#: a library, as a share of a signal's range: some thousand roundings.
SINGLE_LIBRARY_BOUND = 1e-4
_SINGLE_DIALECT = "codesys"
#: What a printed text is called among the files.
_TEXT = "text"


class InterpretedText(Instance):
    """The Structured Text of a program, one instance of its function block.

    Parameters
    ----------
    program : Program
    precision : {"double", "single"}
        LREAL or REAL.
    dialect : str
        See `clepsydra.deploy.structured_text.printer.print_structured_text`.
    text : str, optional
        What was printed of the program so; it is printed if omitted.

    Raises
    ------
    InputError
        The program cannot be printed, or the grammar is not installed.
    StructuredTextError
        What was printed is no Structured Text.

    Examples
    --------
    >>> import numpy as np
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> InterpretedText(program).run({"u": np.array([0.5, 0.25])}).tolist()
    [[0.5, 0.5], [0.75, 0.75]]
    """

    def __init__(
        self,
        program: Program,
        precision: Precision = "double",
        dialect: str = "codesys",
        text: str | None = None,
    ) -> None:
        super().__init__(program)
        text = text or print_structured_text(program, precision=precision, dialect=dialect)
        text = standard_text(text) if dialect == "scl" else text
        self.block = function_block(text, one_turn=dialect_of(dialect).one_turn)
        # By the keys of the block's memory, which are asked for in every scan.
        self._inputs = [(s.name, s.identifier.lower()) for s in program.inputs]
        self._parameters = [(s.name, s.identifier.lower()) for s in program.parameters]
        self._outputs = [s.identifier.lower().split(".") for s in program.outputs]
        words = dialect_of(dialect).all_words
        paths = state_paths(with_block_names(with_owned_state(program), words))
        self._state = [
            (self._memory(instances), name.lower(), is_ring(entry))
            for entry, (*instances, name) in zip(program.state, paths, strict=True)
        ]
        self._printed = {name: self.block.state[key] for name, key in self._parameters}

    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in order."""
        given = {key: inputs[name] for name, key in self._inputs}
        for name, key in self._parameters:
            if name in inputs:
                value = inputs[name]
                given[key] = self._printed[name] if value != value else value
        found = self.block(**given)
        return [float(_member(found, *path)) for path in self._outputs]

    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""
        return [
            float(memory[key][memory[f"{key}_position"]] if ring else memory[key])
            for memory, key, ring in self._state
        ]

    def _memory(self, instances: Sequence[str]) -> dict[str, Any]:
        """Return the memory of an instance of an instance of … the block."""
        memory = self.block.state
        for name in instances:
            memory = memory[name.lower()].state
        return memory


def _member(memory: Mapping[str, Any], name: str, *inside: str) -> Any:
    """Return a value of a memory, or a member of a structure in it."""
    return _member(memory[name].state, *inside) if inside else memory[name]


def text_runs(kind: str) -> list[Run]:
    """Return what is run of Structured Text; of a process in double precision only.

    Raises
    ------
    InputError
        Its grammar is missing.
    """
    grammar, limits = version_of("tree-sitter-iec61131-3-st"), (PYTHON_LAW, *OF_TEXT)
    found = [
        Run(
            f"Structured Text, {dialect}",
            "double",
            "engine",
            grammar,
            partial(_text, precision="double", dialect=dialect),
            partial(_measured, dialect=dialect),
            (*limits, MATIEC_NUMBERS) if dialect == "matiec" else limits,
        )
        for dialect in DIALECT_NAMES
    ]
    if kind == "controller":
        single = _printed_single, _measured_single, (*limits, *OF_SINGLE)
        found.append(Run("Structured Text", "single", "C in single", grammar, *single))
    return found


def _text(job: Job, precision: Precision, dialect: str) -> Contents:
    origin = job.item.origin
    text = print_structured_text(job.program, origin=origin, precision=precision, dialect=dialect)
    return {_TEXT: text.encode()}


def _measured(job: Job, files: Contents, dialect: str) -> Measured:
    instance = InterpretedText(job.program, dialect=dialect, text=files[_TEXT].decode())
    found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
    return found, double_bound(job.program), {}


def _printed_single(job: Job) -> Contents:
    return {**printed_single_c(job), **_text(job, "single", _SINGLE_DIALECT)}


def _measured_single(job: Job, files: Contents) -> Measured:
    instance = InterpretedText(job.program, "single", _SINGLE_DIALECT, files[_TEXT].decode())
    signals = shown_signals(job.program)
    found = compare(signals, job.run_of_single_c, instance.run(job.single_inputs))
    return found, 0.0 if is_exact(job.program) else SINGLE_LIBRARY_BOUND, {}
