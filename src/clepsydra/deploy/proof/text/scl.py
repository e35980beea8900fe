"""Structured Text of Siemens (SCL) as the standard writes it, so that one grammar reads both."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

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
    reader = _Reader(told)
    while reader.place < len(told):
        reader.read_block()
    return "".join(token.text for token in tokens)


def _tokens(text: str) -> Iterator[_Token]:
    line = 1
    for found in _TOKENS.finditer(text):
        yield _Token(found.lastgroup or "", found[0], line)
        line += found[0].count("\n")


def _wrong(token: _Token, message: str) -> StructuredTextError:
    return StructuredTextError(f"line {token.line}: {message}")


class _Reader:
    """Reads blocks, one after the other, and writes what the standard knows into the tokens."""

    def __init__(self, tokens: list[_Token]) -> None:
        self.tokens, self.place = tokens, 0
        self.local: set[str] = set()

    def _next(self) -> _Token:
        """Return the token that is read next."""
        if self.place >= len(self.tokens):
            raise _wrong(self.tokens[-1], "the text ends within a block")
        return self.tokens[self.place]

    def _take(self) -> _Token:
        token = self._next()
        self.place += 1
        return token

    def _next_is(self, *words: str) -> bool:
        return self._next().text.upper() in words

    def _until(self, word: str) -> Iterator[_Token]:
        """Take tokens up to a word, and that word."""
        while not self._next_is(word):
            yield self._take()
        self.place += 1

    def read_block(self) -> None:
        first = self._take()
        kind = first.text.upper()
        if kind not in ("FUNCTION_BLOCK", "FUNCTION", "TYPE"):
            raise _wrong(first, f"{first.text} outside of a block")
        name = self._take()
        if name.kind != "quoted":
            raise _wrong(name, f"the name {name.text} of a block is not in quotes")
        name.text = name.text.strip('"')
        self.local = {name.text.lower()} if kind == "FUNCTION" else set()
        if kind == "TYPE":
            name.text += " :"
            for token in self._until("END_TYPE"):
                if token.kind in ("marked", "quoted", "attribute"):
                    raise _wrong(token, f"no meaning for {token.text} in a structure")
            return
        if kind == "FUNCTION":
            self.place += 2  # a colon and its type
        self._header()
        while self._next_is(*_SECTIONS):
            self._section()
        begin = self._take()
        if begin.text.upper() != "BEGIN":
            raise _wrong(begin, f"{begin.text} where BEGIN has to stand")
        begin.text = ""
        self._statements(f"END_{kind}")

    def _header(self) -> None:
        """Read attributes and at most one version."""
        while self._next().kind == "attribute":
            self._take().text = ""
        if self._next_is("VERSION"):
            version, colon, number = (self._take() for _ in range(3))
            if colon.text != ":" or number.kind != "literal":
                raise _wrong(colon, "a version is a number behind a colon")
            version.text = colon.text = number.text = ""

    def _section(self) -> None:
        """Read declarations, from the word of their section to END_VAR."""
        self.place += 1
        while self._next_is("RETAIN", "CONSTANT"):
            self.place += 1
        named = True
        for token in self._until("END_VAR"):
            if token.kind == "marked":
                raise _wrong(token, f"a mark in a declaration, before {token.text[1:]}")
            if named and token.kind == "word":
                self.local.add(token.text.lower())
            elif token.kind == "word" and token.text.upper() not in _TYPES:
                raise _wrong(token, f"{token.text} is no type, and no block in quotes")
            elif token.kind == "quoted":
                token.text = token.text.strip('"')
            named = token.text == ";" or (named and token.text != ":")

    def _statements(self, end: str) -> None:
        calls: list[bool] = []  # whether an open parenthesis is that of a call
        for token in self._until(end):
            before = self.tokens[self.place - 2]
            if token.text == "(":
                calls.append(before.kind in ("marked", "word", "quoted"))
            elif token.text == ")" and calls:
                calls.pop()
            elif token.text.upper() == "BEGIN":
                raise _wrong(token, "a second BEGIN")
            elif token.kind == "quoted" and self._next().text == "(":
                token.text = token.text.strip('"')
            elif token.kind in ("quoted", "attribute") or token.text in ("#", '"'):
                raise _wrong(token, f"no meaning for {token.text} in a statement")
            elif token.kind in ("marked", "word"):
                foreign = before.text == "." or (
                    bool(calls) and calls[-1] and self._next().kind == "assigned"
                )
                self._name(token, foreign=foreign)

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
