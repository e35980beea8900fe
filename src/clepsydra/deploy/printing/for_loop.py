"""A counted loop as it is printed: FOR in Structured Text, for in C."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.deploy.printing.lines import indented


@dataclass(frozen=True)
class ForLoop:
    """How a language writes a loop of so many turns; its index counts them from 0.

    Parameters
    ----------
    begin : str
        Its first line, with {index}, the number of {turns}, and the {last} value of the index.
    end : str
        Its last line.

    Examples
    --------
    >>> print("\\n".join(IN_STRUCTURED_TEXT.lines("i", 3, ["total := total + flow[i];"])))
    FOR i := 0 TO 2 DO
      total := total + flow[i];
    END_FOR;
    >>> print("\\n".join(IN_C.lines("i", 3, ["total = total + flow[i];"])))
    for (int32_t i = 0; i < 3; ++i) {
      total = total + flow[i];
    }
    """

    begin: str
    end: str

    def lines(self, index: str, turns: int, body: Iterable[str]) -> list[str]:
        """Return the lines of a loop around those of a turn; what runs once needs none."""
        if turns == 1:
            return [*body]
        first = self.begin.format(index=index, turns=turns, last=turns - 1)
        return [first, *indented(body), self.end]


IN_STRUCTURED_TEXT = ForLoop("FOR {index} := 0 TO {last} DO", "END_FOR;")
IN_C = ForLoop("for (int32_t {index} = 0; {index} < {turns}; ++{index}) {{", "}")
