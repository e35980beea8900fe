"""Structured Text of Siemens (SCL) as the standard writes it, so that one grammar reads both."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from clepsydra.deploy.proof.text.tree import StructuredTextError
from clepsydra.deploy.proof.text.values import ZEROS

_TOKENS = re.compile(
    r"""
    (?P<comment>//[^\n]*|\(\*.*?\*\))
    |(?P<attribute>\{[^}\n]*\})
    |(?P<quoted>"[A-Za-z_]\w*")
    |(?P<literal>[A-Za-z_]\w*\#[+-]?\d[\w.]*([+-]\d+)?|\d[\d_]*(\.\d+)?([Ee][+-]?\d+)?)
    |(?P<marked>\#[A-Za-z_]\w*)
    |(?P<word>[A-Za-z_]\w*)
    |(?P<space>\s+)
    |(?P<assigned>:=|=>)
    |(?P<sign>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_SECTIONS = ("VAR", "VAR_INPUT", "VAR_OUTPUT", "VAR_TEMP")
#: Words that a declaration may have behind its colon; a block stands there in quotes.
_TYPES = {*ZEROS, "ARRAY", "OF", "TRUE", "FALSE"}


@dataclass
class _Token:
    kind: str
    text: str
    line: int


def standard_text(text: str) -> str:
    """Return a text in SCL without what the standard does not know; lines keep their numbers.

    Attributes, version and BEGIN go, and so do the quotes around the names of blocks and the
    marks before variables, after each was found where the system wants it. Comments stay as
    they are.

    Raises
    ------
    StructuredTextError
        The name of a block is not in quotes; BEGIN does not stand once between declarations and
        statements of a block; a variable of the block stands in a statement without its mark,
        or a mark stands before something else.

    Examples
    --------
    >>> print(standard_text('''FUNCTION_BLOCK "law"
    ... VERSION : 0.1
    ... VAR_INPUT u : LREAL; END_VAR
    ... VAR_OUTPUT y : LREAL; END_VAR
    ... BEGIN
    ... #y := LREAL#0.5 * #u; // "half" of #u
    ... END_FUNCTION_BLOCK'''))
    FUNCTION_BLOCK law
    <BLANKLINE>
    VAR_INPUT u : LREAL; END_VAR
    VAR_OUTPUT y : LREAL; END_VAR
    <BLANKLINE>
    y := LREAL#0.5 * u; // "half" of #u
    END_FUNCTION_BLOCK
    """
    tokens = list(_tokens(text))
    told = [token for token in tokens if token.kind not in ("comment", "space")]
    place = 0
    while place < len(told):
        place = _Block(told).read(place)
    return "".join(token.text for token in tokens)


def _tokens(text: str) -> Iterator[_Token]:
    line = 1
    for found in _TOKENS.finditer(text):
        yield _Token(found.lastgroup or "", found[0], line)
        line += found[0].count("\n")


def _wrong(token: _Token, message: str) -> StructuredTextError:
    return StructuredTextError(f"line {token.line}: {message}")


@dataclass
class _Block:
    """Reads one block, and writes what the standard knows into its tokens."""

    tokens: list[_Token]
    local: set[str] = field(default_factory=set)
    kind: str = ""

    def read(self, place: int) -> int:
        """Read a block from its first word; returns the place behind its last one."""
        first = self._at(place)
        self.kind = first.text.upper()
        if self.kind not in ("FUNCTION_BLOCK", "FUNCTION", "TYPE"):
            raise _wrong(first, f"{first.text} outside of a block")
        name = self._at(place + 1)
        if name.kind != "quoted":
            raise _wrong(name, f"the name {name.text} of a block is not in quotes")
        name.text = name.text.strip('"')
        place += 2
        if self.kind == "TYPE":
            name.text += " :"
            return self._members(place)
        if self.kind == "FUNCTION":
            self.local.add(name.text.lower())
            place += 2  # a colon and its type
        place = self._header(place)
        while self._at(place).text.upper() in _SECTIONS:
            place = self._section(place + 1)
        begin = self._at(place)
        if begin.text.upper() != "BEGIN":
            raise _wrong(begin, f"{begin.text} where BEGIN has to stand")
        begin.text = ""
        return self._statements(place + 1)

    def _at(self, place: int) -> _Token:
        if place < 0 or place >= len(self.tokens):
            raise _wrong(self.tokens[-1], "the text ends within a block")
        return self.tokens[place]

    def _header(self, place: int) -> int:
        """Read attributes and at most one version."""
        while self._at(place).kind == "attribute":
            self._at(place).text = ""
            place += 1
        if self._at(place).text.upper() == "VERSION":
            colon, number = self._at(place + 1), self._at(place + 2)
            if colon.text != ":" or number.kind != "literal":
                raise _wrong(colon, "a version is a number behind a colon")
            for token in self.tokens[place : place + 3]:
                token.text = ""
            place += 3
        return place

    def _section(self, place: int) -> int:
        """Read declarations up to END_VAR, behind the word of their section."""
        while self._at(place).text.upper() in ("RETAIN", "CONSTANT"):
            place += 1
        named = True
        while (token := self._at(place)).text.upper() != "END_VAR":
            if token.kind == "marked":
                raise _wrong(token, f"a mark in a declaration, before {token.text[1:]}")
            if named and token.kind == "word":
                self.local.add(token.text.lower())
            elif token.kind == "word" and token.text.upper() not in _TYPES:
                raise _wrong(token, f"{token.text} is no type, and no block in quotes")
            elif token.kind == "quoted":
                token.text = token.text.strip('"')
            named = token.text == ";" or (named and token.text != ":")
            place += 1
        return place + 1

    def _members(self, place: int) -> int:
        """Read the members of a structure up to the end of its type."""
        while (token := self._at(place)).text.upper() != "END_TYPE":
            if token.kind in ("marked", "quoted", "attribute"):
                raise _wrong(token, f"no meaning for {token.text} in a structure")
            place += 1
        return place + 1

    def _statements(self, place: int) -> int:
        """Read statements up to the end of the block."""
        calls: list[bool] = []  # whether an open parenthesis is that of a call
        while (token := self._at(place)).text.upper() != f"END_{self.kind}":
            before = self._at(place - 1)
            if token.text == "(":
                calls.append(before.kind in ("marked", "word", "quoted"))
            elif token.text == ")" and calls:
                calls.pop()
            elif token.text.upper() == "BEGIN":
                raise _wrong(token, "a second BEGIN")
            elif token.kind == "quoted" and self._at(place + 1).text == "(":
                token.text = token.text.strip('"')
            elif token.kind in ("quoted", "attribute") or token.text in ("#", '"'):
                raise _wrong(token, f"no meaning for {token.text} in a statement")
            elif token.kind in ("marked", "word"):
                foreign = before.text == "." or (
                    bool(calls) and calls[-1] and self._at(place + 1).kind == "assigned"
                )
                self._name(token, foreign=foreign)
            place += 1
        return place + 1

    def _name(self, token: _Token, *, foreign: bool) -> None:
        """Check the mark of a name; that of another block's variable has none."""
        marked = token.kind == "marked"
        name = token.text.removeprefix("#")
        local = name.lower() in self.local and not foreign
        if marked and not local:
            raise _wrong(token, f"a mark before {name}, which is no variable of the block")
        if local and not marked:
            raise _wrong(token, f"no mark before {name}, a variable of the block")
        token.text = name
