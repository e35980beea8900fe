"""A program organisation unit: what Structured Text and PLCopen XML are both written from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Variable:
    """A declared variable.

    Parameters
    ----------
    name : str
    type : str
        An elementary type, or the name of a function block whose instance it is.
    initial : tuple of str
        Initial value, one text an entry of an array; empty for the default of the type.
    length : int
        Entries of an array from 0 on; 0 for a variable that is none.
    comment : str
        Unit, range, description and source; on one line.
    is_block : bool
        Whether the type is a function block.

    Examples
    --------
    >>> Variable("level", "LREAL", ("0.1",), comment="[m]").is_array
    False
    """

    name: str
    type: str
    initial: tuple[str, ...] = ()
    length: int = 0
    comment: str = ""
    is_block: bool = False

    @property
    def is_array(self) -> bool:
        """Whether it is an array."""
        return self.length > 0


@dataclass(frozen=True)
class Section:
    """Variables of one kind, in groups with a title each.

    Examples
    --------
    >>> Section("VAR", "RETAIN", (("state", (Variable("x", "LREAL"),)),)).keyword
    'VAR'
    """

    keyword: Literal["VAR_INPUT", "VAR_OUTPUT", "VAR", "VAR_TEMP"]
    qualifier: Literal["", "RETAIN", "CONSTANT"]
    groups: tuple[tuple[str, tuple[Variable, ...]], ...]

    @property
    def variables(self) -> Iterator[Variable]:
        """Yield the variables of every group."""
        for _, group in self.groups:
            yield from group


@dataclass(frozen=True)
class Unit:
    """A program organisation unit.

    Parameters
    ----------
    kind : {"FUNCTION_BLOCK", "FUNCTION", "PROGRAM"}
    name : str
    head : tuple of str
        Lines of its head comment.
    sections : tuple of Section
        Those without variables are left out of every text.
    body : tuple of str
        Lines of its statements.
    result : str
        Type of what a function returns.

    Examples
    --------
    >>> Unit("PROGRAM", "level_test", ("A test.",), (), ("level := 0.1;",)).body
    ('level := 0.1;',)
    """

    kind: Literal["FUNCTION_BLOCK", "FUNCTION", "PROGRAM"]
    name: str
    head: tuple[str, ...]
    sections: tuple[Section, ...]
    body: tuple[str, ...]
    result: str = ""

    def declared(self) -> list[tuple[Section, Variable]]:
        """Return every variable with its section."""
        return [(section, entry) for section in self.sections for entry in section.variables]
