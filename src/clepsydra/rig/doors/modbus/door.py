"""The door of a rig for masters of Modbus TCP."""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.base.errors import InputError
from clepsydra.rig.doors.listening import check_listening
from clepsydra.rig.doors.modbus.limits import Limits
from clepsydra.rig.doors.modbus.peers import Peers
from clepsydra.rig.doors.modbus.register_map import RegisterMap
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag_table import TagTable

#: Port 502, which is that of Modbus, is for root alone on most systems.
DEFAULT_PORT = 5020
_LARGEST_UNIT = 255


@dataclass(frozen=True)
class ModbusDoor:
    """A Modbus TCP server over the tags of a rig.

    Parameters
    ----------
    register_map : RegisterMap
        Of the rig's own registers.
    host : str
        The address of this machine at which it listens.
    port : int
        0 for any that is free.
    units : tuple of int
        The unit identifiers that it answers; any where empty, as a device that is no gateway.
    read_only : bool
        Whether no master may write.
    peers : tuple of str, optional
        Addresses and networks from which clients are accepted; all where left out.
    limits : Limits
    seed : int
        Of which requests are lost where an instructor lets requests be lost.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.doors.modbus.register_map import default_map
    >>> from clepsydra.rig.tags import tags_of
    >>> door = ModbusDoor(default_map(tags_of(cl.load("quadruple-tank").point)), read_only=True)
    >>> door.title, door.address
    ('Modbus TCP', '127.0.0.1:5020')
    """

    register_map: RegisterMap
    host: str = "127.0.0.1"
    port: int = DEFAULT_PORT
    units: tuple[int, ...] = ()
    read_only: bool = False
    peers: tuple[str, ...] | None = None
    limits: Limits = field(default_factory=Limits)
    seed: int = 1

    @property
    def title(self) -> str:
        """What reports call it."""
        return "Modbus TCP"

    @property
    def address(self) -> str:
        """Where it is found."""
        return f"{self.host}:{self.port}"

    @property
    def note(self) -> str:
        """What a master has to know."""
        return "--map shows its registers"

    def check(self) -> None:
        """Refuse what cannot work, before anything is started.

        Raises
        ------
        InputError
            The port is in use or for root alone, the host is not this machine, a peer is no
            address, or a unit is none.
        """
        for unit in self.units:
            if not 0 <= unit <= _LARGEST_UNIT:
                raise InputError(
                    "Modbus TCP, units", unit, f"a unit identifier from 0 to {_LARGEST_UNIT}",
                    "leave the units out: the rig then answers whatever unit is asked",
                )  # fmt: skip
        Peers(self.peers)
        check_listening("Modbus TCP", self.host, self.port)

    async def serve(self, table: TagTable, reporter: Reporter) -> None:
        """Serve until it is cancelled."""
        from clepsydra.rig.doors.modbus.registers import Registers
        from clepsydra.rig.doors.modbus.server import Server
        from clepsydra.rig.doors.wire_faults import WireFaults

        server = Server(
            Registers(self.register_map, table, read_only=self.read_only), self.units,
            Peers(self.peers), self.limits, WireFaults(table.image, self.seed), reporter,
        )  # fmt: skip
        await server.serve(self.host, self.port)
