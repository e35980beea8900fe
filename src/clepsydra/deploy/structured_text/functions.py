"""The functions that come with a text: larger and smaller of two numbers, and whole numbers."""

from __future__ import annotations

from collections.abc import Iterable

from clepsydra.deploy.printing.declarations import Variable
from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.lines import dense
from clepsydra.deploy.structured_text.dialect import OWN, Dialect
from clepsydra.deploy.structured_text.pou import Section, Unit
from clepsydra.deploy.structured_text.statements import StructuredText
from clepsydra.program.precision import Precision

# A double of this size or above is a whole number already, and so is a single-precision number.
_WHOLE = {"double": 2.0**52, "single": 2.0**23}
# Quotient and rest by this divisor fit a DINT for every smaller double, and both are exact.
_SPLIT = 2.0**21
_ABOUT = {
    "maximum": "the larger of two numbers; b where they are equal or one is no number.",
    "minimum": "the smaller of two numbers; b where they are equal or one is no number.",
    "floor": "the largest whole number not above a number, with its zero's sign.",
    "ceiling": "the smallest whole number not below a number, with its zero's sign.",
}


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
        _function(code, StructuredText(dialect, precision))
        for code, name in OWN.items()
        if f"{dialect.quoted(name)}(" in text
    )


def _function(code: str, wording: StructuredText) -> Unit:
    name = OWN[code]
    lines, inputs = _whole(code, wording), "a"
    if code in ("maximum", "minimum"):
        a, b = variable("a"), variable("b")
        larger = Expression("less" if code == "minimum" else "greater", (a, b))
        lines, inputs = wording.assign(name, Expression("select", (larger, a, b))), "ab"
    variables = tuple(Variable(each, wording.real) for each in inputs)
    return Unit(
        "FUNCTION",
        name,
        (f"{name}: {_ABOUT[code]}",),
        (Section("VAR_INPUT", "", (("", variables),)),),
        tuple(dense([wording.marked(line, {*inputs, name.lower()}) for line in lines])),
        wording.real,
    )


def _whole(code: str, wording: StructuredText) -> list[str]:
    """Write a number cut off, and corrected.

    The standard has a cut-off to a DINT only. A double is cut off in two parts that both fit; a
    single-precision number that is not whole fits at once. The product with zero keeps the sign
    of zero; not a number and infinity stay what they are.
    """
    name, (beyond, back) = OWN[code], (">", "-") if code == "floor" else ("<", "+")
    one, zero, split = map(wording.literal, (1.0, 0.0, _SPLIT))

    def cut(value: str) -> str:
        return f"DINT_TO_{wording.real}({wording.dialect.truncate}({value}))"

    parts = [f"  {name} := {cut('a')};"]
    if wording.precision == "double":
        parts = [
            f"  {name} := {split} * {cut(f'a / {split}')};",
            f"  {name} := {name} + {cut(f'a - {name}')};",
        ]
    return [
        f"{name} := a;",
        f"IF ABS(a) < {wording.literal(_WHOLE[wording.precision])} THEN",
        *parts,
        f"  IF {name} {beyond} a THEN",
        f"    {name} := {name} {back} {one};",
        "  END_IF;",
        f"  IF {name} = {zero} THEN",
        f"    {name} := a * {zero};",
        "  END_IF;",
        "END_IF;",
    ]
