"""A Modbus TCP master over a register map: tags by their names, in the units of their signals."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Iterable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from clepsydra.rig.bus import BusFault
from clepsydra.rig.doors.modbus.codes import exception_words
from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.register_map import RegisterMap
from clepsydra.rig.doors.modbus.spans import Span, spans
from clepsydra.rig.doors.modbus.table import Table

if TYPE_CHECKING:
    from pymodbus.client import AsyncModbusTcpClient
    from pymodbus.pdu import ModbusPDU

#: Most of one request (Modbus Application Protocol V1.1b3, section 6).
_READ_WORDS, _READ_BITS, _WRITTEN_WORDS, _WRITTEN_BITS = 125, 2000, 123, 1968


class ModbusMaster:
    """A master of one Modbus TCP server.

    Parameters
    ----------
    register_map : RegisterMap
        Of the server.
    host : str
    port : int
    unit : int
        The unit identifier; 255 for a device that is no gateway (MODBUS Messaging on TCP/IP
        Implementation Guide V1.0b, section 4.4.2.1.3).
    timeout : float
        A server that has not answered after so long is silent [s].

    Examples
    --------
    >>> import asyncio
    >>> import clepsydra as cl
    >>> from clepsydra.rig.doors.modbus.register_map import default_map
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> master = ModbusMaster(default_map(tags), "127.0.0.1", 9, timeout=1.0)
    >>> try:
    ...     asyncio.run(master.open())
    ... except BusFault as fault:
    ...     print(fault)
    Modbus TCP 127.0.0.1:9: nobody takes the connection
    """

    def __init__(
        self, register_map: RegisterMap, host: str, port: int, *, unit: int = 255,
        timeout: float = 1.0,
    ) -> None:  # fmt: skip
        self._map, self._host, self._port = register_map, host, port
        self._unit, self._timeout = unit, timeout
        self._client: AsyncModbusTcpClient | None = None
        self._ended: asyncio.Future[None]

    @property
    def _bus(self) -> str:
        return f"Modbus TCP {self._host}:{self._port}"

    async def open(self) -> None:
        """Connect.

        Raises
        ------
        BusFault
            Nobody is there.
        """
        await self._connected()

    async def close(self) -> None:
        """Leave."""
        if self._client is not None:
            self._client.close()
            self._client = None

    async def read(self, names: Iterable[str]) -> dict[str, float]:
        """Return the values of tags, in the units of their signals.

        A tag that stands in several places is read at the first. A card that has no value, as
        with a broken wire, gives not-a-number.

        Raises
        ------
        BusFault
            The server is silent or answers an exception; or the map has no such tag.
        """
        wanted = [self._entry(name, self._map.by_tag) for name in names]
        found: dict[str, float] = {}
        for span in spans(dict.fromkeys(wanted), _READ_WORDS, _READ_BITS):
            answer = await self._asked(span, "read")
            words = list(answer.bits if span.table.holds_bits else answer.registers)
            if len(words) < span.count:
                raise self._fault(span, f"{len(words)} of {span.count} were answered", True)
            for entry in span.entries:
                first = entry.address - span.address
                its = words[first : first + entry.size]
                found[entry.tag.name] = entry.encoding.decode(its, entry.tag)
        return {entry.tag.name: found[entry.tag.name] for entry in wanted}

    async def write(self, values: Mapping[str, float]) -> None:
        """Give tags values, in the units of their signals.

        What stands side by side is one request, which a server takes as a whole or not at all.

        Raises
        ------
        BusFault
            The server is silent or answers an exception; or the map has no such tag where a
            master can write.
        """
        wanted = [self._entry(name, self._map.written) for name in values]
        for span in spans(wanted, _WRITTEN_WORDS, _WRITTEN_BITS):
            words = [
                word
                for entry in span.entries
                for word in entry.encoding.encode(values[entry.tag.name], entry.tag)
            ]
            await self._asked(span, "write", words)

    def _entry(self, name: str, known: Mapping[str, Entry]) -> Entry:
        entry = known.get(name)
        if entry is None:
            raise BusFault(self._bus, name, "the register map has no place for it", answered=True)
        return entry

    async def _asked(self, span: Span, verb: str, words: list[int] | None = None) -> ModbusPDU:
        """Return the answer to the request of a span."""
        from pymodbus.exceptions import ModbusException

        client = await self._connected()
        try:
            answer = await self._answer(self._request(client, span, words))
        except ConnectionResetError:
            await self.close()
            told = f"the connection was closed on {verb} of {span.words}"
            raise self._fault(span, told, False) from None
        except (ModbusException, OSError):
            await self.close()
            told = f"{verb} of {span.words} was not answered within {self._timeout:g} s"
            raise self._fault(span, told, False) from None
        if answer.isError():
            told = (
                f"{verb} of {span.words} was answered by {exception_words(answer.exception_code)}"
            )
            raise self._fault(span, told, True)
        return answer

    async def _answer(self, request: Awaitable[ModbusPDU]) -> ModbusPDU:
        """Return an answer; the end of the connection is one at once.

        A request of pymodbus 3.16.1 waits for its time-out though the connection has ended
        (`findings/pymodbus_client_waits_for_a_closed_connection.sh`).
        """
        asked = asyncio.ensure_future(request)
        try:
            both: set[asyncio.Future[Any]] = {asked, self._ended}
            await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
            if not asked.done():
                raise ConnectionResetError
            return asked.result()
        finally:
            asked.cancel()

    def _request(
        self, client: AsyncModbusTcpClient, span: Span, words: list[int] | None
    ) -> Awaitable[ModbusPDU]:
        if words is not None:
            if span.table.holds_bits:
                bits = [bool(word) for word in words]
                return client.write_coils(span.address, bits, device_id=self._unit)
            return client.write_registers(span.address, words, device_id=self._unit)
        reads: dict[Table, Callable[..., Any]] = {
            Table.COILS: client.read_coils,
            Table.DISCRETE_INPUTS: client.read_discrete_inputs,
            Table.INPUT_REGISTERS: client.read_input_registers,
            Table.HOLDING_REGISTERS: client.read_holding_registers,
        }
        return reads[span.table](span.address, count=span.count, device_id=self._unit)

    async def _connected(self) -> AsyncModbusTcpClient:
        """Return the connection, made anew where there is none."""
        if self._client is not None and self._client.connected:
            return self._client
        from pymodbus.client import AsyncModbusTcpClient

        # What it logs is told by faults, in better words.
        logging.getLogger("pymodbus").addHandler(logging.NullHandler())
        await self.close()
        # It neither tries again nor connects again by itself: who has to meet a deadline decides.
        client = AsyncModbusTcpClient(
            self._host, port=self._port, timeout=self._timeout, retries=0, reconnect_delay=0.0,
            trace_connect=partial(_heard, ended := asyncio.get_running_loop().create_future()),
        )  # fmt: skip
        is_there = await client.connect()
        _end_where_cancelled()
        if not is_there:
            client.close()
            raise BusFault(self._bus, "", "nobody takes the connection", answered=False)
        self._client, self._ended = client, ended
        return client

    def _fault(self, span: Span, words: str, answered: bool) -> BusFault:
        names = [entry.tag.name for entry in span.entries]
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        return BusFault(self._bus, names[0] + more, words, answered=answered)


def _heard(ended: asyncio.Future[None], is_there: bool) -> None:
    """Take note of the end of a connection."""
    if not is_there and not ended.done():
        ended.set_result(None)


def _end_where_cancelled() -> None:
    """Raise a cancellation that was lost on the way.

    Before Python 3.12 `asyncio.wait_for`, in which pymodbus connects, takes one for nothing where
    the connection is made in the same turn (python/cpython#86296).
    """
    task = asyncio.current_task()
    if task is not None and task.cancelling():
        raise asyncio.CancelledError
