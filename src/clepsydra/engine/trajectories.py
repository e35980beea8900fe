"""What a kernel computed, by name."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

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
    by_lanes : ndarray [groups, n, lanes]
        The state at the end as the kernel laid it down; `final_state` has it in order.
    record : ndarray [groups, records, q, lanes]
        As the kernel laid it down; `output` gives it by name.
    held : ndarray [groups, entries of all rings, lanes]
        Of all delay rings, the oldest of each first; `rings` gives them by name.
    """

    program: Program
    scenarios: int
    by_lanes: Array
    record: Array
    held: Array

    @cached_property
    def final_state(self) -> Array:
        """The state at the end in the order of the program's state [n, scenarios].

        Entries of delay rings are not used.
        """
        groups, states, lanes = self.by_lanes.shape
        whole = self.by_lanes.transpose(1, 0, 2).reshape(states, groups * lanes)
        return whole[:, : self.scenarios]

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
            for name, ring in rings_by_name(self.program, self.held).items()
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
        return self.by_lanes[:, names.index(name)].ravel()[: self.scenarios]


def rings_by_name(program: Program, rings: Array) -> dict[str, Array]:
    """Return what each delay ring holds [groups, length, lanes], views of all rings together."""
    found, start = {}, 0
    for ring, _ in rings_and_turns(program):
        found[ring.name] = rings[:, start : start + ring.length]
        start += ring.length
    return found


def follow_rings(program: Program, rings: Array, samples: int) -> None:
    """Put the oldest entry of each delay ring first, as a kernel takes it, after some samples.

    Parameters
    ----------
    rings : ndarray [groups, entries of all rings, lanes]
        As a kernel left them that took the first entry of each for its oldest one.
    """
    if not rings.size:
        return
    held = rings_by_name(program, rings)
    for ring, turns in rings_and_turns(program):
        held[ring.name][:] = np.roll(held[ring.name], -(turns * samples % ring.length), axis=1)


def rings_and_turns(program: Program) -> list[tuple[DelayRing, int]]:
    """Return the rings in the order of their memory, each with its turns in a sample."""
    own = [(entry, 1) for entry in program.state if isinstance(entry, DelayRing)]
    loops = (statement for statement in program.block.statements if isinstance(statement, ForLoop))
    return [*own, *((ring, loop.count) for loop in loops for ring in loop.rings)]
