"""Expressions of Structured Text as expressions of Python, their types checked strictly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from clepsydra.deploy.proof.text.declarations import Declared, Unit
from clepsydra.deploy.proof.text.operations import (
    ARITHMETIC,
    COMPARED,
    COMPARISONS,
    DIVIDED,
    FUNCTIONS,
    PARAMETERS,
    ROUNDED,
    quotient,
    remainder,
    rounding,
    whole_quotient,
)
from clepsydra.deploy.proof.text.tree import StructuredTextError, content, part, wrong
from clepsydra.deploy.proof.text.values import DINT, LITERALS, REALS, in_range, literal

if TYPE_CHECKING:
    from tree_sitter import Node


def checked(values: list[Any], place: int) -> int:
    """Return an index that lies inside an array."""
    if not 0 <= place < len(values):
        raise StructuredTextError(f"index {place} outside 0..{len(values) - 1}")
    return place


@dataclass(frozen=True)
class Typed:
    """An expression of Python and its type in Structured Text.

    Parameters
    ----------
    type, code : str
    bounds : tuple of int, optional
        The least and the most that a DINT is known to be, so that nobody needs to look later.
    """

    type: str
    code: str
    bounds: tuple[int, int] | None = None


class Expressions:
    """Translates the expressions of one unit.

    A literal of real numbers takes the type that stands beside it. No value is converted
    without a function that says so.

    Parameters
    ----------
    unit : Unit
    units : mapping
        All function blocks of the text by name in lower case.
    functions : mapping
        The functions of the text that may be called, by name in lower case.

    Examples
    --------
    See `clepsydra.deploy.proof.text.interpreter.FunctionBlock`.
    """

    def __init__(
        self,
        unit: Unit,
        units: Mapping[str, Unit],
        functions: Mapping[str, Callable[..., Any]],
    ) -> None:
        self._unit, self._units, self._functions = unit, units, functions
        self.read: set[str] = set()
        #: What the translated code calls.
        self.namespace: dict[str, Any] = {
            "quotient": quotient, "remainder": remainder,
            "whole_quotient": whole_quotient, "in_range": in_range,
            "checked": checked, "single": rounding(),
        }  # fmt: skip
        self._passed = 0
        #: Counters of the FORs around, which nothing else may write.
        self.counters: dict[str, Typed] = {}

    def known(self, node: Node, name: str) -> Declared:
        """Return what a name stands for."""
        if name not in self._unit.declared:
            raise wrong(node, f"{name} is not declared")
        return self._unit.declared[name]

    def unit_of(self, node: Node, name: str) -> Unit:
        """Return the function block that an instance is one of."""
        kind = self.known(node, name).type
        if kind not in self._units or self._units[kind].kind not in ("FUNCTION_BLOCK", "STRUCT"):
            raise wrong(node, f"{name} is no instance of a function block of this text")
        return self._units[kind]

    def is_record(self, declared: Declared) -> bool:
        """Whether a variable is a structure."""
        return declared.type in self._units and self._units[declared.type].kind == "STRUCT"

    def of_type(self, node: Node, type_name: str, what: str) -> str:
        """Translate an expression that must be of a type."""
        found = self.expression(node, type_name)
        if found.type != type_name:
            raise wrong(node, f"{what} is {type_name}, the value {found.type}")
        return found.code

    def entry(self, node: Node, name: str) -> str:
        """Return the entry of an array, at an index that is known or checked to lie inside."""
        declared = self.known(node, name)
        if not declared.length:
            raise wrong(node, f"{name} is no array")
        index, values = self.expression(part(node, "index")), self.variable(name)
        if index.type != "DINT":
            raise wrong(node, f"an index is DINT, the value {index.type}")
        if index.bounds and index.bounds[0] >= 0 and index.bounds[1] < declared.length:
            return f"{values}[{index.code}]"
        found = self._passing("place")
        return (
            f"{values}[{found} if 0 <= ({found} := {index.code}) < {declared.length} "
            f"else checked({values}, {found})]"
        )

    def expression(self, node: Node, wanted: str = "LREAL") -> Typed:
        """Translate an expression; an untyped real literal becomes what is wanted."""
        if node.type == "parenthesized_expression":
            return self.expression(node.named_children[0], wanted)
        if node.type in LITERALS or node.type == "typed_literal":
            return self._literal(node, wanted)
        kinds = {
            "identifier": self._variable,
            "index_expression": self._entry,
            "member_access_expression": self._member,
            "unary_expression": self._unary,
            "binary_expression": self._binary,
            "call_expression": self._call,
        }
        if node.type in kinds:
            return kinds[node.type](node, wanted)
        raise wrong(node, f"no meaning for {node.type}")

    def variable(self, name: str) -> str:
        """Return what reads a variable."""
        self.read.add(name)
        return f"v_{name}"

    def _literal(self, node: Node, wanted: str) -> Typed:
        if node.type == "typed_literal":
            type_name = content(part(node, "type")).upper()
        else:
            possible = LITERALS[node.type]
            type_name = wanted if wanted in possible else possible[0]
        value = literal(node, type_name)
        return Typed(type_name, repr(value), (value, value) if type_name == "DINT" else None)

    def _variable(self, node: Node, wanted: str) -> Typed:
        name = content(node).lower()
        declared = self.known(node, name)
        if declared.length or declared.is_instance:
            raise wrong(node, f"{name} is no single value")
        return self.counters.get(name) or Typed(declared.type, self.variable(name))

    def _entry(self, node: Node, wanted: str) -> Typed:
        name = content(part(node, "object")).lower()
        return Typed(self.known(node, name).type, self.entry(node, name))

    def _member(self, node: Node, wanted: str) -> Typed:
        held, member = part(node, "object"), content(part(node, "member")).lower()
        if held.type == "member_access_expression":
            whole = self._member(held, wanted)
            unit, memory = self._units[whole.type], whole.code
        else:
            name = content(held).lower()
            unit, memory = self.unit_of(node, name), self.variable(name)
        declared = unit.declared.get(member)
        if declared is None or declared.section != "VAR_OUTPUT" or declared.length:
            raise wrong(node, f"{member} is no output of {unit.name}")
        return Typed(declared.type, f"{memory}.state[{member!r}]")

    def _unary(self, node: Node, wanted: str) -> Typed:
        operator = content(part(node, "operator")).upper()
        operand = self.expression(part(node, "operand"), wanted)
        if operator == "NOT" and operand.type == "BOOL":
            return Typed("BOOL", f"(not {operand.code})")
        if (operator, operand.type) == ("-", "DINT"):
            return Typed("DINT", f"in_range(-{operand.code})")
        if operator == "-" and operand.type in ("LREAL", "REAL"):
            return Typed(operand.type, f"(-{operand.code})")
        raise wrong(node, f"{operator} of {operand.type}")

    def _binary(self, node: Node, wanted: str) -> Typed:
        operator = content(part(node, "operator")).upper()
        operator = "AND" if operator == "&" else operator
        parts = part(node, "left"), part(node, "right")
        left, right = (self.expression(each, wanted) for each in parts)
        if left.type != right.type:
            # The literal of two takes the type of the other one.
            if _has_own_type(parts[0]):
                right = self.expression(parts[1], left.type)
            elif _has_own_type(parts[1]):
                left = self.expression(parts[0], right.type)
        kind = left.type
        if kind != right.type:
            raise wrong(node, f"{kind} {operator} {right.type}")
        if operator in COMPARISONS and kind in COMPARED:
            return Typed("BOOL", f"({left.code} {COMPARISONS[operator]} {right.code})")
        if kind == "DINT" and (known := _counted(operator, left, right)):
            return known
        if (kind, operator) in ARITHMETIC:
            sign, function = ARITHMETIC[kind, operator], ROUNDED.get(kind, "")
            code = f"{left.code} {sign} {right.code}"
            return Typed(kind, self._whole(code) if kind == "DINT" else f"{function}({code})")
        if (kind, operator) in DIVIDED:
            return Typed(kind, f"{DIVIDED[kind, operator]}({left.code}, {right.code})")
        if operator == "/" and kind in REALS:
            return Typed(kind, f"{ROUNDED.get(kind, '')}({self._quotient(left.code, right.code)})")
        if operator == "**" and kind in REALS:
            return self._applied(node, "EXPT", [left, right])
        raise wrong(node, f"{operator} of {kind}")

    def _quotient(self, left: str, right: str) -> str:
        """Divide by what is not zero without a call: `left / d if (d := right) else …`."""
        name = self._passing("divisor")
        return f"{left} / {name} if ({name} := {right}) else quotient({left}, {name})"

    def _whole(self, code: str) -> str:
        """Compute a DINT, with a call only where it does not fit."""
        name = self._passing("whole")
        fits = f"{DINT.start} <= ({name} := {code}) < {DINT.stop}"
        return f"({name} if {fits} else in_range({name}))"

    def _passing(self, stem: str) -> str:
        """Return a name of Python for a value on the way."""
        self._passed += 1
        return f"{stem}_{self._passed}"

    def _call(self, node: Node, wanted: str) -> Typed:
        name = content(part(node, "function")).upper()
        if name.lower() in self._functions:
            return self._of_text(node, self._units[name.lower()])
        given = [self._argument(each, name, k) for k, each in enumerate(_given(node))]
        arguments = [self.expression(argument, wanted) for argument in given]
        own = {a.type for a, n in zip(arguments, given, strict=True) if _has_own_type(n)}
        if name == "SEL":
            # What selects says nothing of what is selected.
            own = {arguments[k].type for k in (1, 2) if _has_own_type(given[k])}
        if len(own) == 1:
            # Literals take the type of what stands beside them.
            arguments = [self.expression(argument, *own) for argument in given]
        return self._applied(node, name, arguments)

    def _of_text(self, node: Node, unit: Unit) -> Typed:
        """Translate the call of a function that the text declares."""
        key, given = unit.name.lower(), _given(node)
        inputs = [(n, d.type) for n, d in unit.declared.items() if d.section == "VAR_INPUT"]
        if unit.kind != "FUNCTION" or len(given) != len(inputs):
            raise wrong(node, f"{unit.name} is no function of {len(given)} inputs")
        arguments = []
        for each, (name, kind) in zip(given, inputs, strict=True):
            if each.type == "named_argument":
                if content(part(each, "name")).lower() != name:
                    raise wrong(node, f"{content(each)} is not {name} of {unit.name}")
                each = part(each, "value")
            arguments.append(self.of_type(each, kind, name))
        self.namespace[f"f_{key}"] = self._functions[key]
        return Typed(unit.declared[key].type, f"f_{key}({', '.join(arguments)})")

    def _argument(self, node: Node, function: str, place: int) -> Node:
        """Return the value of an argument, which may be given with its name."""
        if node.type != "named_argument":
            return node
        names = PARAMETERS.get(function, ())
        if content(part(node, "name")).upper() not in names[place : place + 1]:
            raise wrong(node, f"{content(node)} is no argument {place + 1} of {function}")
        return part(node, "value")

    def _applied(self, node: Node, name: str, arguments: list[Typed]) -> Typed:
        types = tuple(argument.type for argument in arguments)
        if (name, types) not in FUNCTIONS:
            raise wrong(node, f"{name} of {', '.join(types) or 'nothing'} is unknown here")
        result, compute = FUNCTIONS[name, types]
        function = f"{name}_{'_'.join(types)}"
        self.namespace[function] = compute
        return Typed(result, f"{function}({', '.join(each.code for each in arguments)})")


def _counted(sign: str, left: Typed, right: Typed) -> Typed | None:
    """Return a sum, difference or product of DINT that cannot overflow, if it is known not to."""
    compute = {"+": int.__add__, "-": int.__sub__, "*": int.__mul__}.get(sign)
    if compute is None or left.bounds is None or right.bounds is None:
        return None
    ends = [compute(a, b) for a in left.bounds for b in right.bounds]
    bounds = min(ends), max(ends)
    fits = bounds[0] in DINT and bounds[1] in DINT
    return Typed("DINT", f"({left.code} {sign} {right.code})", bounds) if fits else None


def _given(node: Node) -> list[Node]:
    return [each for each in part(node, "arguments").named_children if each.type != "comment"]


def _has_own_type(node: Node) -> bool:
    """Whether an expression is something else than literals of real numbers."""
    if node.type in ("parenthesized_expression", "unary_expression", "binary_expression"):
        operands = [child for child in node.named_children if child.type != "comment"]
        return any(_has_own_type(child) for child in operands)
    return node.type != "real_literal"
