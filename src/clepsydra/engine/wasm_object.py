"""The binary format of WebAssembly, as far as one object that is complete becomes a module."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

#: Kinds of imports and exports.
_FUNCTION, IMPORTED_MEMORY, _VARIABLE = 0, 2, 3
#: Kinds of sections.
_CUSTOM, _TYPES, _IMPORTS, _FUNCTIONS, _VARIABLES, _EXPORTS, _CODE, _DATA, _DATA_COUNT = (
    0, 1, 2, 3, 6, 7, 10, 11, 12,
)  # fmt: skip
#: In the order in which a module has them.
_ORDER = (_TYPES, _IMPORTS, _FUNCTIONS, _VARIABLES, _EXPORTS, _DATA_COUNT, _CODE, _DATA)
_HEADER = b"\0asm\x01\0\0\0"
_I32, _I32_CONSTANT, _END = 0x7F, 0x41, 0x0B
#: In the custom section "linking": the part with the symbols, and in that a function's flag of
#: one that is defined elsewhere.
_LINKING, _SYMBOLS, _UNDEFINED, _EXPLICIT_NAME = "linking", 8, 0x10, 0x40
_OF_DATA, _OF_SECTION = 1, 3


class _Bytes:
    """Bytes that are read from the front."""

    def __init__(self, content: bytes) -> None:
        self.content, self.place = content, 0

    @property
    def left(self) -> bool:
        return self.place < len(self.content)

    def byte(self) -> int:
        self.place += 1
        return self.content[self.place - 1]

    def number(self) -> int:
        """Return a whole number from 0 on (LEB128)."""
        found = shift = 0
        while True:
            byte = self.byte()
            found |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return found

    def take(self, count: int) -> bytes:
        self.place += count
        return self.content[self.place - count : self.place]

    def text(self) -> str:
        return self.take(self.number()).decode()


class WasmObject:
    """A relocatable object, as LLVM writes it.

    Source: WebAssembly tool conventions, Linking.md, version 2 of the section "linking".

    Parameters
    ----------
    image : bytes
    """

    def __init__(self, image: bytes) -> None:
        self.sections: dict[int, bytes] = {}
        self._linking = b""
        rest = _Bytes(image[len(_HEADER) :])
        while rest.left:
            kind = rest.byte()
            body = rest.take(rest.number())
            if kind != _CUSTOM:
                self.sections[kind] = body
            elif (custom := _Bytes(body)).text() == _LINKING:
                self._linking = body[custom.place :]

    @cached_property
    def imports(self) -> list[tuple[int, str]]:
        """What it takes from elsewhere: kind and name."""
        body, found = _Bytes(self.sections[_IMPORTS]), []
        for _ in range(body.number()):
            body.text()
            name, kind = body.text(), body.byte()
            if kind == _FUNCTION:
                body.number()
            elif kind == IMPORTED_MEMORY:
                body.take(body.number() + 1)
            else:  # a variable: its type, and whether it changes
                body.take(2)
            found.append((kind, name))
        return found

    @cached_property
    def end_of_data(self) -> int:
        """The first address behind its constants and variables."""
        body, end = _Bytes(self.sections.get(_DATA, b"\0")), 0
        for _ in range(body.number()):
            body.take(2)  # an active segment, at a constant of 32 bits
            start = body.number()
            body.byte()
            size = body.number()
            body.take(size)
            end = max(end, start + size)
        return end

    def function(self, name: str) -> int:
        """Return the index of a function that it defines."""
        return dict(self._functions())[name]

    def _functions(self) -> Iterator[tuple[str, int]]:
        rest = _Bytes(self._linking)
        rest.number()  # the version
        while rest.byte() != _SYMBOLS:
            rest.take(rest.number())
        rest.number()  # the size
        for _ in range(rest.number()):
            kind, flags = rest.byte(), rest.number()
            if kind == _OF_DATA:
                rest.text()
                if not flags & _UNDEFINED:
                    rest.number(), rest.number(), rest.number()
                continue
            index = rest.number()
            named = kind != _OF_SECTION and (not flags & _UNDEFINED or flags & _EXPLICIT_NAME)
            name = rest.text() if named else ""
            if kind == _FUNCTION and named:
                yield name, index


def module(
    whole: WasmObject, name: str, *, memory: tuple[str, str], pages: int, constant: tuple[str, int]
) -> bytes:
    """Return a module that imports its memory alone, and exports a function and a constant.

    Parameters
    ----------
    whole : WasmObject
        One that defines everything that it uses but its memory.
    name : str
        Of the function.
    memory : tuple of str
        The names by which the memory is imported.
    pages : int
        Of memory, at least.
    constant : tuple of (str, int)
        Name and value, from 0 on.
    """
    sections = dict(whole.sections)
    imported = _text(memory[0]) + _text(memory[1]) + bytes((IMPORTED_MEMORY, 0)) + _number(pages)
    sections[_IMPORTS] = _vector(imported)
    called, value = constant
    sections[_VARIABLES] = _vector(
        bytes((_I32, 0, _I32_CONSTANT)) + _signed(value) + bytes((_END,))
    )
    function = _text(name) + bytes((_FUNCTION,)) + _number(whole.function(name))
    sections[_EXPORTS] = _vector(function, _text(called) + bytes((_VARIABLE, 0)))
    found = [
        bytes((kind,)) + _number(len(sections[kind])) + sections[kind]
        for kind in _ORDER
        if kind in sections
    ]
    return _HEADER + b"".join(found)


def _number(value: int) -> bytes:
    found = bytearray()
    while value > 0x7F:
        found.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes((*found, value))


def _signed(value: int) -> bytes:
    """Return a number from 0 on where a sign is read: its last byte has a bit to spare."""
    found = _number(value)
    return found if found[-1] < 0x40 else bytes((*found[:-1], found[-1] | 0x80, 0))


def _text(name: str) -> bytes:
    return _number(len(name)) + name.encode()


def _vector(*entries: bytes) -> bytes:
    return _number(len(entries)) + b"".join(entries)
