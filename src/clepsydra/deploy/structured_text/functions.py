"""The functions that come with a text: the larger and the smaller of two numbers."""

from __future__ import annotations

from collections.abc import Iterable

from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.notation import EXTREMES
from clepsydra.deploy.structured_text.pou import Section, Unit, Variable
from clepsydra.deploy.structured_text.wording import Wording


def called_functions(
    units: Iterable[Unit], dialect: Dialect, precision: Precision
) -> tuple[Unit, ...]:
    """Return the functions that units call.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> unit = Unit("FUNCTION_BLOCK", "law", (), (), ("y := FC_Max(u, 0.0);",))
    >>> called_functions([unit], dialect_of("codesys"), "double")[0].body
    ('FC_Max := SEL(a > b, b, a);',)
    """
    text = "\n".join(line for unit in units for line in unit.body)
    return tuple(
        _function(code, dialect, precision)
        for code, name in EXTREMES.items()
        if f"{dialect.quoted(name)}(" in text
    )


def _function(code: str, dialect: Dialect, precision: Precision) -> Unit:
    name, wording = EXTREMES[code], Wording(dialect, precision, Identifiers([], ignore_case=True))
    a, b = variable("a"), variable("b")
    larger = Expression("greater" if code == "maximum" else "less", (a, b))
    line = f"{name} := {wording.expression(Expression('select', (larger, a, b)))};"
    inputs = tuple(Variable(each, wording.real) for each in "ab")
    what = "larger" if code == "maximum" else "smaller"
    about = f"{name}: the {what} of two numbers; b where they are equal or one is no number."
    return Unit(
        "FUNCTION",
        name,
        (about,),
        (Section("VAR_INPUT", "", (("", inputs),)),),
        (wording.marked(line, {"a", "b", name.lower()}),),
        wording.real,
    )
