"""The registers of a rig as a server reads and writes them: tags, looked up by addresses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clepsydra.rig.doors.modbus.codes import ExceptionCode, ModbusRefusal
from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.register_map import RegisterMap
from clepsydra.rig.doors.modbus.table import Table
from clepsydra.rig.doors.snapshots import Snapshots
from clepsydra.rig.tag_table import Refused, TagTable


class Registers:
    """The tables of a register map over the tags of a rig.

    Parameters
    ----------
    register_map : RegisterMap
    table : TagTable
    read_only : bool
        Whether a master may not write at all.
    """

    def __init__(self, register_map: RegisterMap, table: TagTable, *, read_only: bool) -> None:
        self._table, self._read_only = table, read_only
        self._by_address = register_map.by_address
        self._snapshots = Snapshots(table)

    def read(self, table: Table, address: int, count: int) -> list[int]:
        """Return registers or bits, all of one sample of the plant.

        Raises
        ------
        ModbusRefusal
            Exception 2 where an address has nothing; 6 before the plant has told anything.
        """
        entries = list(self._entries(table, address, count))
        now = self._snapshots.take()
        if now.sample < 0:
            raise ModbusRefusal(ExceptionCode.SERVER_DEVICE_BUSY)
        words = [
            word
            for entry in entries
            for word in entry.encoding.encode(now.value(entry.tag), entry.tag)
        ]
        skipped = address - entries[0].address
        return words[skipped : skipped + count]

    def write(self, table: Table, address: int, words: Sequence[int]) -> None:
        """Take registers or bits, all or none.

        Half of a float32 is a "combination of reference number and transfer length" that is
        invalid, which is exception 2 (Modbus Application Protocol V1.1b3, section 7). A value
        outside of what a tag takes is exception 3, as drives and controllers answer it: by the
        letter of that section it is not meant for what an application expects, but no other
        code is nearer, and 4 would say that the device has failed.

        Raises
        ------
        ModbusRefusal
            Exception 1 where masters may not write at all; 2 where an address has nothing, is
            half of a value or is the plant's; 3 where a value is not taken.
        """
        for entry, value in self._checked(table, address, words):
            self._table.write(entry.tag, value)

    def _checked(
        self, table: Table, address: int, words: Sequence[int]
    ) -> list[tuple[Entry, float]]:
        """Return what is written where, once all of it may be."""
        if self._read_only:
            raise ModbusRefusal(ExceptionCode.ILLEGAL_FUNCTION)
        found = []
        for entry in self._entries(table, address, len(words)):
            first = entry.address - address
            its = words[max(first, 0) : first + entry.size]
            if not entry.taken or len(its) != entry.size:
                raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_ADDRESS)
            found.append((entry, entry.encoding.decode(its, entry.tag)))
        for entry, value in found:
            try:
                self._table.check(entry.tag, value)
            except Refused:
                raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_VALUE) from None
        return found

    def check_addresses(self, table: Table, address: int, count: int) -> None:
        """Refuse addresses that have nothing."""
        for _ in self._entries(table, address, count):
            pass

    def _entries(self, table: Table, address: int, count: int) -> Iterator[Entry]:
        """Yield what takes the addresses, each once."""
        by_address, end = self._by_address[table], address + count
        while address < end:
            entry = by_address.get(address)
            if entry is None:
                raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_ADDRESS)
            yield entry
            address = entry.addresses.stop
