"""The workers of a cluster at one campaign: each is asked, given the job, then chunks of it."""

from __future__ import annotations

import time
import zlib
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from queue import Empty, Queue
from typing import TYPE_CHECKING, Any

from clepsydra.base.errors import Finding, InputError
from clepsydra.studies.robustness.campaign import Campaign
from clepsydra.studies.robustness.chunk_work import JobMissing, draw, take
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.tally import Tally
from clepsydra.studies.robustness.workers_alike import (
    WorkerAnswer,
    drawing_nothing,
    drawing_others,
    own_answer,
    refusal,
    sample,
)

if TYPE_CHECKING:
    from distributed import Client, Future

#: How often it is looked who is there, and how long none may be [s].
_LOOK, _PATIENCE = 1.0, 30.0
#: Chunks that wait at a worker beside those that it works on, so that it never waits itself.
_AHEAD = 1
#: Workers that may vanish with one and the same chunk.
_MOST_LOST = 4


@dataclass
class _Worker:
    """A worker, and how far it is with this campaign."""

    threads: int
    ready: bool = False
    refused: InputError | None = None
    chunks: set[int] = field(default_factory=set)


@dataclass(frozen=True)
class _Asked:
    """What a worker was asked: what it says of itself, to take the job, or to draw a chunk."""

    future: Future
    address: str
    took: Callable[[_Asked, Any], tuple[int, Tally] | None]
    chunk: int | None = None


def packed(loops: DrawnLoops) -> bytes:
    """Return loops as bytes that travel; what a script itself defines goes along by its code."""
    try:
        from cloudpickle import dumps
    except ImportError:  # of dask, without which nothing travels
        from pickle import dumps
    return zlib.compress(dumps(loops), 1)


