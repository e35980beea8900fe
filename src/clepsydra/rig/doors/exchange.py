"""What a rig and a PLC tell each other every period, with the rig as the master."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Iterable

from clepsydra.base.errors import Finding, InputError
from clepsydra.rig.bus import Bus, BusFault
from clepsydra.rig.doors.snapshots import Snapshots
from clepsydra.rig.doors.wire_faults import WireFaults
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag import HEARTBEAT, Tag, Writer
from clepsydra.rig.tag_table import Refused, TagTable

#: While a PLC is silent it is asked less often, up to this [s].
_LONGEST_PAUSE = 2.0


def check_exchange(place: str, tags: Iterable[Tag], period: float) -> None:
    """Refuse an exchange in which one of the two has nothing to say, or that never comes.

    Parameters
    ----------
    place : str
        Who exchanges, for messages.
    tags : iterable of Tag
        Those that the PLC has.
    period : float
        [s]
    """
    writers = {tag.writer for tag in tags}
    for writer, words in ((Writer.PLANT, "inputs"), (Writer.CONTROLLER, "outputs")):
        if writer not in writers:
            raise InputError(
                place, Finding(f"a map without {words} of the PLC"),
                f"at least one tag of the {writer.value}", "add its row to the map",
            )  # fmt: skip
    if not 0.0 < period < math.inf:
        raise InputError(
            f"{place}, period", f"{period:g} s", "a time above 0 s", "give a longer one"
        )


class Exchange:
    """The exchange with a PLC.

    Parameters
    ----------
    tags : iterable of Tag
        Those that the PLC has.
    bus : Bus
        The way to it.
    table : TagTable
    faults : WireFaults
    reporter : Reporter
    """

    def __init__(
        self, tags: Iterable[Tag], bus: Bus, table: TagTable, faults: WireFaults,
        reporter: Reporter,
    ) -> None:  # fmt: skip
        self._bus, self._table, self._faults, self._reporter = bus, table, faults, reporter
        self._snapshots = Snapshots(table)
        known = {tag.name: tag for tag in tags}
        self._shown = [tag for tag in known.values() if tag.writer is Writer.PLANT]
        self._told = [tag for tag in known.values() if tag.writer is not Writer.PLANT]
        self._beat: float | None = None
        self._said: str | None = None

    async def run(self, period: float) -> None:
        """Exchange every period [s], until it is cancelled."""
        loop = asyncio.get_running_loop()
        pause, next_one = period, loop.time()
        while True:
            heard = await self._once()
            pause = period if heard else min(2.0 * pause, max(period, _LONGEST_PAUSE))
            # What was missed is not made up for: the PLC would hear old values.
            next_one = max(next_one + pause, loop.time())
            await asyncio.sleep(next_one - loop.time())

    async def _once(self) -> bool:
        """Exchange once, and return whether the PLC has answered."""
        if self._faults.cut:
            await self._bus.close()
            return True
        if self._faults.loses():
            return True
        await asyncio.sleep(self._faults.delay)
        now = self._snapshots.take()
        if now.sample < 0:
            return True
        try:
            await self._bus.write({tag.name: now.value(tag) for tag in self._shown})
            told = await self._bus.read(tag.name for tag in self._told)
        except BusFault as fault:
            self._say(str(fault))
            return fault.answered
        self._take(told)
        return True

    def _take(self, told: dict[str, float]) -> None:
        """Let the plant be moved by what the PLC tells, all of it or nothing."""
        beat = told.get(HEARTBEAT)
        if beat is not None and beat == self._beat:
            return
        self._beat = beat
        try:
            for tag in self._told:
                self._table.check(tag, told[tag.name])
        except Refused as refusal:
            self._say(f"the PLC tells {refusal}")
            return
        for tag in self._told:
            self._table.write(tag, told[tag.name])
        self._say("")

    def _say(self, words: str) -> None:
        """Report what is wrong, or nothing, where it was not so before."""
        if words != self._said:
            self._said = words
            self._reporter.event(words or "the PLC answers")
