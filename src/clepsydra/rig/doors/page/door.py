"""The door of a rig for browsers: the page of the laboratory, attached to the running plant."""

from __future__ import annotations

import secrets
import socket
from dataclasses import dataclass, field
from pathlib import Path

from clepsydra.base.errors import Finding, InputError
from clepsydra.rig.doors.packages import require_packages
from clepsydra.rig.doors.page.cell import Cell
from clepsydra.rig.doors.page.gate import Gate, is_loopback, own_names
from clepsydra.rig.doors.page.messages import Messages
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag_table import TagTable

DEFAULT_PORT = 8010
_MOST = 50


def token_for(host: str) -> str:
    """Return a new token where others than this machine reach an address; "" where none does.

    Examples
    --------
    >>> token_for("127.0.0.1"), len(token_for("0.0.0.0"))
    ('', 32)
    """
    return "" if is_loopback(host) else secrets.token_urlsafe(24)


@dataclass(frozen=True)
class PageDoor:
    """A server of the page over the process image of a rig.

    Parameters
    ----------
    page : Path
        Of the HTML, which was written for this rig.
    plant : str
        What tells its plant from every other.
    cells : tuple of Cell
        What a page may set.
    delays : tuple of int
        Of what the plant remembers, the places of what comes out of its delays.
    host : str
        The address of this machine at which it listens.
    port : int
        0 for any that is free.
    token : str
        What opens it, beyond this machine; shown once, with the address.
    view_only : bool
        Whether pages only look on.
    most : int
        Pages that may be open at once.
    start : str
        What tells this start of the rig from those before, after which samples count anew.

    Examples
    --------
    >>> door = PageDoor(Path("page.html"), "", ())
    >>> door.title, door.address
    ('Page', 'http://127.0.0.1:8010/')
    """

    page: Path
    plant: str
    cells: tuple[Cell, ...]
    delays: tuple[int, ...] = ()
    host: str = "127.0.0.1"
    port: int = DEFAULT_PORT
    token: str = field(default="", repr=False)
    view_only: bool = False
    most: int = _MOST
    start: str = field(default_factory=lambda: secrets.token_hex(8), repr=False)

    @property
    def title(self) -> str:
        """What reports call it."""
        return "Page"

    @property
    def address(self) -> str:
        """Where it is found, with its token."""
        return self._address(self.port) + (f"?token={self.token}" if self.token else "")

    def _address(self, port: int) -> str:
        is_any = self.host in ("0.0.0.0", "::", "")
        host = own_names()[0] if is_any else self.host
        return f"http://{f'[{host}]' if ':' in host else host}:{port}/"

    @property
    def note(self) -> str:
        """What a reader has to know: the address has all."""
        return ""

    def check(self) -> None:
        """Refuse what cannot work, before anything is started.

        Raises
        ------
        InputError
            websockets is missing, the port is in use, the host is not this machine, or others reach
            it without a token.
        """
        from clepsydra.rig.doors.listening import check_listening

        require_packages("page", "websockets")
        check_listening("page", self.host, self.port)
        if not self.token and not is_loopback(self.host):
            raise InputError(
                "page, token", Finding("none"), f"a token where others reach {self.host}",
                "give one, or listen at 127.0.0.1 only",
            )  # fmt: skip

    async def serve(self, table: TagTable, reporter: Reporter) -> None:
        """Serve until it is cancelled."""
        from websockets.asyncio.server import serve

        from clepsydra.rig.doors.page.server import PageServer

        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        listener = socket.create_server((self.host, self.port), family=family)
        port = listener.getsockname()[1]
        rig = {"plant": self.plant, "start": self.start}
        messages = None if self.view_only else Messages(self.cells)
        server = PageServer(
            self.page, rig, table.image, messages, self.delays,
            Gate(port, self.token, own_names()), self.most, reporter,
        )  # fmt: skip
        async with serve(sock=listener, **server.settings) as running:
            reporter.ready(self._address(port))
            await running.serve_forever()
