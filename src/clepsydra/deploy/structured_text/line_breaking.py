"""Statements of Structured Text on lines that are not too long."""

from __future__ import annotations

import re
from collections.abc import Iterator

#: Longest line where it can be helped [characters].
LINE = 100
_STEP = "  "
_BREAKS = re.compile(r"(?P<sign>[()\[\]]|,|:=|(?<= )(?:AND|OR|[<>=]+|[-+*/])(?= ))")
_OPENING, _CLOSING = "([", ")]"
# How much holds together what stands beside a sign; a line is broken there where it is least.
_TIGHT = {":=": 0, ",": 0, "OR": 1, "AND": 2, "<": 3, "<=": 3, "=": 3, "<>": 3, ">": 3, ">=": 3,
          "+": 4, "-": 4}  # fmt: skip
#: A line is broken before that many characters only where it cannot be helped.
_LEAST = 40


def folded(line: str) -> Iterator[str]:
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
    while len(line) > LINE:
        depth, places = opened, []
        for found in _BREAKS.finditer(line, start):
            sign = found["sign"]
            if sign in _OPENING or sign in _CLOSING:
                depth += 1 if sign in _OPENING else -1
                continue
            # A comma and an assignment stay where they are, an operator goes to the next line.
            at = found.end() + 1 if sign in (",", ":=") else found.start("sign")
            if len(line[:at].rstrip()) > LINE:
                break
            if sign != ":=" or depth == 0:
                places.append((at < start + _LEAST, depth, _TIGHT.get(sign, 5), -at))
        if not places:
            break
        _, opened, _, at = min(places)
        yield line[:-at].rstrip()
        start, line = len(indent), indent + line[-at:]
    yield line
