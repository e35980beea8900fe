"""What a kernel computed, by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from clepsydra.base.errors import InputError
from clepsydra.program.program import Program

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectories:
    """What a kernel computed.

    Parameters
    ----------
    program : Program
    scenarios : int
    final_state : ndarray [n, scenarios]
        In the order of the program's state; entries of delay rings are not used.
    record : ndarray [groups, records, q, lanes]
        As the kernel laid it down; `output` gives it by name.
    """

    program: Program
    scenarios: int
    final_state: Array
    record: Array

    def output(self, name: str) -> Array:
        """Return the trajectory of an output [scenarios, records], a view where possible.

        Raises
        ------
        InputError
            There is no such output, or the kernel stored none.
        """
        names = [signal.name for signal in self.program.outputs]
        if name not in names or not self.record.size:
            raise InputError(
                f"run of {self.program.name}",
                name,
                "an output that was stored",
                f"the outputs are {', '.join(names) or 'none'}; a kernel stores them with "
                "record=True",
            )
        column = self.record[:, :, names.index(name), :]
        return column.transpose(0, 2, 1).reshape(-1, column.shape[1])[: self.scenarios]

    def record_of(self, scenario: int) -> Array:
        """Return every output of one scenario [records, q]."""
        group, lane = divmod(scenario, self.record.shape[-1])
        return self.record[group, :, :, lane]

    def state(self, name: str) -> Array:
        """Return the final value of a state [scenarios].

        Raises
        ------
        InputError
            There is no such state.
        """
        names = [entry.name for entry in self.program.state]
        if name not in names:
            raise InputError(
                f"run of {self.program.name}",
                name,
                "one of its states",
                f"the states are {', '.join(names) or 'none'}",
            )
        return self.final_state[names.index(name)]
