"""The door of OPC UA: the tags of a rig for its clients."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass, field
from pathlib import Path

from clepsydra.rig.doors.listening import check_listening
from clepsydra.rig.doors.opc_ua.address_space import check_names
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.trust import TrustList
from clepsydra.rig.doors.opc_ua.users import OPERATOR, PASSWORD, Users, check_password, password_in
from clepsydra.rig.doors.packages import require_packages
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import TagTable

#: The port of OPC UA.
PORT = 4840


@dataclass(frozen=True)
class OpcUaDoor:
    """A server of OPC UA, in a process of its own.

    Its policies are Basic256Sha256, Aes128_Sha256_RsaOaep and Aes256_Sha256_RsaPss, signed or
    signed and encrypted; those that are deprecated are not offered. A client's certificate stands
    in `folder/trusted`; what did not is kept in `folder/rejected`. Who writes is the user
    "operator", whose password is in `folder/operator.password`, or has a certificate that is
    trusted.

    Parameters
    ----------
    folder : Path
        Of certificates and of the password, made on first start.
    tags : tuple of Tag
        Those of the table that it serves.
    host : str
    port : int
        0 for any that is free.
    anonymous : bool
        Whether anybody may read, without a name and without security; nobody writes so.
    silent_after : float
        Where the plant has told nothing for so long, its tags have no values [s].
    seed : int
        Of which requests are lost where an instructor lets requests be lost.

    Examples
    --------
    >>> door = OpcUaDoor(Path("certificates"))
    >>> door.title, door.address
    ('OPC UA', 'opc.tcp://127.0.0.1:4840/clepsydra')
    """

    folder: Path
    tags: tuple[Tag, ...] = field(default=(), repr=False)
    host: str = "127.0.0.1"
    port: int = PORT
    anonymous: bool = False
    silent_after: float = math.inf
    seed: int = 1

    @property
    def title(self) -> str:
        """What reports call it."""
        return "OPC UA"

    @property
    def address(self) -> str:
        """Where it is found."""
        return _address(self.host, self.port)

    @property
    def note(self) -> str:
        """What a client has to know."""
        return f"user {OPERATOR}, password in {self.folder / PASSWORD}"

    @property
    def identity(self) -> Identity:
        """The certificate of the server."""
        return Identity(self.folder, "rig")

    def check(self) -> None:
        """Refuse what cannot work, before anything is started.

        Raises
        ------
        InputError
            asyncua is missing, the port is in use, a certificate has expired, is not yet valid or
            cannot be read, others may read the password, or OPC UA has no name for a tag.
        """
        require_packages(self.title, "asyncua", "cryptography")
        check_names(self.tags)
        self.identity.check()
        check_password(self.folder)
        check_listening(self.title, self.host, self.port)

    async def serve(self, table: TagTable, reporter: Reporter) -> None:
        """Serve until it is cancelled."""
        from clepsydra.rig.doors.opc_ua.server import RigServer, silence_asyncua

        silence_asyncua()
        trust = TrustList(self.folder, reporter.event)
        self.identity.make(self.host)
        trust.make()
        users = Users(password_in(self.folder), trust, self.anonymous)
        server = RigServer(
            table, self.identity, users, trust, reporter.event, self.silent_after, self.seed
        )
        await server.init_rig(self.host, self.port)
        try:
            await server.start()
        except OSError:
            # Somebody was faster since it was checked.
            check_listening(self.title, self.host, self.port)
            raise
        try:
            assert server.bserver is not None
            reporter.ready(_address(self.host, server.bserver.port))
            await server.follow()
        finally:
            with contextlib.suppress(Exception):
                await server.stop()


def _address(host: str, port: int) -> str:
    shown = f"[{host}]" if ":" in host else host
    return f"opc.tcp://{shown}:{port}/clepsydra"
