"""The rig as a master of a PLC: it writes what the plant shows, and reads what the PLC commands."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clepsydra.base.errors import Finding, InputError
from clepsydra.rig.doors.exchange import Exchange, check_exchange
from clepsydra.rig.doors.modbus.register_map import RegisterMap, Server
from clepsydra.rig.doors.packages import require_packages
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag_table import TagTable

_LARGEST_UNIT, _LARGEST_PORT = 255, 0xFFFF


@dataclass(frozen=True)
class ModbusClientDoor:
    """The rig as the Modbus TCP client of a PLC whose program is a server, such as OpenPLC.

    Every period it writes the plant's tags into the PLC's registers and reads the controller's.
    Where the map has the heartbeat, the controller counts as heard only while it changes: a PLC
    in STOP still answers. A PLC that is silent, refuses, or tells what no tag takes is reported
    once, and moves nothing.

    Parameters
    ----------
    register_map : RegisterMap
        Of the PLC's registers.
    host : str
    port : int
    period : float
        Between two exchanges [s]; what the PLC answers to one is read by the next, so take a
        fraction of the sampling period.
    unit : int
        The PLC's unit identifier.
    timeout : float
        A PLC that has not answered after so long is silent [s].
    seed : int
        Of which exchanges are lost where an instructor lets requests be lost.
    """

    register_map: RegisterMap
    host: str
    port: int = 502
    period: float = 0.1
    unit: int = 255
    timeout: float = 1.0
    seed: int = 1

    @property
    def title(self) -> str:
        """What reports call it."""
        return "Modbus TCP client"

    @property
    def address(self) -> str:
        """The PLC's."""
        return f"{self.host}:{self.port}"

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
            The map has nothing to read or to write, or is of the rig's registers; a port, a unit
            or a time is none.
        """
        place = self.title
        require_packages(place, "pymodbus")
        if self.register_map.server is not Server.PLC:
            raise InputError(
                place, Finding("a map of the rig's registers"), "a map of the PLC's registers",
                "give the file that says where the PLC has its inputs and outputs",
            )  # fmt: skip
        check_exchange(place, self.register_map.tags, self.period)
        if not 1 <= self.port <= _LARGEST_PORT:
            raise InputError(
                place, self.port, "a port from 1 to 65535", "give that of the PLC, mostly 502"
            )
        if not 0 <= self.unit <= _LARGEST_UNIT:
            raise InputError(
                place, self.unit, f"a unit identifier from 0 to {_LARGEST_UNIT}",
                "give 255 for a PLC that is no gateway",
            )  # fmt: skip
        if not 0.0 < self.timeout < math.inf:
            raise InputError(
                f"{place}, time-out", f"{self.timeout:g} s", "a time above 0 s",
                "give a longer one",
            )  # fmt: skip

    async def serve(self, table: TagTable, reporter: Reporter) -> None:
        """Exchange until it is cancelled."""
        from clepsydra.rig.doors.modbus.master import ModbusMaster
        from clepsydra.rig.doors.wire_faults import WireFaults

        master = ModbusMaster(
            self.register_map, self.host, self.port, unit=self.unit, timeout=self.timeout
        )
        exchange = Exchange(
            self.register_map.tags, master, table, WireFaults(table.image, self.seed), reporter
        )
        reporter.ready(self.address)
        try:
            await exchange.run(self.period)
        finally:
            await master.close()
