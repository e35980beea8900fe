"""Idioms of floating-point arithmetic that vanish where a law is written as expressions.

CasADi simplifies an expression as it is written, by rules of exact arithmetic: what an idiom was to
catch, a value that is no number or a rounding, is then caught by nothing.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from clepsydra.base.remark import Remark

_LONGEST = 60
_NO_NUMBER = "ca.logic_not(ca.fabs(x) <= 1e300)"
_CASE = "write the case out, as in ca.if_else(x == 0, 0, 1)"


@dataclass(frozen=True)
class Vanished:
    """What was written and is not in the law.

    Parameters
    ----------
    line : int
        Of the text that was looked at.
    written : str
    becomes : str
        What CasADi makes of it.
    remedy : str
        What to write.

    Examples
    --------
    >>> print(vanishing("bad = s['level'] != s['level']")[0].told("law.py"))
    law.py, line 1, s['level'] != s['level']: it becomes 0 as it is written, so what it was to \
catch is not caught; for what is no number write ca.logic_not(ca.fabs(x) <= 1e300).
    """

    line: int
    written: str
    becomes: str
    remedy: str

    def told(self, file: str) -> Remark:
        """Say it of a file, or of what else has these lines."""
        shown = self.written[:_LONGEST] + "…" if len(self.written) > _LONGEST else self.written
        means = f"it becomes {self.becomes} as it is written, so what it was to catch is not caught"
        return Remark(f"{file}, line {self.line}, {shown}", means, self.remedy)


def vanishing(text: str | bytes) -> tuple[Vanished, ...]:
    """Return the idioms in a text of Python that vanish where their operands are expressions.

    Examples
    --------
    >>> [each.becomes for each in vanishing("a = (x + y) - y\\nb = sqrt(x)**2\\nc = x + 1.0")]
    ['x', 'x']
    """
    found = (_vanished(node) for node in ast.walk(ast.parse(text)) if isinstance(node, ast.expr))
    return tuple(sorted((each for each in found if each), key=lambda each: each.line))


def _vanished(node: ast.expr) -> Vanished | None:
    """Return what becomes of an expression, if it vanishes."""
    for becomes, remedy in _rules(node):
        return Vanished(node.lineno, ast.unparse(node), becomes, remedy)
    return None


def _rules(node: ast.expr) -> Iterator[tuple[str, str]]:
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        if _same(node.left, node.comparators[0]):
            equal = isinstance(node.ops[0], ast.Eq | ast.LtE | ast.GtE)
            yield "1" if equal else "0", f"for what is no number write {_NO_NUMBER}"
    elif isinstance(node, ast.BinOp):
        left, right = node.left, node.right
        if isinstance(node.op, ast.Add):
            yield from _sum(left, right)
        elif isinstance(node.op, ast.Sub):
            yield from _difference(left, right)
        elif isinstance(node.op, ast.Mult):
            yield from _product(left, right)
        elif isinstance(node.op, ast.Div):
            yield from _quotient(left, right)
        elif isinstance(node.op, ast.Pow) and _is(right, 2) and (root := _root(left)):
            yield ast.unparse(root), "write ca.fmax(x, 0) where a negative x counts as zero"


_ROUNDED = "to keep the rounded sum write s = ca.if_else(ca.fabs(x + y) <= 1e300, x + y, 0), s - y"


def _sum(left: ast.expr, right: ast.expr) -> Iterator[tuple[str, str]]:
    for one, other in ((left, right), (right, left)):
        if _is(one, 0) and not isinstance(other, ast.Constant):
            yield ast.unparse(other), "for a zero without a sign write ca.if_else(x == 0, 0, x)"
        difference = _operands(one, ast.Sub)
        if difference and _same(difference[1], other):
            yield ast.unparse(difference[0]), _ROUNDED


def _difference(left: ast.expr, right: ast.expr) -> Iterator[tuple[str, str]]:
    if _same(left, right):
        yield "0", _CASE
    terms = _operands(left, ast.Add)
    for term, other in (terms, terms[::-1]) if terms else ():
        if _same(other, right):
            yield ast.unparse(term), _ROUNDED


def _product(left: ast.expr, right: ast.expr) -> Iterator[tuple[str, str]]:
    if (root := _root(left)) and _same(left, right):
        yield ast.unparse(root), "write ca.fmax(x, 0) where a negative x counts as zero"
    for one, other in ((left, right), (right, left)):
        fraction = _operands(one, ast.Div)
        if fraction and _same(fraction[1], other):
            yield ast.unparse(fraction[0]), _CASE
        if _is(one, 0) and not isinstance(other, ast.Constant):
            yield "0", _CASE


def _quotient(left: ast.expr, right: ast.expr) -> Iterator[tuple[str, str]]:
    if _same(left, right):
        yield "1", _CASE
    factors = _operands(left, ast.Mult)
    for factor, other in (factors, factors[::-1]) if factors else ():
        if _same(other, right) and not _same(factor, other):
            yield ast.unparse(factor), _CASE


def _operands(node: ast.expr, operator: type[ast.operator]) -> tuple[ast.expr, ast.expr] | None:
    """Return both sides of an operation of this kind."""
    fits = isinstance(node, ast.BinOp) and isinstance(node.op, operator)
    return (node.left, node.right) if fits else None  # type: ignore[attr-defined]


def _root(node: ast.expr) -> ast.expr | None:
    """Return what a square root is taken of."""
    if not isinstance(node, ast.Call) or len(node.args) != 1:
        return None
    called = node.func
    name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
    return node.args[0] if name == "sqrt" else None


def _is(node: ast.expr, number: int) -> bool:
    """Whether an expression is this number."""
    return (
        isinstance(node, ast.Constant)
        and type(node.value) in (int, float)
        and (node.value == number)
    )


def _same(one: ast.expr, other: ast.expr) -> bool:
    """Whether two expressions are written alike and are no numbers."""
    return ast.dump(one) == ast.dump(other) and not isinstance(one, ast.Constant)
