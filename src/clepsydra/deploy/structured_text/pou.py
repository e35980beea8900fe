"""A program organisation unit, from which PLCopen XML is written too, and its text in a dialect."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from clepsydra.deploy.printing.declarations import Variable
from clepsydra.deploy.printing.heading import commented, enclosed, harmless
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.structured_text.dialect import Dialect


@dataclass(frozen=True)
class Section:
    """Variables of one kind, in groups with a title each."""

    keyword: Literal["VAR_INPUT", "VAR_OUTPUT", "VAR", "VAR_TEMP", "STRUCT"]
    qualifier: Literal["", "RETAIN", "CONSTANT"]
    groups: tuple[tuple[str, tuple[Variable, ...]], ...]

    @property
    def variables(self) -> Iterator[Variable]:
        """Yield the variables of every group."""
        for _, group in self.groups:
            yield from group


@dataclass(frozen=True)
class Unit:
    """A program organisation unit, or the type of a structure.

    Parameters
    ----------
    kind : {"FUNCTION_BLOCK", "FUNCTION", "PROGRAM", "TYPE"}
    name : str
    head : tuple of str
        Lines of its head comment.
    sections : tuple of Section
        Those without variables are left out of every text.
    body : tuple of str
        Lines of its statements.
    result : str
        Type of what a function returns.
    """

    kind: Literal["FUNCTION_BLOCK", "FUNCTION", "PROGRAM", "TYPE"]
    name: str
    head: tuple[str, ...]
    sections: tuple[Section, ...]
    body: tuple[str, ...]
    result: str = ""


_WIDTH = 98
_COMMENT = re.compile(r"\(\* (.*?) \*\)", re.DOTALL)


def unit_text(unit: Unit, dialect: Dialect) -> list[str]:
    """Return the lines of a unit in a dialect.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> section = Section("VAR", "RETAIN", (("state", (Variable("x", "LREAL", ("0.5",)),)),))
    >>> unit = Unit("FUNCTION_BLOCK", "half", ("Half.",), (section,), ("x := 0.5 * x;",))
    >>> print("\\n".join(unit_text(unit, dialect_of("codesys"))))
    (* Half. *)
    FUNCTION_BLOCK half
    VAR RETAIN x : LREAL := 0.5; END_VAR
    x := 0.5 * x;
    END_FUNCTION_BLOCK
    """
    begin = [dialect.begin] if dialect.begin and unit.kind != "TYPE" else []
    end = f"END_{_keyword(unit, dialect)}"
    return [*declaration_lines(unit, dialect), *begin, *unit.body, end]


def declaration_lines(unit: Unit, dialect: Dialect) -> list[str]:
    """Return the lines of a unit down to its statements: comment, title, declarations.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> unit = Unit("PROGRAM", "main", ("Nothing yet.",), (), ())
    >>> declaration_lines(unit, dialect_of("codesys"))
    ['(* Nothing yet. *)', 'PROGRAM main']
    """
    result = f" : {unit.result}" if unit.result else ""
    result = " :" if unit.kind == "TYPE" and not dialect.local_mark else result
    title = f"{_keyword(unit, dialect)} {dialect.quoted(unit.name)}{result}"
    head = comment_lines(unit.head, dialect)
    # What stands before the attributes belongs to no block, so there the comment goes inside.
    attributes = () if unit.kind == "TYPE" else dialect.attributes
    opening = [title, *attributes, *head] if attributes else [*head, title]
    return [*opening, *(line for section in unit.sections for line in _section(section, dialect))]


def _keyword(unit: Unit, dialect: Dialect) -> str:
    return "FUNCTION_BLOCK" if unit.kind == "PROGRAM" and not dialect.programs else unit.kind


def comment_lines(lines: Sequence[str], dialect: Dialect) -> list[str]:
    """Return lines of text as one comment.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> comment_lines(["One.", "Two."], dialect_of("codesys"))
    ['(* One.', '   Two. *)']
    >>> comment_lines(["One.", "Two."], dialect_of("scl"))
    ['// One.', '// Two.']
    """
    safe = [
        row
        for line in lines
        for row in textwrap.wrap(harmless(line), _WIDTH - 4, subsequent_indent="  ")
    ]
    if dialect.line_comments or not safe:
        return [dialect.commented(line) for line in safe]
    return enclosed(safe, "(*", "*)")


def _section(section: Section, dialect: Dialect) -> list[str]:
    groups = [(title, variables) for title, variables in section.groups if variables]
    head = f"{section.keyword} {section.qualifier}".rstrip()
    end = "END_STRUCT;" if section.keyword == "STRUCT" else "END_VAR"
    lines: list[str] = []
    for title, variables in groups:
        if len(groups) > 1:
            lines.append(dialect.commented(title))
        # Variables of one type and one comment share a line, unless they have a value.
        alike: dict[tuple[str, ...], list[Variable]] = {}
        for each in variables:
            alone = each.initial or each.length or (each.is_block and dialect.instances_alone)
            key = (each.name,) if alone else (_type(each, dialect), each.comment)
            alike.setdefault(key, []).append(each)
        for entries in alike.values():
            names = ", ".join(entry.name for entry in entries)
            lines += _declaration(names, entries[0], dialect)
    text = "\n".join(lines)
    bare = _COMMENT.sub("", text).split("\n")
    bare = [line.strip() for line in bare if line.strip()]
    whole = f"{head} {' '.join(bare)} {end}"
    if len(bare) == 1 and "//" not in text and len(whole) <= _WIDTH:
        # What is declared in one line stands in one with its section.
        about = " ".join(found[1] for found in _COMMENT.finditer(text))
        return commented(whole, " ".join(about.split()), "(*", "*)", _WIDTH)
    return [head, *indented(lines), end] if lines else []


def _type(entry: Variable, dialect: Dialect) -> str:
    kind = dialect.quoted(entry.type) if entry.is_block else entry.type
    return f"ARRAY[0..{entry.length - 1}] OF {kind}" if entry.length else kind


def _declaration(names: str, entry: Variable, dialect: Dialect) -> list[str]:
    head, values = f"{names} : {_type(entry, dialect)}", ", ".join(entry.initial)
    value = f" := {f'[{values}]' if entry.length else values}" if values else ""
    if len(entry.initial) > 1 and len(head + value) >= _WIDTH:
        rows = textwrap.wrap(values + "];", _WIDTH - 4, break_on_hyphens=False)
        return [*_commented(f"{head} := [", entry.comment, dialect), *indented(rows)]
    *above, line = _commented(f"{head}{value};", entry.comment, dialect)
    # A comment to the end of the line cannot be wrapped with it.
    if value or (entry.comment and dialect.line_comments):
        return [*above, line]
    rows = textwrap.wrap(line, _WIDTH, subsequent_indent="  ", break_long_words=False)
    return [*above, *rows]


def _commented(line: str, text: str, dialect: Dialect) -> list[str]:
    if text and dialect.line_comments:
        return [f"{line} {dialect.commented(text)}"]
    return commented(line, text, "(*", "*)", _WIDTH)
