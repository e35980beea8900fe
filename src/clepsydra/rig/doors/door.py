"""What every door of a rig is."""

from __future__ import annotations

from typing import Protocol

from clepsydra.rig.report import Reporter
from clepsydra.rig.tag_table import TagTable


class Door(Protocol):
    """A way from outside to the tags of a rig.

    It is a value that travels to a process of its own, in which it serves. Its file imports what
    it serves with inside its functions, so that the help of the command line stays immediate.
    """

    @property
    def title(self) -> str:
        """What reports call it: "Modbus TCP"."""

    @property
    def address(self) -> str:
        """Where it is found, for the screen: "127.0.0.1:5020"."""

    @property
    def note(self) -> str:
        """What who comes in has to know, for the screen; empty for nothing."""

    def check(self) -> None:
        """Refuse what cannot work, before anything is started.

        Raises
        ------
        InputError
            The port is in use, two registers overlap, a certificate has expired…
        """

    async def serve(self, table: TagTable, reporter: Reporter) -> None:
        """Serve until it is cancelled; say `reporter.ready()` once it can be reached."""
