"""An instance of printed code: what one scan of it returns, and many."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clepsydra.base.signal import Signal
from clepsydra.program.program import Program

Array = NDArray[np.float64]
#: Name of an input or a parameter to its values, one a scan; where that of a parameter is not a
#: number, the parameter has the value that was printed.
Scans = Mapping[str, Array]


class Instance(ABC):
    """Printed code with a state of its own, run scan by scan.

    Parameters
    ----------
    program : Program
        What it was printed from.
    """

    def __init__(self, program: Program) -> None:
        self.program = program

    @abstractmethod
    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in the program's order.

        What is given of the parameters is set too; not a number sets the printed value.
        """

    @abstractmethod
    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""

    def run(self, inputs: Scans) -> Array:
        """Run all scans; returns outputs and then states [scans, q + n]."""
        given = (*self.program.inputs, *given_parameters(self.program, inputs))
        names = [signal.name for signal in given]
        rows = []
        for values in _rows(inputs, names):
            outputs = self(dict(zip(names, values, strict=True)))
            rows.append([*outputs, *self.state()])
        return np.array(rows, dtype=float)


def given_parameters(program: Program, inputs: Mapping[str, Any]) -> tuple[Signal, ...]:
    """Return those parameters of a program that are given."""
    return tuple(parameter for parameter in program.parameters if parameter.name in inputs)


def scan_count(inputs: Scans) -> int:
    """Return the number of scans of some inputs."""
    return len(next(iter(inputs.values())))


def _rows(inputs: Scans, names: list[str]) -> list[list[float]]:
    return np.column_stack([inputs[name] for name in names]).tolist() if names else []
