"""Lines of statements: how far in, and of good length."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable

#: Longest line where it can be helped [characters].
LINE = 100
#: A line is broken before an operator, and where it can be neither where that binds tightly nor
#: in a short bracket.
_OPERATOR = r"(?:AND|OR|NOT|IF|&&|\|\||[-+*/?:]) "
_TIGHT = r" (?:[*/]|:=|=>|[<>=!]=?|<>) | (?:THEN|DO)\b|\((?:[^()]|\([^()]*\)){,50}\)"
_KEPT = "\N{NO-BREAK SPACE}"


def folded(line: str, longest: int = LINE) -> list[str]:
    """Return a statement on lines that are not too long, broken before an operator or an argument.

    Examples
    --------
    >>> long = "  total_inflow := first_inflow + second_inflow * (first_share + second_share)"
    >>> print("\\n".join(folded(f"{long} + third_inflow * third_share;")))
      total_inflow := first_inflow + second_inflow * (first_share + second_share)
          + third_inflow * third_share;
    """
    bare = line.lstrip()
    start = line[: len(line) - len(bare)]
    wrapper = textwrap.TextWrapper(
        longest, start, f"{start}    ", break_long_words=False, break_on_hyphens=False
    )
    for pattern in (f"{_TIGHT}|{_OPERATOR}", _OPERATOR):
        rows = wrapper.wrap(re.sub(pattern, lambda found: found[0].replace(" ", _KEPT), bare))
        if all(len(row) <= longest for row in rows):
            break
    return [row.replace(_KEPT, " ") for row in rows]


def indented(lines: Iterable[str]) -> list[str]:
    """Return lines a step further in.

    >>> indented(["u := 0.0;"])
    ['  u := 0.0;']
    """
    return [f"  {line}" for line in lines]
