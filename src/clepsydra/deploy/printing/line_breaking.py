"""Statements on lines that are not too long, nor too short."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

#: Longest line where it can be helped [characters].
LINE = 100
_STEP = "  "
_BREAKS = re.compile(r"(?P<sign>[()\[\]]|,|:=|(?<= )(?:AND|OR|&&|\|\||[?:]|[<>=!]+|[-+*/])(?= ))")
_OPENING, _CLOSING = "([", ")]"
# How much holds together what stands beside a sign; a line is broken there where it is least.
_TIGHT = {":=": 0, "=": 0, ",": 0, "?": 0, ":": 0, "OR": 1, "||": 1, "AND": 2, "&&": 2, "+": 4,
          "-": 4} | dict.fromkeys(("<", "<=", "<>", ">", ">=", "==", "!="), 3)  # fmt: skip
_BRANCH = re.compile(r" *((IF|ELSIF)\b.* THEN|ELSE)$")
_COMPOUND = re.compile(r" *(IF|FOR|\(\*|//)")
#: A line is broken before that many characters only where it cannot be helped.
_LEAST = 40


def folded(line: str, longest: int = LINE) -> Iterator[str]:
    """Yield a statement on lines that are not too long, broken where it holds least together.

    Examples
    --------
    >>> long = "  total_inflow := first_inflow + second_inflow * (first_share + second_share)"
    >>> print("\\n".join(folded(f"{long} + third_inflow * third_share;")))
      total_inflow := first_inflow + second_inflow * (first_share + second_share)
          + third_inflow * third_share;
    """
    start = len(line) - len(line.lstrip())
    indent, opened = line[:start] + _STEP * 2, 0
    while len(line) > longest:
        depth, places, brackets = opened, [], []
        for found in _BREAKS.finditer(line, start):
            sign = found["sign"]
            if sign in _OPENING or sign in _CLOSING:
                depth += 1 if sign in _OPENING else -1
                if sign in _OPENING and found.end() <= longest:
                    brackets.append((False, depth, 0, -found.end()))
                continue
            # A comma and an assignment stay where they are, an operator goes to the next line.
            at = found.end() + 1 if sign in (",", ":=") else found.start("sign")
            if len(line[:at].rstrip()) > longest:
                break
            if sign != ":=" or depth == 0:
                places.append((at < start + _LEAST, depth, _TIGHT.get(sign, 5), -at))
        # Behind a bracket only where nothing else is near enough.
        places = places or brackets[:1]
        if not places:
            break
        _, opened, _, at = min(places)
        yield line[:-at].rstrip()
        start, line = len(indent), indent + line[-at:]
    yield line


def dense(lines: Sequence[str]) -> list[str]:
    """Return statements with what each branch of an IF does beside its condition.

    That is so where every branch is one short statement.

    Examples
    --------
    >>> print("\\n".join(dense(["IF late THEN", "  scans := 0;", "END_IF;"])))
    IF late THEN scans := 0; END_IF;
    >>> print("\\n".join(dense(["IF a THEN", "  b := 1;", "ELSE", "  b := 2;", "END_IF;"])))
    IF a THEN b := 1;
    ELSE b := 2;
    END_IF;
    """
    found: list[str] = []
    place = 0
    while place < len(lines):
        rows = [*_branches(lines[place:])]
        end = place + 2 * len(rows)
        if len(rows) == 1:
            rows = [f"{rows[0]} END_IF;"]
            end += 1
        fits = rows and all(len(row) <= LINE for row in rows)
        found += rows if fits else [lines[place]]
        place = end if fits else place + 1
    return found


def _branches(lines: Sequence[str]) -> Iterator[str]:
    """Yield the branches of an IF at the beginning, a line each; none if one needs more."""
    if not lines[0].lstrip().startswith("IF "):
        return
    rows = []
    for place in range(0, len(lines) - 2, 2):
        head, inside, after = lines[place : place + 3]
        if not _BRANCH.match(head) or _COMPOUND.match(inside):
            return
        rows.append(f"{head} {inside.lstrip()}")
        if after.lstrip() == "END_IF;":
            yield from rows
            return