class Crew:
    """Who works at a campaign, and what each has in hand.

    A chunk is given to one worker by name, so that it is known who has what. What a worker has in
    hand as it vanishes is given to another: a chunk is its numbers alone, so nothing else is lost.

    Parameters
    ----------
    client : distributed.Client
    campaign : Campaign
    place : str
        Of the cluster, for messages.
    tell : callable
        Takes words about a worker that is left out.
    """

    def __init__(
        self, client: Client, campaign: Campaign, place: str, tell: Callable[[str], None]
    ) -> None:
        self._client, self._campaign, self._place, self._tell = client, campaign, place, tell
        self._own, self._sample = own_answer(), sample(campaign.loops, campaign.draws)
        self._packed = packed(campaign.loops)
        self._workers = dict[str, _Worker]()
        self._asked = dict[object, _Asked]()  # by the key of the future
        self._ended: Queue[Future] = Queue()
        self._left, self._lost = deque[int](), Counter[int]()
        self._looked = self._worked = 0.0

    def carry(self, chunks: Iterable[int]) -> Generator[tuple[int, Tally], None, None]:
        """Yield chunks with what came of them, as they come.

        Raises
        ------
        InputError
            No worker is left that may work, or the cluster has gone.
        """
        self._left.extend(chunks)
        self._worked = time.monotonic()
        try:
            while self._left or any(each.chunks for each in self._workers.values()):
                self._look()
                self._give()
                with suppress(Empty):
                    found = self._took(self._ended.get(timeout=_LOOK))
                    if found is not None:
                        yield found
        finally:
            self._call_off(list(self._asked.values()))

    def _look(self) -> None:
        """See who has come and who has gone, about once a second."""
        now = time.monotonic()
        if now - self._looked < _LOOK:
            return
        self._looked = now
        try:
            if self._client.status != "running":
                raise OSError
            there = self._client.nthreads()
        except OSError:
            raise InputError(
                self._place, Finding("a scheduler that has gone"), "one that stays to the end",
                "start it again; draws that are kept in a file go on from there",
            ) from None  # fmt: skip
        for address in self._workers.keys() - there.keys():
            self._forget(address)
        for address in there.keys() - self._workers.keys():
            self._workers[address] = _Worker(there[address])
            self._ask(_Asked(self._submit(address, own_answer), address, self._answered))
        refused = [each.refused for each in self._workers.values()]
        if any(each is None for each in refused):
            self._worked = now
        elif refused and refused[0] is not None:
            raise refused[0]
        elif now - self._worked > _PATIENCE:
            raise InputError(
                self._place, Finding("no worker"), f"one within {_PATIENCE:g} s", "start some"
            )

    def _give(self) -> None:
        """Give each worker that is ready as many chunks as it can have in hand."""
        for address, worker in self._workers.items():
            while worker.ready and self._left and len(worker.chunks) < worker.threads + _AHEAD:
                chunk = self._left.popleft()
                worker.chunks.add(chunk)
                future = self._submit(address, draw, self._sample, *self._campaign.ends(chunk))
                self._ask(_Asked(future, address, self._drawn, chunk))

    def _submit(self, address: str, function: Callable[..., Any], *arguments: object) -> Future:
        return self._client.submit(
            function, *arguments, workers=[address], allow_other_workers=False, pure=False
        )

    def _ask(self, asked: _Asked) -> None:
        self._asked[asked.future.key] = asked
        asked.future.add_done_callback(self._ended.put)

    def _took(self, future: Future) -> tuple[int, Tally] | None:
        """Take what a worker has answered; what was called off meanwhile is nobody's."""
        asked = self._asked.pop(future.key, None)
        if asked is None:
            return None
        from distributed import CancelledError

        try:
            return asked.took(asked, self._fetched(asked))
        except (JobMissing, CancelledError, OSError) as error:
            if isinstance(error, OSError) and future.status == "error":
                raise  # what the worker itself came upon
            # Otherwise it has gone, or been started anew.
            self._asked[future.key] = asked
            self._forget(asked.address)
        except (ImportError, AttributeError) as error:
            if asked.chunk is not None:
                raise
            self._refuse(asked.address, drawing_nothing(asked.address, error))
        return None

    def _fetched(self, asked: _Asked) -> Any:
        """Return an answer, which is at its worker still, and goes with it."""
        patience = _LOOK
        while True:
            try:
                return asked.future.result(timeout=patience)
            except TimeoutError:
                if asked.future.status == "error" or asked.address not in self._client.nthreads():
                    raise
                patience *= 2.0  # a long answer on a slow line

    def _answered(self, asked: _Asked, said: WorkerAnswer) -> None:
        address = asked.address
        error = refusal(address, said, self._own)
        if error is None and self._campaign.loops.fuse and not said.fuses:
            error = InputError(
                f"worker {address}", Finding("a processor that fuses no multiply-adds"),
                "one that does, as those that were there first", "begin anew with it",
            )  # fmt: skip
        if error is not None:
            self._refuse(address, error)
            return
        future = self._submit(address, take, self._sample, self._packed, self._campaign.draws)
        self._ask(_Asked(future, address, self._taken))

    def _taken(self, asked: _Asked, found: str) -> None:
        if found == self._sample:
            self._workers[asked.address].ready = True
        else:
            self._refuse(asked.address, drawing_others(asked.address))

    def _drawn(self, asked: _Asked, found: Tally) -> tuple[int, Tally]:
        assert asked.chunk is not None
        self._workers[asked.address].chunks.discard(asked.chunk)
        return asked.chunk, found

    def _call_off(self, asked: list[_Asked]) -> None:
        """Let nothing begin that waits; what a worker is at it ends, to no purpose."""
        for each in asked:
            del self._asked[each.future.key]
        with suppress(OSError, RuntimeError):  # the cluster may have gone as a whole
            self._client.cancel([each.future for each in asked], force=True)

    def _refuse(self, address: str, error: InputError) -> None:
        self._workers[address].refused = error
        self._tell(f"{error} It is given no draws.")

    def _forget(self, address: str) -> None:
        """Take back what a worker has in hand; where it is still there it is asked anew."""
        gone = self._workers.pop(address, None)
        if gone is None:
            return
        asked = [each for each in self._asked.values() if each.address == address]
        self._call_off(asked)
        # The lowest first, as they were.
        for chunk in sorted(gone.chunks, reverse=True):
            self._left.appendleft(chunk)
            self._lost[chunk] += 1
            if self._lost[chunk] == _MOST_LOST:
                first, last = self._campaign.ends(chunk)
                raise InputError(
                    f"{self._place}, draws {first} to {last}",
                    Finding(f"{_MOST_LOST} workers that vanished"), "workers that stay",
                    "look what they said last; the memory may be too small for so many workers",
                )  # fmt: skip
