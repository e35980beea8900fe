"""What a kernel computed, by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from clepsydra.base.errors import InputError
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import ForLoop, Program

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
    held : ndarray [groups, entries of all rings, lanes]
        As the kernel left the delay rings; `rings` gives them by name.
    samples : int
    """

    program: Program
    scenarios: int
    final_state: Array
    record: Array
    held: Array
    samples: int

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

    def rings(self) -> dict[str, Array]:
        """Return what each delay ring holds at the end, the oldest first [scenarios, length]."""
        return {
            name: ring.transpose(0, 2, 1).reshape(-1, ring.shape[1])[: self.scenarios]
            for name, ring in rings_by_name(self.program, self.held, self.samples).items()
        }

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


def rings_by_name(program: Program, rings: Array, samples: int) -> dict[str, Array]:
    """Return what each delay ring holds after some samples, the oldest first.

    Parameters
    ----------
    rings : ndarray [groups, entries of all rings, lanes]
        As a kernel left them that took the first entry of each for its oldest one.

    Returns
    -------
    dict
        Ring to its content [groups, length, lanes].
    """
    own = [(entry, 1) for entry in program.state if isinstance(entry, DelayRing)]
    loops = (statement for statement in program.block.statements if isinstance(statement, ForLoop))
    found, start = {}, 0
    for ring, turns in [*own, *((ring, loop.count) for loop in loops for ring in loop.rings)]:
        content = rings[:, start : start + ring.length]
        found[ring.name] = np.roll(content, -(turns * samples % ring.length), axis=1)
        start += ring.length
    return found
