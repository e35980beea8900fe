"""A register map: where each tag of a rig stands in the tables of a Modbus device."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from clepsydra.base.errors import Finding, InputError
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.table import Table
from clepsydra.rig.tag import Tag, Writer

#: What is written by somebody else begins at a multiple of this, so that a new tag moves no other.
_ROUND = 100
#: Where the copies of the plant's tags begin, at least.
_COPIES = 1000


class Server(Enum):
    """Whose registers a map is of."""

    #: The rig's: the plant's tags are read by its masters, the others written.
    RIG = "rig"
    #: A PLC's: the rig is its master, writes the plant's tags and reads the controller's.
    PLC = "PLC"


@dataclass(frozen=True)
class RegisterMap:
    """Where tags stand in the tables of a Modbus device.

    Parameters
    ----------
    entries : tuple of Entry
        A tag may stand in several places.
    server : Server
        Whose registers they are.

    Raises
    ------
    InputError
        Two entries overlap, or one cannot be written by the one who has to.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> found = default_map(tags)
    >>> [(entry.reference, entry.tag.name, entry.encoding.value) for entry in found.entries][:2]
    [('30001', 'level_1.pv', 'float32'), ('30003', 'level_2.pv', 'float32')]
    """

    entries: tuple[Entry, ...]
    server: Server = Server.RIG

    def __post_init__(self) -> None:
        taken: dict[tuple[Table, int], Entry] = {}
        for entry in self.entries:
            self._check_direction(entry)
            for address in entry.addresses:
                other = taken.setdefault((entry.table, address), entry)
                if other is not entry:
                    raise InputError(
                        entry.where, Finding(f"{entry.table.value} {address} for {entry.tag.name}"),
                        f"what {other.tag.name} leaves free, which stands there"
                        + (f" ({other.place})" if other.place else ""),
                        f"give one of the two another address; {other.tag.name} takes "
                        f"{other.size} from {other.address} on",
                    )  # fmt: skip

    def _check_direction(self, entry: Entry) -> None:
        from_plant = entry.tag.writer is Writer.PLANT
        if entry.table.writable or from_plant is (self.server is Server.RIG):
            return
        writer = "the rig" if from_plant else f"the {entry.tag.writer.value}"
        raise InputError(
            entry.where, entry.table.value,
            f"a table that a master can write, since {writer} writes {entry.tag.name}",
            f"let it stand in a {(Table.COILS if entry.table.holds_bits else _HOLDING).value}",
        )  # fmt: skip

    @cached_property
    def by_address(self) -> dict[Table, dict[int, Entry]]:
        """The entry that takes an address, by table and address."""
        found: dict[Table, dict[int, Entry]] = {table: {} for table in Table}
        for entry in self.entries:
            found[entry.table].update(dict.fromkeys(entry.addresses, entry))
        return found

    @property
    def tags(self) -> list[Tag]:
        """The tags of its entries."""
        return [entry.tag for entry in self.entries]

    @cached_property
    def by_tag(self) -> dict[str, Entry]:
        """The first entry of each tag, by its name."""
        return {entry.tag.name: entry for entry in reversed(self.entries)}

    @cached_property
    def written(self) -> dict[str, Entry]:
        """The first entry at which a master writes a tag, by its name."""
        by_plant = self.server is Server.PLC
        return {
            entry.tag.name: entry
            for entry in reversed(self.entries)
            if entry.table.writable and (entry.tag.writer is Writer.PLANT) is by_plant
        }

    def rows(self) -> list[dict[str, str]]:
        """Return the map as a table of text, an entry a row, in the order of reference."""
        ordered = sorted(self.entries, key=lambda entry: (entry.table.value, entry.address))
        return [_row(entry) for entry in ordered]


_HOLDING, _INPUTS = Table.HOLDING_REGISTERS, Table.INPUT_REGISTERS
#: Of a map as a table of text; the first four say all that a file has to.
COLUMNS = (
    "tag", "table", "address", "encoding", "reference", "label", "unit", "low", "high",
    "written by", "description",
)  # fmt: skip


def _row(entry: Entry) -> dict[str, str]:
    signal = entry.tag.signal
    low, high = f"{signal.low:g}", f"{signal.high:g}"
    cells = (
        entry.tag.name, entry.table.value, str(entry.address), entry.encoding.value,
        entry.reference, entry.tag.label, "" if signal.unit == "1" else signal.unit, low, high,
        entry.tag.writer.value, signal.description,
    )  # fmt: skip
    return dict(zip(COLUMNS, cells, strict=True))


def default_map(tags: Iterable[Tag], encoding: Encoding = Encoding.FLOAT32) -> RegisterMap:
    """Return the map of a rig that nobody has asked for another one.

    The plant's values are input registers from 0 on, its switches discrete inputs; the
    controller's tags are holding registers from 0 on, the operator's from the next hundred on with
    his switches as words behind them; the switches of both are coils too. The plant's tags stand a
    second time in holding registers, from 1000 on in the same order, then its switches as words,
    for masters that read nothing else: many panels and recorders, and function blocks of PLCs in
    their first mode.

    Parameters
    ----------
    tags : iterable of Tag
    encoding : Encoding
        Of values with a range; one without is float32, in the same order of words.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> [(row["reference"], row["tag"]) for row in default_map(tags).rows()][:3]
    [('00001', 'operator.acknowledge'), ('00002', 'operator.remote'), ('10001', 'level_1.good')]
    """
    known = tuple(tags)
    (values, told), (commands, ordered), (settings, set_to) = (
        _apart(tag for tag in known if tag.writer is writer) for writer in Writer
    )
    lines = [
        _in_line(values, _INPUTS, 0, encoding),
        _in_line(told, Table.DISCRETE_INPUTS, 0, encoding),
        _in_line(commands, _HOLDING, 0, encoding),
    ]
    for names, least in (((*settings, *set_to), 0), ((*values, *told), _COPIES)):
        lines.append(_in_line(names, _HOLDING, max(least, _next_round(lines)), encoding))
    switches = (*ordered, *set_to)
    lines.append(_in_line(switches, Table.COILS, 0, encoding))
    return RegisterMap(tuple(entry for line in lines for entry in line))


def map_of_plc(tags: Iterable[Tag], encoding: Encoding = Encoding.FLOAT32) -> RegisterMap:
    """Return a map of a PLC's own registers, to begin with where its program is still open.

    All stands in holding registers, which every PLC has: what the controller tells from 0 on,
    what the rig writes from the next hundred on, switches as words. What an operator sets stays
    with the rig.
    """
    known = tuple(tags)
    told = [tag for tag in known if tag.writer is Writer.CONTROLLER]
    lines = [_in_line(told, _HOLDING, 0, encoding)]
    written = [tag for tag in known if tag.writer is Writer.PLANT]
    lines.append(_in_line(written, _HOLDING, _next_round(lines), encoding))
    return RegisterMap(tuple(entry for line in lines for entry in line), Server.PLC)


def _apart(tags: Iterable[Tag]) -> tuple[list[Tag], list[Tag]]:
    """Return what stands in registers, and what is a switch."""
    known = list(tags)
    return (
        [tag for tag in known if tag.signal.kind != "boolean"],
        [tag for tag in known if tag.signal.kind == "boolean"],
    )


def _next_round(lines: Sequence[Sequence[Entry]]) -> int:
    """Return the next round address behind all holding registers."""
    last = max(
        (entry.addresses[-1] for line in lines for entry in line if entry.table is _HOLDING),
        default=-1,
    )
    return (last // _ROUND + 1) * _ROUND


def _in_line(tags: Iterable[Tag], table: Table, address: int, encoding: Encoding) -> list[Entry]:
    """Return entries for tags, each right behind the one before."""
    entries: list[Entry] = []
    for tag in tags:
        entries.append(Entry(tag, table, address, _suited(tag, table, encoding)))
        address += entries[-1].size
    return entries


def _suited(tag: Tag, table: Table, encoding: Encoding) -> Encoding:
    """Return what a tag stands as, of which an encoding tells the counts and the order of words."""
    if table.holds_bits:
        return Encoding.BIT
    signal, low_first = tag.signal, encoding.low_word_first
    if signal.kind == "real":
        return encoding if encoding.is_float or signal.has_range else Encoding.FLOAT32
    if signal.high <= Encoding.UINT16.largest:
        return Encoding.UINT16
    return Encoding.UINT32_LOW_WORD_FIRST if low_first else Encoding.UINT32
