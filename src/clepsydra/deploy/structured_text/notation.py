"""How Structured Text writes operations."""

from __future__ import annotations

from clepsydra.deploy.printing.expressions import Notation
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import OWN, Dialect

# Functions of integers and truth values.
_TYPED = {
    "select": "SEL",
    "count": "BOOL_TO_DINT",
    "greatest": "MAX",
    "least": "MIN",
    "limit": "LIMIT",
    "magnitude": "ABS",
}
#: Two lines at the most.
_WIDTH = 150
_STATEMENTS = frozenset({"select", "number"})


def notation_of(dialect: Dialect, precision: Precision) -> Notation:
    """Return how a dialect writes operations on LREAL (double) or REAL (single).

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> notation_of(dialect_of("codesys"), "double").operators["not_equal"]
    '<>'
    """
    real = "LREAL" if precision == "double" else "REAL"
    power = {"pow": "EXPT"} if dialect.power else {}
    own = {code: dialect.quoted(name) for code, name in OWN.items()}
    typed = {**_TYPED, "real": f"DINT_TO_{real}", "rounded": f"{real}_TO_DINT"}
    return Notation(
        language="Structured Text",
        operators={
            "add": "+", "subtract": "-", "multiply": "*", "divide": "/",
            "less": "<", "less_equal": "<=", "equal": "=", "not_equal": "<>",
            "quotient": "/", "greater": ">", "greater_equal": ">=",
            "and": "AND", "or": "OR",
        },
        # A power that is an operator is written by `Wording`; here it counts for its width.
        functions={**dialect.functions, **power, **own, **typed},
        negation="NOT ",
        statements=_STATEMENTS,
        repeating=frozenset(),
        single=precision == "single",
        width=_WIDTH,
        formal=dialect.formal,
    )  # fmt: skip
