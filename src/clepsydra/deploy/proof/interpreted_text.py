"""Printed Structured Text, interpreted: one instance of its function block."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.deploy.printing.entries import is_ring, signal_of
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.proof.instance import Instance, given_parameters
from clepsydra.deploy.proof.text.interpreter import function_block
from clepsydra.deploy.proof.text.scl import standard_text
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.program import Program


class InterpretedText(Instance):
    """The Structured Text of a program, one instance of its function block.

    Parameters
    ----------
    program : Program
    precision : {"double", "single"}
        LREAL or REAL.
    dialect : str
        See `clepsydra.deploy.structured_text.printer.print_structured_text`.

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
        self, program: Program, precision: Precision = "double", dialect: str = "codesys"
    ) -> None:
        super().__init__(program)
        text = print_structured_text(program, precision=precision, dialect=dialect)
        self.block = function_block(standard_text(text) if dialect == "scl" else text)
        self._printed = {
            signal.name: self.block.state[signal.identifier.lower()]
            for signal in program.parameters
        }

    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in order."""
        given = {signal.identifier: inputs[signal.name] for signal in self.program.inputs}
        for signal in given_parameters(self.program, inputs):
            value = inputs[signal.name]
            given[signal.identifier] = self._printed[signal.name] if value != value else value
        found = self.block(**given)
        return [float(found[signal.identifier.lower()]) for signal in self.program.outputs]

    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""
        found, memory = [], self.block.state
        for entry in self.program.state:
            name = signal_of(entry).identifier.lower()
            value = memory[name]
            if is_ring(entry):
                value = value[memory[f"{name}_position"]]
            found.append(float(value))
        return found
