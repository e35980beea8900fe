"""The functions of a Modbus server: from a request to its answer, as bytes without their header."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence

from clepsydra.rig.doors.modbus.codes import ExceptionCode, ModbusRefusal
from clepsydra.rig.doors.modbus.registers import Registers
from clepsydra.rig.doors.modbus.table import Table

#: Most that one request reads or writes (Modbus Application Protocol V1.1b3, section 6).
_READ_BITS, _READ_WORDS, _WRITTEN_BITS, _WRITTEN_WORDS, _WRITTEN_BESIDE_READ = (
    2000, 125, 1968, 123, 121,
)  # fmt: skip
_ON, _OFF, _FAILED = 0xFF00, 0x0000, 0x80

_Function = Callable[[bytes, Registers], bytes]


def answer(request: bytes, registers: Registers) -> bytes:
    """Return the answer to a request, both with their function code first.

    Parameters
    ----------
    request : bytes
        At least the function code.
    registers : Registers

    Returns
    -------
    bytes
        Where it is refused, the function code with its highest bit set, and the exception code.
    """
    code = request[0]
    try:
        function = _FUNCTIONS.get(code)
        if function is None:
            raise ModbusRefusal(ExceptionCode.ILLEGAL_FUNCTION)
        return bytes([code]) + function(request[1:], registers)
    except ModbusRefusal as refusal:
        return refused(code, refusal.code)


def refused(code: int, why: ExceptionCode) -> bytes:
    """Return the answer to a request that is refused.

    >>> refused(3, ExceptionCode.ILLEGAL_DATA_ADDRESS).hex()
    '8302'
    """
    return bytes([code | _FAILED, why])


def _fields(form: str, data: bytes) -> tuple[int, ...]:
    """Return the fields of a request that has exactly them."""
    if struct.calcsize(form) != len(data):
        raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_VALUE)
    return struct.unpack(form, data)


def _check_count(count: int, most: int) -> None:
    if not 1 <= count <= most:
        raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_VALUE)


def _counted(data: bytes, size: int) -> bytes:
    """Return what follows a count of bytes, which has to be so many."""
    if not data or data[0] != size or len(data) != 1 + size:
        raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_VALUE)
    return data[1:]


def _packed(words: Sequence[int]) -> bytes:
    return bytes([2 * len(words)]) + struct.pack(f">{len(words)}H", *words)


def _read_bits(table: Table) -> _Function:
    def function(data: bytes, registers: Registers) -> bytes:
        address, count = _fields(">HH", data)
        _check_count(count, _READ_BITS)
        bits = registers.read(table, address, count)
        size = (count + 7) // 8
        number = sum(bit << place for place, bit in enumerate(bits))
        return bytes([size]) + number.to_bytes(size, "little")

    return function


def _read_words(table: Table) -> _Function:
    def function(data: bytes, registers: Registers) -> bytes:
        address, count = _fields(">HH", data)
        _check_count(count, _READ_WORDS)
        return _packed(registers.read(table, address, count))

    return function


def _write_bit(data: bytes, registers: Registers) -> bytes:
    address, value = _fields(">HH", data)
    if value not in (_ON, _OFF):
        raise ModbusRefusal(ExceptionCode.ILLEGAL_DATA_VALUE)
    registers.write(Table.COILS, address, [int(value == _ON)])
    return data


def _write_word(data: bytes, registers: Registers) -> bytes:
    address, word = _fields(">HH", data)
    registers.write(Table.HOLDING_REGISTERS, address, [word])
    return data


def _write_bits(data: bytes, registers: Registers) -> bytes:
    address, count = _fields(">HH", data[:4])
    _check_count(count, _WRITTEN_BITS)
    number = int.from_bytes(_counted(data[4:], (count + 7) // 8), "little")
    registers.write(Table.COILS, address, [number >> place & 1 for place in range(count)])
    return data[:4]


def _write_words(data: bytes, registers: Registers) -> bytes:
    address, count = _fields(">HH", data[:4])
    _check_count(count, _WRITTEN_WORDS)
    words = struct.unpack(f">{count}H", _counted(data[4:], 2 * count))
    registers.write(Table.HOLDING_REGISTERS, address, words)
    return data[:4]


def _mask_word(data: bytes, registers: Registers) -> bytes:
    address, kept, set_to = _fields(">HHH", data)
    (word,) = registers.read(Table.HOLDING_REGISTERS, address, 1)
    # Result = (Current Contents AND And_Mask) OR (Or_Mask AND (NOT And_Mask)): section 6.16.
    registers.write(Table.HOLDING_REGISTERS, address, [word & kept | set_to & ~kept & 0xFFFF])
    return data


def _read_and_write_words(data: bytes, registers: Registers) -> bytes:
    read_from, read, write_to, written = _fields(">HHHH", data[:8])
    _check_count(read, _READ_WORDS)
    _check_count(written, _WRITTEN_BESIDE_READ)
    words = struct.unpack(f">{written}H", _counted(data[8:], 2 * written))
    # It writes first; nothing is written where it could not read afterwards: section 6.17.
    registers.check_addresses(Table.HOLDING_REGISTERS, read_from, read)
    registers.write(Table.HOLDING_REGISTERS, write_to, words)
    return _packed(registers.read(Table.HOLDING_REGISTERS, read_from, read))


_FUNCTIONS: dict[int, _Function] = {
    1: _read_bits(Table.COILS),
    2: _read_bits(Table.DISCRETE_INPUTS),
    3: _read_words(Table.HOLDING_REGISTERS),
    4: _read_words(Table.INPUT_REGISTERS),
    5: _write_bit,
    6: _write_word,
    15: _write_bits,
    16: _write_words,
    22: _mask_word,
    23: _read_and_write_words,
}
