"""Entries of a register map bundled into requests: neighbours in one, as many as one may have."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.table import Table


@dataclass(frozen=True)
class Span:
    """Neighbours in a table, for one request.

    Parameters
    ----------
    entries : tuple of Entry
        In the order of address, without a gap.
    """

    entries: tuple[Entry, ...]

    @property
    def table(self) -> Table:
        """In which they stand."""
        return self.entries[0].table

    @property
    def address(self) -> int:
        """The first."""
        return self.entries[0].address

    @property
    def count(self) -> int:
        """How many addresses they take."""
        return self.entries[-1].addresses.stop - self.address

    @property
    def words(self) -> str:
        """Where they stand, for messages.

        >>> from clepsydra.base.signal import Signal
        >>> from clepsydra.rig.doors.modbus.encoding import Encoding
        >>> from clepsydra.rig.tag import Tag, Writer
        >>> level = Tag("level.pv", "LI101", Signal("level", "m"), Writer.PLANT, "level", "m")
        >>> Span((Entry(level, Table.INPUT_REGISTERS, 0, Encoding.FLOAT32),)).words
        'input registers 0 and 1 (30001)'
        """
        name, last = self.table.value, self.address + self.count - 1
        reference = self.table.reference(self.address)
        if self.count == 1:
            return f"{name} {last} ({reference})"
        joint = "and" if self.count == 2 else "to"
        return f"{name}s {self.address} {joint} {last} ({reference})"


def spans(entries: Iterable[Entry], most_words: int, most_bits: int) -> list[Span]:
    """Return entries as few spans, none with more than one request may have.

    Only what was asked for is touched: a gap may be what no master can read.

    Parameters
    ----------
    entries : iterable of Entry
    most_words, most_bits : int
        Of one request.
    """
    found: list[list[Entry]] = []
    for entry in sorted(entries, key=lambda entry: (entry.table.value, entry.address)):
        most = most_bits if entry.table.holds_bits else most_words
        last = found[-1] if found else []
        if (
            last
            and last[0].table is entry.table
            and last[-1].addresses.stop == entry.address
            and entry.addresses.stop - last[0].address <= most
        ):
            last.append(entry)
        else:
            found.append([entry])
    return [Span(tuple(each)) for each in found]
