"""One tag in a register map: in which table, at which address, as what."""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.words import with_minus
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.table import LARGEST_ADDRESS, Table
from clepsydra.rig.tag import Tag, Writer

_FLOATS = tuple(each for each in Encoding if each.is_float)
_WHOLE = (Encoding.UINT16, Encoding.UINT32, Encoding.UINT32_LOW_WORD_FIRST)
#: What a kind of signal is called, and what it can stand as.
_FITTING = {
    "real": (
        "a measured value",
        tuple(each for each in Encoding if each.is_of_values),
    ),
    "integer": ("a whole number", (*_WHOLE, *_FLOATS)),
    "boolean": ("a switch", (Encoding.BIT, Encoding.UINT16)),
}


@dataclass(frozen=True)
class Entry:
    """A tag in a register map.

    Parameters
    ----------
    tag : Tag
    table : Table
    address : int
        Of its first register, or of its bit, as requests have it, from 0.
    encoding : Encoding
    place : str
        Where it was written, for messages: "map.csv, line 3".

    Raises
    ------
    InputError
        The address is beyond the table, or the tag cannot stand there so.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> signal = Signal("level", "m", low=0.0, high=10.0)
    >>> level = Tag("level.pv", "LI101_pv", signal, Writer.PLANT, "level", "m")
    >>> Entry(level, Table.INPUT_REGISTERS, 6, Encoding.FLOAT32).reference
    '30007'
    >>> Entry(level, Table.COILS, 0, Encoding.BIT)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: register map, level.pv: got 'bit', expected no coil: \
level.pv is a measured value; let it stand in an input register or a holding register.
    """

    tag: Tag
    table: Table
    address: int
    encoding: Encoding
    place: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        last = LARGEST_ADDRESS - self.size + 1
        if not 0 <= self.address <= last:
            raise InputError(
                self.where, self.address, f"an address from 0 to {last}",
                "give the address of the request, counted from 0, without the digit of its table",
            )  # fmt: skip
        self._check_kind()
        self._check_range()

    def _check_kind(self) -> None:
        words, fitting = _FITTING[self.tag.signal.kind]
        able = [each for each in fitting if (each is Encoding.BIT) is self.table.holds_bits]
        if self.encoding in able:
            return
        if able:
            names = [each.value for each in able]
            expected = f"{words} in a {self.table.value} as {' or '.join(names)}"
            raise InputError(
                self.where, self.encoding.value, expected, f"give it the encoding {names[0]}"
            )
        raise InputError(
            self.where, self.encoding.value,
            f"no {self.table.value}: {self.tag.name} is {words}",
            "let it stand in an input register or a holding register",
        )  # fmt: skip

    def _check_range(self) -> None:
        signal = self.tag.signal
        if self.encoding.card is not None and not signal.has_range:
            raise InputError(
                self.where, Finding(f"{self.encoding.value} for a range without end"),
                "a range of which counts are a share", "give it the encoding float32",
            )  # fmt: skip
        largest = self.encoding.largest
        if self.encoding in _WHOLE and not 0 <= signal.low <= signal.high <= largest:
            ends = with_minus(f"{signal.low:g} to {signal.high:g}")
            other = "uint32" if signal.low >= 0 and signal.high < 2**32 else "float32"
            raise InputError(
                self.where, Finding(f"{self.encoding.value} for a range of {ends}"),
                f"a range within 0 to {largest}", f"give it the encoding {other}",
            )  # fmt: skip

    @property
    def where(self) -> str:
        """Where it was written, for messages."""
        return self.place or f"register map, {self.tag.name}"

    @property
    def size(self) -> int:
        """How many addresses it takes."""
        return self.encoding.size

    @property
    def addresses(self) -> range:
        """All that it takes."""
        return range(self.address, self.address + self.size)

    @property
    def reference(self) -> str:
        """How manuals write its address."""
        return self.table.reference(self.address)

    @property
    def taken(self) -> bool:
        """Whether a rig takes what a master writes there."""
        return self.table.writable and self.tag.writer is not Writer.PLANT
