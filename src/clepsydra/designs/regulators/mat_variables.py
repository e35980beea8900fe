"""The variables of a MAT file of version 4 to 7, of which only small matrices of numbers are read.

A reader of its own, since a file may come from anywhere: SciPy's, in compiled code, has been seen
to crash on damaged ones. Objects, functions, structures and cells are told by their class alone.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

#: The longest name of Matlab has 63 characters, and the smallest element 8 bytes.
_MOST_VARIABLES = 1000
_LONGEST_NAME = 63
#: So much of a compressed variable is looked at: a hundred by a hundred doubles and its name.
_LOOKED_AT = 100_000
_CLASSES = {
    1: "cell", 2: "struct", 3: "object", 4: "char", 5: "sparse", 6: "double", 7: "single",
    8: "int8", 9: "uint8", 10: "int16", 11: "uint16", 12: "int32", 13: "uint32", 14: "int64",
    15: "uint64", 16: "function", 17: "object",
}  # fmt: skip
#: How numbers are stored, which may be smaller than their class.
_STORED = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip
_FIRST_NUMBERS, _LAST_NUMBERS = 6, 15
_MATRIX, _COMPRESSED = 14, 15
_STORED_BEFORE = ("f8", "f4", "i4", "i2", "u2", "u1")
_COMPLEX = 0x800
_HEADER = 128


@dataclass(frozen=True, eq=False)
class Variable:
    """A variable of a MAT file.

    Parameters
    ----------
    kind : str
        Its class: "double", "struct".
    numbers : ndarray, optional
        None of what is no small matrix of numbers.
    """

    kind: str
    shape: tuple[int, ...]
    numbers: np.ndarray | None = None


def mat_variables(content: bytes, most: int) -> dict[str, Variable]:
    """Return the variables of a MAT file by name.

    Parameters
    ----------
    most : int
        Rows and columns of the largest matrix whose numbers are read.

    Raises
    ------
    ValueError
        It is no MAT file of these versions, or damaged.

    References
    ----------
    MAT-File Format, The MathWorks, versions 4 and 5, which 6 and 7 write too.

    Examples
    --------
    >>> from io import BytesIO
    >>> from scipy.io import savemat
    >>> file = BytesIO()
    >>> savemat(file, {"A": [[1.5, 2.0]]}, do_compression=True)
    >>> mat_variables(file.getvalue(), 60)["A"].numbers.tolist()
    [[1.5, 2.0]]
    """
    found = {}
    try:
        order = {b"IM": "<", b"MI": ">"}.get(content[_HEADER - 2 : _HEADER])
        variables = (
            _old_variables(content, most)
            if 0 in content[:4]
            else _variables(content, order or "", most)
        )
        for name, variable in variables:
            found[name] = variable
            if len(found) > _MOST_VARIABLES:
                break
    except (struct.error, zlib.error, UnicodeDecodeError) as error:
        raise ValueError(str(error)) from None
    return found


def _variables(content: bytes, order: str, most: int) -> Iterator[tuple[str, Variable]]:
    """Yield the variables of version 5, 6 or 7."""
    if not order or struct.unpack_from(f"{order}H", content, _HEADER - 4) != (0x100,):
        raise ValueError("no header of a MAT file")
    place = _HEADER
    while place < len(content):
        kind, size = struct.unpack_from(f"{order}II", content, place)
        data = content[place + 8 : place + 8 + size]
        if len(data) < size:
            raise ValueError("the file ends inside a variable")
        place += 8 + size
        if kind == _COMPRESSED:
            data = zlib.decompressobj().decompress(data, _LOOKED_AT)
            kind, size = struct.unpack_from(f"{order}II", data)
            data = data[8 : 8 + size]
        if kind == _MATRIX:
            yield _matrix(data, order, most)


def _matrix(data: bytes, order: str, most: int) -> tuple[str, Variable]:
    _, flags, place = _element(data, order, 0)
    (flag,) = struct.unpack_from(f"{order}I", flags)
    kind = _CLASSES.get(flag & 0xFF, "unknown")
    if kind == "object" and flag & 0xFF == 17:  # it has its name in the place of its size
        _, name, _ = _element(data, order, place)
        return name.decode("ascii"), Variable(kind, ())
    _, sizes, place = _element(data, order, place)
    shape = struct.unpack(f"{order}{len(sizes) // 4}i", sizes)
    _, name, place = _element(data, order, place)
    is_numbers = _FIRST_NUMBERS <= flag & 0xFF <= _LAST_NUMBERS
    if not is_numbers or len(shape) != 2 or not all(0 <= size <= most for size in shape):
        return name.decode("ascii"), Variable(kind, shape)
    numbers, place = _numbers(data, order, place, shape)
    if flag & _COMPLEX:
        imaginary, _ = _numbers(data, order, place, shape)
        numbers = numbers + 1j * imaginary
    return name.decode("ascii"), Variable(kind, shape, numbers)


def _element(data: bytes, order: str, place: int) -> tuple[int, bytes, int]:
    """Return the type and content of an element, and where the next one is."""
    kind, size = struct.unpack_from(f"{order}II", data, place)
    start, end = place + 8, place + 8 + size + -size % 8
    if kind >> 16:  # up to four bytes stand beside the tag
        kind, size = kind & 0xFFFF, kind >> 16
        start, end = place + 4, place + 8
        if size > 4:
            raise ValueError("an element that is larger than its place")
    found = data[start : start + size]
    if len(found) < size:
        raise ValueError("the file ends inside an element")
    return kind, found, end


def _numbers(data: bytes, order: str, place: int, shape: tuple[int, ...]) -> tuple[np.ndarray, int]:
    kind, stored, end = _element(data, order, place)
    if kind not in _STORED:
        raise ValueError("numbers that are stored in no known way")
    return _columns(stored, order + _STORED[kind], shape), end


def _columns(stored: bytes, kind: str, shape: tuple[int, ...]) -> np.ndarray:
    """Return a matrix from its numbers, column by column."""
    count = math.prod(shape)
    if len(stored) != count * np.dtype(kind).itemsize:
        raise ValueError("as many numbers as the matrix does not have")
    return np.frombuffer(stored, kind).astype(float).reshape(shape, order="F")


def _old_variables(content: bytes, most: int) -> Iterator[tuple[str, Variable]]:
    """Yield the variables of version 4."""
    place = 0
    while place < len(content):
        order = "<" if struct.unpack_from("<I", content, place)[0] < 10_000 else ">"
        code, rows, columns, imaginary, length = struct.unpack_from(f"{order}5i", content, place)
        machine, stored, text = code // 1000, code // 10 % 10, code % 10
        if machine not in (0, 1) or code // 100 % 10 or stored >= len(_STORED_BEFORE):
            raise ValueError("no header of a variable of version 4")
        if min(rows, columns) < 0 or not 1 <= length <= _LONGEST_NAME + 1:
            raise ValueError("a variable of no size or name")
        place += 20
        name = content[place : place + length].rstrip(b"\0").decode("ascii")
        place += length
        kind = order + _STORED_BEFORE[stored]
        size = rows * columns * np.dtype(kind).itemsize
        parts = [content[place : place + size], content[place + size : place + 2 * size]]
        place += size * (2 if imaginary else 1)
        if place > len(content):
            raise ValueError("the file ends inside a variable")
        words = {0: "double", 1: "char", 2: "sparse"}.get(text, "unknown")
        if words != "double" or max(rows, columns) > most:
            yield name, Variable(words, (rows, columns))
            continue
        numbers = _columns(parts[0], kind, (rows, columns))
        if imaginary:
            numbers = numbers + 1j * _columns(parts[1], kind, (rows, columns))
        yield name, Variable(words, (rows, columns), numbers)
