"""How Structured Text writes operations."""

from __future__ import annotations

from clepsydra.deploy.printing.expressions import Notation
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import Dialect

_STATEMENTS = frozenset({"select", "maximum", "minimum", "number", "floor", "ceiling"})


def notation_of(dialect: Dialect, precision: Precision) -> Notation:
    """Return how a dialect writes operations on LREAL (double) or REAL (single).

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> notation_of(dialect_of("codesys"), "double").operators["not_equal"]
    '<>'
    """
    return Notation(
        language="Structured Text",
        operators={
            "add": "+", "subtract": "-", "multiply": "*", "divide": "/",
            "less": "<", "less_equal": "<=", "equal": "=", "not_equal": "<>",
            "and": "AND", "or": "OR",
        },
        # A power that is an operator is written by `Wording`; here it counts for its width.
        functions={**dialect.functions, **({"pow": "EXPT"} if dialect.power else {})},
        negation="NOT ",
        statements=_STATEMENTS,
        repeating=_STATEMENTS - {"select", "number"},
        rounding=frozenset({"floor", "ceiling"}),
        single=precision == "single",
    )  # fmt: skip
