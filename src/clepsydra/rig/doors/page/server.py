"""The server of the page: HTTP for the page itself, a WebSocket for what it shows and does."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Any

from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from clepsydra.rig.doors.page.answers import cookie_answer, page_answer, words_answer
from clepsydra.rig.doors.page.gate import Asked, Gate
from clepsydra.rig.doors.page.messages import LONGEST, Messages
from clepsydra.rig.doors.page.tokens import WrongTokens
from clepsydra.rig.doors.page.visit import Visit
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.report import Reporter

#: Where the page talks to its rig.
RIG = "/rig"
#: Who has not asked for anything, answered a ping or closed within this is let go [s].
OPENS, PINGS, CLOSES = 5.0, 10.0, 2.0
#: What waits for one page before the next samples are made for it [bytes].
WAITING = 1 << 18
#: Connections that are not pages, at once: those that are being opened.
OPENING = 64
#: A browser asks for it of itself.
_ICON = "/favicon.ico"


class Counted(ServerConnection):
    """A connection that is cut off at once where there are too many of them.

    Parameters
    ----------
    others : set of ServerConnection
    most : int
    """

    def __init__(self, others: set[ServerConnection], most: int, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self._others, self._most = others, most

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Count it."""
        super().connection_made(transport)
        self._others.add(self)
        if len(self._others) > self._most:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Count it no more."""
        self._others.discard(self)
        super().connection_lost(exc)


class PageServer:
    """What answers browsers.

    Parameters
    ----------
    page : Path
        Of the HTML.
    rig : mapping
        What tells the plant from every other, as the page has it, and this start from those before.
    image : ProcessImage
    messages : Messages, optional
        None where pages only look on.
    delays : tuple of int
    gate : Gate
    most : int
        Pages that may be open at once.
    reporter : Reporter
    """

    def __init__(
        self,
        page: Path,
        rig: Mapping[str, str],
        image: ProcessImage,
        messages: Messages | None,
        delays: tuple[int, ...],
        gate: Gate,
        most: int,
        reporter: Reporter,
    ) -> None:
        self._page = page.read_text("utf-8")
        self._rig, self._image, self._messages = rig, image, messages
        self._delays, self._gate, self._most = delays, gate, most
        self._reporter, self._wrong = reporter, WrongTokens(reporter)
        self._open: set[ServerConnection] = set()
        self._connections: set[ServerConnection] = set()
        self._was_full = False

    @property
    def settings(self) -> dict[str, Any]:
        """How `websockets.asyncio.server.serve` serves it."""
        # What clients do wrong is theirs to know; the library would print it.
        silent = logging.getLogger(__name__)
        silent.addHandler(logging.NullHandler())
        silent.propagate = False
        return {
            "handler": self.visit,
            "process_request": self.answer,
            "compression": None,
            "max_size": LONGEST,
            "open_timeout": OPENS,
            "ping_interval": PINGS,
            "ping_timeout": PINGS,
            "close_timeout": CLOSES,
            "write_limit": WAITING,
            "server_header": None,
            "logger": silent,
            "create_connection": self._connected,
        }

    def _connected(self, *given: Any, **named: Any) -> ServerConnection:
        return Counted(self._connections, self._most + OPENING, *given, **named)

    async def answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return the answer to a request; None lets the WebSocket open."""
        headers = request.headers
        asked = Asked(
            request.path, *(tuple(headers.get_all(name)) for name in ("Host", "Origin", "Cookie"))
        )
        try:
            path, given = asked.path, asked.given("token")
        except ValueError:
            return words_answer(HTTPStatus.BAD_REQUEST, "that is no address")
        if doubt := self._gate.doubt(asked):
            return words_answer(HTTPStatus.FORBIDDEN, doubt)
        if self._gate.token and (refused := await self._unknown(connection, asked, given)):
            return refused
        if path == "/":
            return page_answer(self._page, asked.hosts[0])
        if path == _ICON:
            return words_answer(HTTPStatus.NOT_FOUND, "there is no icon")
        if path != RIG:
            return words_answer(HTTPStatus.NOT_FOUND, "there is a page at /, and nothing else")
        return self._full() if len(self._open) >= self._most else None

    async def _unknown(
        self, connection: ServerConnection, asked: Asked, given: str
    ) -> Response | None:
        gate = self._gate
        if given and gate.knows(given):
            return cookie_answer(gate.cookie, gate.token)
        kept = asked.kept(gate.cookie)
        if kept and gate.knows(kept):
            return None
        if given or kept:
            await self._wrong.tried(str(connection.remote_address[0]))
        words = "open the address that the rig printed when it was started, with its token"
        return words_answer(HTTPStatus.UNAUTHORIZED, words)

    def _full(self) -> Response:
        if not self._was_full:
            self._reporter.event(f"{self._most} pages are open: no other one is let in")
        self._was_full = True
        return words_answer(HTTPStatus.SERVICE_UNAVAILABLE, f"{self._most} pages are open")

    async def visit(self, connection: ServerConnection) -> None:
        """Serve a page as long as it is open."""
        if len(self._open) >= self._most:
            # Several have come at once.
            return await connection.close(1013, f"{self._most} pages are open")
        self._open.add(connection)
        try:
            visit = Visit(
                connection, self._image, self._messages, self._delays, lambda: len(self._open)
            )
            request = connection.request
            assert request is not None
            await visit.last(self._rig, _since(Asked(request.path, ()).given("since")))
        finally:
            self._open.discard(connection)
            self._was_full = False


def _since(text: str) -> int:
    """Return the last sample that a page says to have; −1 for none."""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 16 else -1
