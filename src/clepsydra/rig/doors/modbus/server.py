"""A Modbus TCP server over the tags of a rig.

It is our own, since that of pymodbus 3.16.1 answers only the first of several requests that a
client sends without waiting, answers a wrong number of registers with function code 128 and
exception 1, writes before it refuses a read-and-write, and takes any number for a coil
(`findings/pymodbus_server_answers_wrongly.sh`); nor does it bound clients, or what they do not
take.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

from clepsydra.rig.doors.listening import not_listening
from clepsydra.rig.doors.modbus.codes import ExceptionCode
from clepsydra.rig.doors.modbus.connection import Connection
from clepsydra.rig.doors.modbus.functions import answer, refused
from clepsydra.rig.doors.modbus.limits import Limits
from clepsydra.rig.doors.modbus.peers import Peers
from clepsydra.rig.doors.modbus.registers import Registers
from clepsydra.rig.doors.wire_faults import WireFaults
from clepsydra.rig.report import Reporter

#: How often it is looked who is idle, and whether the cable is pulled [s].
_ROUND = 0.05
#: Reports a second; what is more is counted and told once.
_REPORTS = 5


class Server:
    """Who is connected, and what all of them are answered.

    Parameters
    ----------
    registers : Registers
    units : sequence of int
        The unit identifiers that it is; none for any, as a device that is no gateway
        (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, section 4.4.2.1.3).
    peers : Peers
    limits : Limits
    faults : WireFaults
    reporter : Reporter
    """

    def __init__(
        self, registers: Registers, units: Sequence[int], peers: Peers, limits: Limits,
        faults: WireFaults, reporter: Reporter,
    ) -> None:  # fmt: skip
        self._registers, self._units, self._peers = registers, frozenset(units), peers
        self._limits, self._faults, self._reporter = limits, faults, reporter
        self._connections: set[Connection] = set()
        self._reported = self._dropped = 0

    async def serve(self, host: str, port: int) -> None:
        """Serve until it is cancelled; return where it cannot begin, which is reported."""
        loop = asyncio.get_running_loop()
        try:
            listening = await loop.create_server(self._connection, host, port)
        except OSError as error:  # the port was taken since it was looked at
            self._reporter.refused(not_listening("Modbus TCP", error, host, port))
            return
        here = listening.sockets[0].getsockname()
        self._reporter.ready(f"{here[0]}:{here[1]}")
        try:
            while True:
                for _ in range(round(1.0 / _ROUND)):
                    await asyncio.sleep(_ROUND)
                    self._let_go(loop.time())
                self._report_again()
        finally:
            listening.close()
            for connection in list(self._connections):
                connection.end()

    def _connection(self) -> Connection:
        return Connection(
            self._answer, self._accept, self._connections.discard, self._report,
            self._limits, self._faults,
        )  # fmt: skip

    def _accept(self, connection: Connection) -> bool:
        if not self._peers.allows(connection.peer):
            self._report(f"{connection.peer} is no allowed peer, and was turned away")
            return False
        if self._faults.cut:
            return False
        if len(self._connections) >= self._limits.clients:
            self._report(
                f"{self._limits.clients} clients are connected, {connection.peer} was turned away"
            )
            return False
        self._connections.add(connection)
        return True

    def _answer(self, unit: int, request: bytes) -> bytes:
        if self._units and unit not in self._units:
            return refused(request[0], ExceptionCode.GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND)
        return answer(request, self._registers)

    def _let_go(self, now: float) -> None:
        cut = self._faults.cut
        for connection in list(self._connections):
            idle = now - connection.heard > self._limits.idle
            if idle:
                self._report(
                    f"{connection.peer} has asked for nothing for {self._limits.idle:g} s, "
                    "and is let go"
                )
            if idle or cut:
                connection.end()

    def _report(self, words: str) -> None:
        self._reported += 1
        if self._reported <= _REPORTS:
            self._reporter.event(words)
        else:
            self._dropped += 1

    def _report_again(self) -> None:
        if self._dropped:
            self._reporter.event(f"{self._dropped} more such events in the last second")
        self._reported = self._dropped = 0
