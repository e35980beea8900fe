"""The four tables of a Modbus device."""

from __future__ import annotations

from enum import Enum

#: The largest address of a table.
LARGEST_ADDRESS = 0xFFFF
#: References have five digits up to here, and six beyond.
_LAST_OF_FIVE_DIGITS = 9998


class Table(Enum):
    """A table of a Modbus device, by what a map calls it.

    The tables are told apart by the function code alone: each begins at address 0, which is
    reference 1 (Modbus Application Protocol V1.1b3, section 4.4).
    """

    COILS = "coil"
    DISCRETE_INPUTS = "discrete input"
    INPUT_REGISTERS = "input register"
    HOLDING_REGISTERS = "holding register"

    @property
    def holds_bits(self) -> bool:
        """Whether one address is one bit; else 16."""
        return self in (Table.COILS, Table.DISCRETE_INPUTS)

    @property
    def writable(self) -> bool:
        """Whether a master can write it."""
        return self in (Table.COILS, Table.HOLDING_REGISTERS)

    def reference(self, address: int) -> str:
        """Return how manuals write an address: the digit of its table, and counted from 1.

        >>> Table.HOLDING_REGISTERS.reference(0), Table.INPUT_REGISTERS.reference(107)
        ('40001', '30108')
        >>> Table.HOLDING_REGISTERS.reference(9999), Table.COILS.reference(4)
        ('410000', '00005')
        """
        digits = 4 if address <= _LAST_OF_FIVE_DIGITS else 5
        return f"{_DIGITS[self]}{address + 1:0{digits}d}"


_DIGITS = {
    Table.COILS: 0,
    Table.DISCRETE_INPUTS: 1,
    Table.INPUT_REGISTERS: 3,
    Table.HOLDING_REGISTERS: 4,
}
