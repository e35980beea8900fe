"""Structured Text of Siemens (SCL) as the standard writes it, so that one grammar reads both."""

from __future__ import annotations

import re

#: What stands between the name of a block and its variables, and before its statements.
_LINES = re.compile(r"^\s*(\{.*\}|VERSION\s*:\s*[\d.]+|BEGIN)\s*$")
_QUOTED = re.compile(r'"([A-Za-z_]\w*)"')
#: A mark before a variable; one inside a typed literal, LREAL#1.0, stays.
_MARK = re.compile(r"(?<!\w)#(?=[A-Za-z_])")


def standard_text(text: str) -> str:
    """Return a text in SCL without what the standard does not know; lines keep their numbers.

    Attributes, version and BEGIN go, and so do the quotes around the names of blocks and the
    marks before variables. Comments stay as they are.

    Examples
    --------
    >>> print(standard_text('''FUNCTION_BLOCK "law"
    ... VERSION : 0.1
    ... BEGIN
    ... #y := LREAL#0.5 * #u; // "half" of #u'''))
    FUNCTION_BLOCK law
    <BLANKLINE>
    <BLANKLINE>
    y := LREAL#0.5 * u; // "half" of #u
    """
    return "\n".join(_line(line) for line in text.splitlines())


def _line(line: str) -> str:
    if _LINES.match(line):
        return ""
    code, mark, comment = line.partition("//")
    return _MARK.sub("", _QUOTED.sub(r"\1", code)) + mark + comment
