"""Runs a FUNCTION_BLOCK of Structured Text from its parse tree, independent of the printer.

The text is parsed by the public grammar tree-sitter-iec61131-3-st; an error anywhere in the tree
is refused. Types are as strict as the standard's: no implicit conversion, DINT in 32 bits, a
variable is declared before it is used, and an index stays inside its array. LREAL is the IEEE 754
double. Reading a temporary variable before it was written is an error too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from tree_sitter import Node

Environment = dict[str, Any]
Evaluate = Callable[[Environment], Any]
Execute = Callable[[Environment], None]


class StructuredTextError(Exception):
    """The text is wrong, or does something that the standard leaves undefined."""


@dataclass(frozen=True)
class Declared:
    section: str
    type: str
    initial: Any
    length: int = 0


def parse(text: str) -> Node:
    import tree_sitter_iec61131_3_st
    from tree_sitter import Language, Parser

    tree = Parser(Language(tree_sitter_iec61131_3_st.language())).parse(text.encode())
    wrong = [node for node in walk(tree.root_node) if node.is_error or node.is_missing]
    if wrong:
        node = wrong[0]
        raise StructuredTextError(f"line {node.start_point[0] + 1}: {node.text.decode()!r}")
    return tree.root_node


def walk(node: Node):
    yield node
    for child in node.children:
        yield from walk(child)


class FunctionBlock:
    """One instance of a function block: `state` holds all that lives between calls."""

    def __init__(self, text: str) -> None:
        root = parse(text)
        blocks = [node for node in root.children if node.type == "function_block_declaration"]
        others = [node for node in root.children if node.type not in ("comment", blocks[0].type)]
        if len(blocks) != 1 or others:
            raise StructuredTextError("expected one function block and nothing else")
        self.name = content(blocks[0].child_by_field_name("name"))
        self.declared: dict[str, Declared] = {}
        for child in blocks[0].children:
            if child.type in ("var_input", "var_output", "var_block", "var_temp"):
                self._declare(child)
        body = blocks[0].children_by_field_name("body")
        self._body = self._sequence(body)
        self.state: Environment = {
            name: list(entry.initial) if entry.length else entry.initial
            for name, entry in self.declared.items()
            if entry.section != "VAR_TEMP"
        }

    def __call__(self, **inputs: Any) -> dict[str, Any]:
        """Write inputs, run once, and return the outputs."""
        for name, value in inputs.items():
            entry = self.declared[name.lower()]
            if entry.section != "VAR_INPUT":
                raise StructuredTextError(f"{name} is no input")
            self.state[name.lower()] = admitted(entry.type, value)
        environment = self.state
        self._body(environment)
        for name, entry in self.declared.items():
            if entry.section == "VAR_TEMP":
                environment.pop(name, None)
        return {
            name: environment[name]
            for name, entry in self.declared.items()
            if entry.section == "VAR_OUTPUT"
        }

    def _declare(self, section: Node) -> None:
        keyword = section.children[0].type.upper()
        if any(node.type == "var_qualifier_list" for node in section.children):
            keyword = "VAR CONSTANT"
        for node in section.children:
            if node.type != "variable_declaration":
                continue
            name = content(node.child_by_field_name("names")).lower()
            if name in self.declared:
                raise StructuredTextError(f"{name} is declared twice")
            self.declared[name] = self._variable(keyword, node)

    def _variable(self, section: str, node: Node) -> Declared:
        kind = node.child_by_field_name("type")
        values = [
            child
            for child in node.children_by_field_name("initial_value")
            if child.type not in ("[", "]", ",")
        ]
        if kind.type != "array_type":
            type_name = content(kind)
            zero = {"LREAL": 0.0, "DINT": 0, "BOOL": False}[type_name]
            initial = literal(values[0], type_name) if values else zero
            return Declared(section, type_name, initial)
        type_name = content(kind.child_by_field_name("element_type"))
        bounds = kind.child_by_field_name("range")
        low = int(content(bounds.child_by_field_name("lower")))
        high = int(content(bounds.child_by_field_name("upper")))
        if low != 0:
            raise StructuredTextError("arrays start at 0 here")
        entries: list[Any] = []
        for value in values:
            if value.type == "array_repetition":
                count = int(content(value.child_by_field_name("count")))
                entries += [literal(value.named_children[1], type_name)] * count
            else:
                entries.append(literal(value, type_name))
        if len(entries) != high + 1:
            raise StructuredTextError(f"{len(entries)} values for {high + 1} entries")
        return Declared(section, type_name, entries, high + 1)

    def _sequence(self, nodes: list[Node]) -> Execute:
        steps = [self._statement(node) for node in nodes if node.type != "empty_statement"]

        def run(environment: Environment) -> None:
            for step in steps:
                step(environment)

        return run

    def _statement(self, node: Node) -> Execute:
        kinds = {
            "assignment_statement": self._assignment,
            "if_statement": self._if,
            "for_statement": self._for,
        }
        if node.type not in kinds:
            raise StructuredTextError(f"no meaning for {node.type}")
        return kinds[node.type](node)

    def _assignment(self, node: Node) -> Execute:
        left = node.child_by_field_name("left")
        type_name, value = self._expression(node.child_by_field_name("right"))
        name = content(left if left.type == "identifier" else left.child_by_field_name("object"))
        name = name.lower()
        entry = self._known(name)
        if entry.section in ("VAR_INPUT", "VAR CONSTANT"):
            raise StructuredTextError(f"{name} may not be written")
        if entry.type != type_name:
            raise StructuredTextError(f"{name} is {entry.type}, the value {type_name}")
        if left.type == "identifier":
            if entry.length:
                raise StructuredTextError(f"{name} is an array")

            def write(environment: Environment) -> None:
                environment[name] = value(environment)

            return write
        index = self._index(entry, left)

        def write_entry(environment: Environment) -> None:
            environment[name][index(environment)] = value(environment)

        return write_entry

    def _index(self, entry: Declared, node: Node) -> Evaluate:
        type_name, index = self._expression(node.child_by_field_name("index"))
        if type_name != "DINT" or not entry.length:
            raise StructuredTextError("an index is a DINT into an array")

        def checked(environment: Environment) -> int:
            place = index(environment)
            if not 0 <= place < entry.length:
                raise StructuredTextError(f"index {place} outside 0..{entry.length - 1}")
            return int(place)

        return checked

    def _if(self, node: Node) -> Execute:
        branches = [
            (self._condition(node), self._sequence(node.children_by_field_name("consequence")))
        ]
        otherwise: Execute | None = None
        for child in node.children:
            if child.type == "elsif_clause":
                body = self._sequence(child.children_by_field_name("body"))
                branches.append((self._condition(child), body))
            elif child.type == "else_clause":
                otherwise = self._sequence(child.children_by_field_name("body"))

        def run(environment: Environment) -> None:
            for condition, body in branches:
                if condition(environment):
                    body(environment)
                    return
            if otherwise is not None:
                otherwise(environment)

        return run

    def _condition(self, node: Node) -> Evaluate:
        type_name, condition = self._expression(node.child_by_field_name("condition"))
        if type_name != "BOOL":
            raise StructuredTextError(f"a condition of type {type_name}")
        return condition

    def _for(self, node: Node) -> Execute:
        control = content(node.child_by_field_name("control")).lower()
        start_type, start = self._expression(node.child_by_field_name("start"))
        end_type, end = self._expression(node.child_by_field_name("end"))
        if {self._known(control).type, start_type, end_type} != {"DINT"}:
            raise StructuredTextError("a FOR counts with DINT")
        if node.child_by_field_name("step") is not None:
            raise StructuredTextError("no BY expected")
        body = self._sequence(node.children_by_field_name("body"))

        def run(environment: Environment) -> None:
            for turn in range(start(environment), end(environment) + 1):
                environment[control] = turn
                body(environment)

        return run

    def _known(self, name: str) -> Declared:
        if name not in self.declared:
            raise StructuredTextError(f"{name} is not declared")
        return self.declared[name]

    def _expression(self, node: Node) -> tuple[str, Evaluate]:
        kind = node.type
        if kind == "parenthesized_expression":
            return self._expression(node.named_children[0])
        if kind in LITERALS:
            value = literal(node, LITERALS[kind])
            return LITERALS[kind], lambda environment: value
        if kind == "identifier":
            name = content(node).lower()
            entry = self._known(name)
            if entry.length:
                raise StructuredTextError(f"{name} is an array")
            return entry.type, lambda environment: environment[name]
        if kind == "index_expression":
            name = content(node.child_by_field_name("object")).lower()
            entry = self._known(name)
            index = self._index(entry, node)
            return entry.type, lambda environment: environment[name][index(environment)]
        if kind == "unary_expression":
            return self._unary(node)
        if kind == "binary_expression":
            return self._binary(node)
        if kind == "call_expression":
            return self._call(node)
        raise StructuredTextError(f"no meaning for {kind}")

    def _unary(self, node: Node) -> tuple[str, Evaluate]:
        operator = content(node.child_by_field_name("operator"))
        type_name, operand = self._expression(node.child_by_field_name("operand"))
        if operator == "NOT" and type_name == "BOOL":
            return "BOOL", lambda environment: not operand(environment)
        if operator == "-" and type_name == "LREAL":
            return "LREAL", lambda environment: -operand(environment)
        raise StructuredTextError(f"{operator} of {type_name}")

    def _binary(self, node: Node) -> tuple[str, Evaluate]:
        operator = content(node.child_by_field_name("operator"))
        left_type, left = self._expression(node.child_by_field_name("left"))
        right_type, right = self._expression(node.child_by_field_name("right"))
        if left_type != right_type:
            raise StructuredTextError(f"{left_type} {operator} {right_type}")
        if (left_type, operator) not in BINARY:
            raise StructuredTextError(f"{operator} of {left_type}")
        result, compute = BINARY[left_type, operator]
        return result, lambda environment: compute(left(environment), right(environment))

    def _call(self, node: Node) -> tuple[str, Evaluate]:
        name = content(node.child_by_field_name("function"))
        arguments = [
            self._expression(argument)
            for argument in node.child_by_field_name("arguments").named_children
        ]
        if name not in FUNCTIONS:
            raise StructuredTextError(f"{name} is no standard function known here")
        expected, result, compute = FUNCTIONS[name]
        if tuple(type_name for type_name, _ in arguments) != expected:
            raise StructuredTextError(f"{name} of {[kind for kind, _ in arguments]}")
        values = [value for _, value in arguments]
        return result, lambda environment: compute(*(value(environment) for value in values))


LITERALS = {"real_literal": "LREAL", "integer_literal": "DINT", "boolean_literal": "BOOL"}


def content(node: Node) -> str:
    return node.text.decode()


def literal(node: Node, type_name: str) -> Any:
    text = content(node)
    if LITERALS.get(node.type) != type_name:
        raise StructuredTextError(f"{text} is no literal of {type_name}")
    if type_name == "BOOL":
        return {"TRUE": True, "FALSE": False}[text]
    return float(text) if type_name == "LREAL" else in_range(int(text))


def admitted(type_name: str, value: Any) -> Any:
    if type_name == "LREAL":
        return float(value)
    if type_name == "BOOL":
        return {0: False, 1: True}[value]
    return in_range(int(value))


def in_range(value: int) -> int:
    if not -(2**31) <= value < 2**31:
        raise StructuredTextError(f"{value} leaves DINT")
    return value


def quotient(a: float, b: float) -> float:
    if b != 0.0 or math.isnan(a):
        return a / b if b != 0.0 else math.nan
    if a == 0.0:
        return math.nan
    return math.copysign(math.inf, math.copysign(1.0, a) * math.copysign(1.0, b))


def remainder(a: int, b: int) -> int:
    """The rest of a division that is cut off towards zero."""
    return a - b * math.trunc(a / b)


def to_integer(value: float, rounded: bool) -> int:
    if not math.isfinite(value):
        raise StructuredTextError(f"{value} to DINT")
    return in_range(round(value) if rounded else math.trunc(value))


def library(function: Any) -> Callable[..., float]:
    def compute(*arguments: float) -> float:
        with np.errstate(all="ignore"):
            return float(function(*arguments))

    return compute


BINARY: dict[tuple[str, str], tuple[str, Callable[[Any, Any], Any]]] = {
    ("LREAL", "+"): ("LREAL", lambda a, b: a + b),
    ("LREAL", "-"): ("LREAL", lambda a, b: a - b),
    ("LREAL", "*"): ("LREAL", lambda a, b: a * b),
    ("LREAL", "/"): ("LREAL", quotient),
    ("DINT", "+"): ("DINT", lambda a, b: in_range(a + b)),
    ("DINT", "MOD"): ("DINT", remainder),
    ("BOOL", "AND"): ("BOOL", lambda a, b: a and b),
    ("BOOL", "OR"): ("BOOL", lambda a, b: a or b),
}
for _type in ("LREAL", "DINT"):
    BINARY |= {
        (_type, "<"): ("BOOL", lambda a, b: a < b),
        (_type, "<="): ("BOOL", lambda a, b: a <= b),
        (_type, ">"): ("BOOL", lambda a, b: a > b),
        (_type, ">="): ("BOOL", lambda a, b: a >= b),
        (_type, "="): ("BOOL", lambda a, b: a == b),
        (_type, "<>"): ("BOOL", lambda a, b: a != b),
    }

REAL, TWO_REALS = ("LREAL",), ("LREAL", "LREAL")
FUNCTIONS: dict[str, tuple[tuple[str, ...], str, Callable[..., Any]]] = {
    "ABS": (REAL, "LREAL", math.fabs),
    "SQRT": (REAL, "LREAL", library(np.sqrt)),
    "TRUNC": (REAL, "DINT", lambda value: to_integer(value, False)),
    "LREAL_TO_DINT": (REAL, "DINT", lambda value: to_integer(value, True)),
    "DINT_TO_LREAL": (("DINT",), "LREAL", float),
    "EXP": (REAL, "LREAL", library(np.exp)),
    "LN": (REAL, "LREAL", library(np.log)),
    "SIN": (REAL, "LREAL", library(np.sin)),
    "COS": (REAL, "LREAL", library(np.cos)),
    "TAN": (REAL, "LREAL", library(np.tan)),
    "ASIN": (REAL, "LREAL", library(np.arcsin)),
    "ACOS": (REAL, "LREAL", library(np.arccos)),
    "ATAN": (REAL, "LREAL", library(np.arctan)),
    "ATAN2": (TWO_REALS, "LREAL", library(np.arctan2)),
    "EXPT": (TWO_REALS, "LREAL", library(np.power)),
}
