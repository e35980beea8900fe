"""A counted loop as it is printed: FOR in Structured Text, for in C."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.deploy.printing.lines import indented


@dataclass(frozen=True)
class ForStatement:
    """How a language writes a loop of so many turns, which its index counts.

    Parameters
    ----------
    begin : str
        Its first line, with {index}, its {first} and its {last} value, and the one {behind} that.
    end : str
        Its last line.

    Examples
    --------
    >>> print("\\n".join(IN_STRUCTURED_TEXT.lines("i", range(3), ["total := total + flow[i];"])))
    FOR i := 0 TO 2 DO
      total := total + flow[i];
    END_FOR;
    >>> print("\\n".join(IN_C.lines("i", range(3), ["total = total + flow[i];"])))
    for (int32_t i = 0; i < 3; ++i) {
      total = total + flow[i];
    }
    """

    begin: str
    end: str

    def lines(self, index: str, turns: range, body: Iterable[str]) -> list[str]:
        """Return the lines of a loop around those of a turn; what runs once needs none."""
        if len(turns) == 1:
            return [*body]
        first, behind = turns.start, turns.stop
        begin = self.begin.format(index=index, first=first, last=behind - 1, behind=behind)
        return [begin, *indented(body), self.end]


IN_STRUCTURED_TEXT = ForStatement("FOR {index} := {first} TO {last} DO", "END_FOR;")
IN_C = ForStatement("for (int32_t {index} = {first}; {index} < {behind}; ++{index}) {{", "}")
