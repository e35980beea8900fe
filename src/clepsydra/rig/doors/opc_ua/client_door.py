"""The rig as a client of a PLC's own server of OPC UA."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urlparse

from clepsydra.base.errors import InputError
from clepsydra.base.standing import Standing, standing_at
from clepsydra.rig.doors.exchange import Exchange, check_exchange
from clepsydra.rig.doors.opc_ua.client import POLICIES, Access, OpcUaBus
from clepsydra.rig.doors.opc_ua.node_map import NodeMap
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag_table import TagTable


@dataclass(frozen=True)
class OpcUaClientDoor:
    """The rig as the client of a PLC that is a server, as most PLCs with OPC UA are.

    Every period it writes the plant's tags into the PLC's nodes and reads the controller's. Where
    the map has the heartbeat, the controller counts as heard only while it changes: a PLC in STOP
    still answers. A PLC that is silent, refuses, or tells what no tag takes is reported once, and
    moves nothing.

    Parameters
    ----------
    access : Access
        To the PLC.
    nodes : NodeMap
        Its nodes. Values become what the PLC takes, by its own data types; a real number for a
        node of whole ones is rounded.
    period : float
        Between two exchanges [s]; what the PLC answers to one is read by the next, so take a
        fraction of the sampling period.
    seed : int
        Of which exchanges are lost where an instructor lets requests be lost.
    """

    access: Access
    nodes: NodeMap
    period: float = 0.1
    seed: int = 1

    @property
    def title(self) -> str:
        """What reports call it."""
        return "OPC UA client"

    @property
    def address(self) -> str:
        """The PLC's."""
        return self.access.address

    @property
    def note(self) -> str:
        """What who comes in has to know: nobody does."""
        return ""

    def check(self) -> None:
        """Refuse what cannot work, before anything is started.

        Whether the PLC is there is no matter: it may be switched on later.

        Raises
        ------
        InputError
            The map has nothing to read or to write, the address, the policy or the period is
            none, or a certificate or a password cannot be read.
        """
        check_exchange(self.title, self.nodes.mapped, self.period)
        address = urlparse(self.access.address)
        if address.scheme != "opc.tcp" or not address.hostname:
            raise InputError(
                self.title, self.access.address, "an address such as opc.tcp://192.168.0.10:4840",
                "take it from the settings of the PLC",
            )  # fmt: skip
        if self.access.policy not in (*POLICIES, "None"):
            raise InputError(
                self.title, self.access.policy, ", ".join((*POLICIES, "None")),
                "choose what the PLC offers; those that are deprecated are not offered here",
            )  # fmt: skip
        self.access.identity.check()
        for path in (self.access.server_certificate, self.access.password_file):
            if path is None:
                continue
            remedy = "give the PLC's certificate in DER, and the password in a file"
            expected = "a file that is there"
            if standing_at(path, self.title, expected, remedy) is not Standing.FILE:
                raise InputError(self.title, str(path), expected, remedy)

    async def serve(self, table: TagTable, reporter: Reporter) -> None:
        """Exchange until it is cancelled."""
        from clepsydra.rig.doors.opc_ua.server import silence_asyncua
        from clepsydra.rig.doors.wire_faults import WireFaults

        silence_asyncua()
        if self.access.policy == "None":
            reporter.event(f"{self.address} is without security: anybody on the wire may change it")
        elif self.access.server_certificate is None:
            reporter.event(f"any certificate of {self.address} is taken: give the PLC's own")
        bus = OpcUaBus(self.access, self.nodes)
        faults = WireFaults(table.image, self.seed)
        exchange = Exchange(self.nodes.mapped, bus, table, faults, reporter)
        reporter.ready(self.address)
        try:
            await exchange.run(self.period)
        finally:
            await bus.close()
