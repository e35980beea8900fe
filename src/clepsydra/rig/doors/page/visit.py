"""One page that is open on a rig: it gets samples, and what it says is done."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from clepsydra.rig.doors.page.messages import Malformed, Messages, NotTaken
from clepsydra.rig.doors.page.rate import Rate
from clepsydra.rig.doors.page.stream import Stream
from clepsydra.rig.image import ProcessImage

#: How often samples are sent, and that the link lives [s].
_EVERY, _ALIVE = 0.05, 1.0
#: What hands do in a second, on and on at some sliders, and at once, as to acknowledge all alarms.
_A_SECOND, _AT_ONCE = 100.0, 1000.0
#: Of RFC 6455: data of a kind that is not taken, and what breaks the rules of the house.
_NO_SUCH_DATA, _AGAINST_RULES = 1003, 1008


class Visit:
    """A page from when its socket opens until it closes.

    Parameters
    ----------
    connection : ServerConnection
    image : ProcessImage
    messages : Messages, optional
        What it may set; None where it only looks on.
    delays : tuple of int
        Of what the plant remembers, the places of what comes out of its delays.
    visitors : callable
        Returns how many pages are open.
    """

    def __init__(
        self,
        connection: ServerConnection,
        image: ProcessImage,
        messages: Messages | None,
        delays: tuple[int, ...],
        visitors: Callable[[], int],
    ) -> None:
        self._connection, self._image, self._messages = connection, image, messages
        self._delays, self._visitors = delays, visitors

    async def last(self, rig: Mapping[str, str], since: int) -> None:
        """Serve it until it closes, beginning behind a sample that it has."""
        layout = self._image.layout
        await self._say(rig={**rig, "columns": layout.columns, "isViewer": self._messages is None})
        sending = asyncio.create_task(self._send(Stream(self._image, since)))
        hearing = asyncio.create_task(self._hear())
        try:
            await asyncio.wait((sending, hearing), return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in (sending, hearing):
                task.cancel()
                with suppress(asyncio.CancelledError):
                    await task

    async def _send(self, stream: Stream) -> None:
        now = asyncio.get_running_loop().time
        told = -_ALIVE
        with suppress(ConnectionClosed):
            while True:
                # Each page waits for its own network, and for no other page's.
                while len(rows := stream.take()):
                    if self._delays:
                        await self._say(delayed=self._delayed())
                    await self._connection.send(rows.tobytes())
                if now() - told >= _ALIVE:
                    told = now()
                    await self._say(pages=self._visitors())
                await asyncio.sleep(_EVERY)

    async def _hear(self) -> None:
        rate = Rate(_A_SECOND, _AT_ONCE)
        now = asyncio.get_running_loop().time
        with suppress(ConnectionClosed):
            async for message in self._connection:
                if not isinstance(message, str):
                    return await self._connection.close(_NO_SUCH_DATA, "a page sends text")
                if not rate.allows(now()):
                    return await self._connection.close(_AGAINST_RULES, "too much at once")
                try:
                    await self._do(message)
                except Malformed as error:
                    return await self._connection.close(_AGAINST_RULES, str(error))

    async def _do(self, message: str) -> None:
        if self._messages is None:
            return await self._say(refused="this page only looks on")
        try:
            name, value = self._messages.read(message)
            if name not in self._image.layout.written:
                raise NotTaken(f"this plant has no {name}")
        except NotTaken as error:
            return await self._say(refused=str(error))
        self._image.write(name, value)
        # The sample that the plant is about to go through may have begun.
        before = self._image.remembered()
        await self._say(taken=before[0] if before else 0)

    def _delayed(self) -> list[float]:
        """Return the sample that is over, and what comes out of each delay behind it."""
        sample, numbers = self._image.remembered() or (0, None)
        found = [] if numbers is None else [float(numbers[place]) for place in self._delays]
        return [sample - 1, *found]

    async def _say(self, **words: Any) -> None:
        await self._connection.send(json.dumps(words, allow_nan=False))
