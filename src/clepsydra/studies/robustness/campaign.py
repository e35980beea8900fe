"""Many draws, chunk by chunk: with progress, an interrupt that loses nothing, and a way on."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.files import whole_file
from clepsydra.base.input_file import read_input
from clepsydra.base.standing import Standing, standing_at
from clepsydra.base.words import time_text
from clepsydra.engine.threads import side_by_side
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.tally import Tally

#: A file is written no more often than this, and at the end [s].
_PAUSE = 10.0
#: Chunks whose tallies are merged at once.
_TOGETHER = 32
_LARGEST = 4_000_000_000
_WRITTEN = "what an interrupted run of draws wrote"
_FORMAT = 1
#: What carries chunks out: takes the campaign and numbers of chunks, and yields each number with
#: its tally in any order; what it has begun ends where it is closed.
Carrier = Callable[["Campaign", Iterable[int]], Generator[tuple[int, Tally], None, None]]


@dataclass(frozen=True)
class DrawProgress:
    """How far it is.

    Attributes
    ----------
    done, of : int
        Draws.
    seconds_left : float
        By what the draws so far have taken; infinite before the first.
    """

    done: int
    of: int
    seconds_left: float

    @property
    def name(self) -> str:
        """What comes next, in words."""
        if self.done == self.of:
            return "draws"
        left = self.seconds_left
        return "draws" if math.isinf(left) else f"draws, about {time_text(left, 2)} left"


@dataclass(frozen=True, eq=False)
class Campaign:
    """So many draws, from 1 on, in chunks that follow from their numbers.

    Attributes
    ----------
    loops : DrawnLoops
    draws : int

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.studies.robustness.drawn_plants import DrawnPlants
    >>> plant = cl.load("three-tanks")
    >>> plants = DrawnPlants(plant.point, plant.analysis.pairing, plant.process.uncertainty)
    >>> loops = DrawnLoops(cl.design.simc(plant), default_scenario(plant.linear), plants, ())
    >>> Campaign(loops, 300).run().draws
    300
    """

    loops: DrawnLoops
    draws: int

    @property
    def chunks(self) -> range:
        """The numbers of its chunks."""
        return range(-(-self.draws // self.loops.chunk))

    def ends(self, chunk: int) -> tuple[int, int]:
        """Return the first and the last draw of a chunk."""
        size = self.loops.chunk
        return size * chunk + 1, min(size * (chunk + 1), self.draws)

    def tally(self, chunk: int) -> Tally:
        """Return what came of one chunk."""
        first, last = self.ends(chunk)
        return Tally.of(self.loops.draw(np.arange(first, last + 1)))

    def run(
        self,
        *,
        carrier: Carrier | None = None,
        state_file: Path | None = None,
        progress: Callable[[DrawProgress], None] | None = None,
    ) -> Tally:
        """Return what came of all draws.

        Parameters
        ----------
        carrier : callable, optional
            Carries chunks out elsewhere; here if left out.
        state_file : Path, optional
            Where what is done is kept, so that the same call goes on after an interrupt.
        progress : callable, optional
            Takes how far it is, after each chunk.

        Raises
        ------
        InputError
            The file is of other draws, or damaged.
        """
        kept = _Kept(self, state_file)
        began, before = time.monotonic(), kept.draws
        try:
            left = [chunk for chunk in self.chunks if chunk not in kept.done]
            if progress is not None:
                progress(DrawProgress(before, self.draws, math.inf))
            with closing((carrier or _here)(self, left)) as carried:
                for chunk, found in carried:
                    kept.add(chunk, found)
                    if progress is not None:
                        now = kept.draws
                        each = (time.monotonic() - began) / (now - before)
                        progress(DrawProgress(now, self.draws, each * (self.draws - now)))
        finally:
            kept.close()
        return kept.tally()


def _here(campaign: Campaign, chunks: Iterable[int]) -> Generator[tuple[int, Tally], None, None]:
    """Carry chunks out side by side, as many as there are processors."""
    yield from side_by_side(lambda chunk: (chunk, campaign.tally(chunk)), chunks)


class _Kept:
    """What is done, in memory and in a file if one is named."""

    def __init__(self, campaign: Campaign, path: Path | None) -> None:
        self._campaign, self._path = campaign, path
        self._parts, self._written = list[Tally](), time.monotonic()
        self.done = set[int]()
        self._saved = True
        if path is not None:
            self._read(path)

    @property
    def draws(self) -> int:
        """How many draws are done."""
        return sum(part.draws for part in self._parts)

    def add(self, chunk: int, found: Tally) -> None:
        """Add what came of a chunk, and write it now and then."""
        self.done.add(chunk)
        self._parts.append(found)
        self._saved = False
        if len(self._parts) >= _TOGETHER:
            self._parts = [self.tally()]
        if time.monotonic() - self._written > _PAUSE:
            self.close()

    def tally(self) -> Tally:
        """Return what came of all chunks that are done."""
        return self._parts[0].merged(*self._parts[1:])

    def close(self) -> None:
        """Write what is not written yet."""
        if self._path is None or self._saved:
            return
        said = {
            "format": _FORMAT,
            "draws": self._digest,
            "done": sorted(self.done),
            "tally": self.tally().as_dict(),
        }
        with whole_file(self._path) as part:
            part.write_text(json.dumps(said), encoding="utf-8")
        self._written, self._saved = time.monotonic(), True

    @property
    def _digest(self) -> str:
        campaign = self._campaign
        return f"{campaign.loops.digest} {campaign.loops.chunk} {campaign.draws}"

    def _read(self, path: Path) -> None:
        place = f"robustness, {path}"
        if standing_at(path, place, _WRITTEN) is Standing.NOTHING:
            return
        remedy = "choose another file, or delete this one to begin again"
        try:
            said = json.loads(read_input(path, _WRITTEN, _LARGEST))
            known, done = (said["format"], said["draws"]), {int(each) for each in said["done"]}
            tally = said["tally"]
        except (ValueError, TypeError, KeyError, RecursionError):
            finding = Finding("something else, or changed since")
            raise InputError(place, finding, _WRITTEN, remedy) from None
        if known != (_FORMAT, self._digest):
            raise InputError(
                place, Finding("the state of other draws"),
                "one of this plant, controller, scenario, uncertainty and number of draws, with "
                f"multiply-adds {'fused' if self._campaign.loops.fuse else 'not fused'}", remedy,
            )  # fmt: skip
        self._parts, self.done = [Tally.from_dict(tally)], done
