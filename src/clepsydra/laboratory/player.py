"""A controller of a rig on its way through a session, leading or following."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.controllers.blocks.status import Mode
from clepsydra.engine.kernel import Kernel
from clepsydra.laboratory.rig import Standing, Start, Station

#: Samples after which a law has taken over what stands at its outputs, and the most that it may
#: take; a state that moves by less than a share of its size stands still.
SHORTEST_SETTLING, LONGEST_SETTLING, STILL = 4, 2000, 1e-12
Columns = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Stretch:
    """Samples of a session in which one controller has the rig and no parameter changes.

    Parameters
    ----------
    samples : int
    given : mapping
        Input of the program to its values [samples].
    moved : mapping
        Input of the process to what the one that had the rig asked for [samples].
    parameters : mapping
        Those of the process that hands have changed [SI].
    """

    samples: int
    given: Columns
    moved: Columns
    parameters: Mapping[str, float]


class Player:
    """A controller of a rig with the process that it moves, wherever it has got to.

    One that does not have the rig follows in manual what the other one asks for; nobody needs to
    compute that before it takes over.

    Parameters
    ----------
    station : Station
    start : {"rest", "empty"}

    Attributes
    ----------
    done : int
        How many stretches of the session it has gone through.
    settings : dict
        Parameters of its law that hands have changed [SI].
    """

    def __init__(self, station: Station, start: Start) -> None:
        self.station, self.standing = station, station.numbers.starts[start]
        self.done = 0
        self.settings: dict[str, float] = {}

    @cached_property
    def _kernel(self) -> Kernel:
        return Kernel(self.station.program, fuse=False)

    def follow(self, stretches: Sequence[Stretch]) -> None:
        """Go in manual through what it has not gone through yet."""
        for stretch in stretches[self.done :]:
            manual = np.full(stretch.samples, float(Mode.MANUAL))
            by_hand = {f"{u}.mode": manual for u in stretch.moved}
            by_hand |= {f"{u}.manual": column for u, column in stretch.moved.items()}
            self.lead({**stretch.given, **by_hand}, stretch.parameters, stretch.samples)
        self.done = len(stretches)

    def lead(
        self, given: Columns, parameters: Mapping[str, float], samples: int
    ) -> dict[str, np.ndarray]:
        """Go through some samples with these inputs; return what it records by name [samples]."""
        station, stood = self.station, self.standing
        result = self._kernel.run(
            samples, inputs={**station.numbers.at_rest, **given},
            parameters={**station.numbers.parameters, **parameters, **self.settings},
            state=stood.state, rings=stood.rings,
        )  # fmt: skip
        final = zip(stood.state, result.final_state[:, 0].tolist(), strict=True)
        rings = {ring: content[0] for ring, content in result.rings().items()}
        self.standing = Standing(dict(final), {n: rings[n] for n in stood.rings})
        rows = np.ascontiguousarray(result.record_of(0).T)
        return dict(zip((each.name for each in station.program.outputs), rows, strict=True))

    def take_process(self, there: Standing) -> None:
        """Let the process stand where something else has it, and the law where it stands."""
        station, here = self.station, self.standing
        own = [entry.name for entry in station.program.state[: station.moving]]
        self.standing = Standing(
            {**here.state, **{name: there.state[name] for name in own}},
            {**here.rings, **{name: there.rings[name] for name in station.process_rings}},
        )

    def settle(self, now: Mapping[str, float], parameters: Mapping[str, float]) -> None:
        """Let its law come to stand where everything is as it is: in manual, until it is still.

        Parameters
        ----------
        now : mapping
            Input of the program to its value, the manual values where the process has them [SI].
        """
        held, moving = self.standing, self.station.moving
        names = list(held.state)
        manual = {f"{u.name}.mode": float(Mode.MANUAL) for u in self.station.loop.process.inputs}
        given = {name: np.array([value]) for name, value in {**now, **manual}.items()}
        for passed in range(LONGEST_SETTLING):
            before = self.standing.state
            self.lead(given, parameters, 1)
            after = self.standing.state
            self.take_process(held)
            if passed >= SHORTEST_SETTLING and all(
                abs(after[name] - before[name]) <= STILL * max(1.0, abs(after[name]))
                for name in names[moving:]
            ):
                break

    def forget(self) -> None:
        """Let its law begin with nothing in its memory."""
        cold = self.station.numbers.cold
        self.standing = Standing(
            {**self.standing.state, **cold.state}, {**self.standing.rings, **cold.rings}
        )
