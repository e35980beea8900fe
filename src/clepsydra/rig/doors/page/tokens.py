"""Tokens that are tried at the page of a rig: wrong ones take their time, and are told."""

from __future__ import annotations

import asyncio

from clepsydra.rig.report import Reporter

#: A wrong one takes so long [s], one after the other; more than so many at once are not looked at.
_WRONG, _WAITING = 1.0, 8
#: They are told no more often than this [s].
_TOLD = 60.0


class WrongTokens:
    """Who tries tokens that are wrong.

    Parameters
    ----------
    reporter : Reporter
    takes : float
        How long each takes [s].
    """

    def __init__(self, reporter: Reporter, takes: float = _WRONG) -> None:
        self._reporter, self._takes = reporter, takes
        self._turn = asyncio.Lock()
        self._waiting, self._count = 0, 0
        self._told = -_TOLD

    async def tried(self, peer: str) -> None:
        """Let who has tried one wait, after those who have tried before."""
        self._count += 1
        now = asyncio.get_running_loop().time()
        if now - self._told >= _TOLD:
            self._told = now
            self._reporter.event(f"a wrong token from {peer}, {self._count} in all")
        if self._waiting >= _WAITING:
            return
        self._waiting += 1
        try:
            async with self._turn:
                await asyncio.sleep(self._takes)
        finally:
            self._waiting -= 1
