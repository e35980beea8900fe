"""How much a controller is to write down and to compute, whatever the machine."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from clepsydra.deploy.exportable import Exportable
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.program import Call, Conditional, ForLoop, Statement
from clepsydra.program.routine import RoutineCall

#: Constants, and conversions that only mark how a value is kept.
_NO_WORK = frozenset({"constant", "number", "truth"})
_SLOW = LIBRARY.keys() | {"divide", "square_root"}


@dataclass(frozen=True)
class Extent:
    """The extent of a controller.

    Parameters
    ----------
    lines : int
        Of its Structured Text, without comments and blank lines.
    own : int
        Those of them that stand in its own block; the others are the library, which the exports
        of a project share.
    operations : int
        On numbers and truth values in one scan at most: where branches part, all of them; what
        stands in a loop counts once a turn.
    slow : int
        Those among them that take a processor several times as long as a sum: quotients, roots,
        and functions of the mathematical library.
    always : int
        Those that no scan passes over.
    """

    lines: int
    own: int
    operations: int
    slow: int
    always: int


def extent_of(ready: Exportable) -> Extent:
    """Return the extent of a controller in its plant shell."""
    text = print_structured_text(ready.program, origin=ready.origin)
    statements = ready.program.block.statements
    codes = list(_codes(statements))
    always = sum(1 for _ in _codes(statements, always=True))
    own = text[text.rindex("\nFUNCTION_BLOCK ") :]
    slow = sum(code in _SLOW for code in codes)
    return Extent(lines_of_code(text), lines_of_code(own), len(codes), slow, always)


def lines_of_code(text: str) -> int:
    """Return how many lines of Structured Text hold more than comments."""
    bare = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
    return sum(bool(line.strip()) for line in bare.splitlines())


def _codes(statements: Iterable[Statement], *, always: bool = False) -> Iterator[str]:
    """Yield the operations of a scan at most, or those that none passes over."""
    for statement in statements:
        if always and isinstance(statement, Conditional):
            continue
        if isinstance(statement, Operation):
            if statement.code not in _NO_WORK:
                yield statement.code
            continue
        if isinstance(statement, Call):
            yield from _codes(statement.program.block.statements, always=always)
            continue
        if isinstance(statement, RoutineCall):
            yield from _codes(statement.routine.computed())
            continue
        turns = statement.count if isinstance(statement, ForLoop) else 1
        yield from turns * list(_codes(statement.body.statements, always=always))
