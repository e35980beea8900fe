"""Statements of Structured Text as statements of Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from clepsydra.deploy.proof.text.declarations import Declared, Unit
from clepsydra.deploy.proof.text.expressions import Expressions, Typed
from clepsydra.deploy.proof.text.operations import agreed_turns
from clepsydra.deploy.proof.text.tree import content, part, wrong

if TYPE_CHECKING:
    from tree_sitter import Node

_PASSIVE = ("empty_statement", "comment", "pragma")


def compiled(
    unit: Unit,
    units: Mapping[str, Unit],
    functions: Mapping[str, Callable[..., Any]],
    *,
    one_turn: bool = True,
) -> Callable[..., Any]:
    """Return a function of Python that runs the body of a unit once on its memory.

    Of a function it takes the inputs, in order, and returns what that returns. `functions` are
    those that stand before the unit, by name in lower case; `one_turn` is as of `StructuredText`.

    What the body reads is loaded from the memory into local variables, and what it writes is
    stored at its end. A temporary variable is local only, so that one which is read before it
    was written is an error of Python.

    Raises
    ------
    StructuredTextError
        A name is unknown, a type does not fit, or a statement has no meaning here.

    Examples
    --------
    >>> from clepsydra.deploy.proof.text.declarations import units_of
    >>> from clepsydra.deploy.proof.text.tree import parse
    >>> text = "PROGRAM p VAR n : DINT; END_VAR n := n + 1; END_PROGRAM"
    >>> memory = {"n": 4}
    >>> compiled(units_of(parse(text))["p"], {}, {})(memory)
    >>> memory
    {'n': 5}
    """
    return _Body(unit, units, functions, one_turn).function()


class _Body(Expressions):
    def __init__(
        self,
        unit: Unit,
        units: Mapping[str, Unit],
        functions: Mapping[str, Callable[..., Any]],
        one_turn: bool,
    ) -> None:
        super().__init__(unit, units, functions)
        self.namespace["agreed_turns"], self._one_turn = agreed_turns, one_turn
        self._written: set[str] = set()

    def function(self) -> Callable[..., Any]:
        unit = self._unit
        body = self._sequence(unit.body)
        kept = [n for n, d in unit.declared.items() if d.section != "VAR_TEMP"]
        if unit.kind == "FUNCTION":
            heading = f"def run({', '.join(f'v_{name}' for name in kept)}):"
            whole = [*body, f"return v_{unit.name.lower()}"]
        else:
            heading, used = "def run(memory):", self.read | self._written
            first = [f"v_{name} = memory['{name}']" for name in kept if name in used]
            last = [f"memory['{name}'] = v_{name}" for name in kept if name in self._written]
            whole = [*first, *body, *last]
        exec(
            compile("\n".join([heading, *_inside(whole)]), f"<{unit.name}>", "exec"), self.namespace
        )
        run: Callable[..., Any] = self.namespace["run"]
        return run

    def _sequence(self, nodes: Sequence[Node]) -> list[str]:
        kinds = {
            "assignment_statement": self._assignment,
            "if_statement": self._if,
            "for_statement": self._for,
            "while_statement": self._while,
            "invocation_statement": self._invocation,
        }
        statements: list[str] = []
        for node in nodes:
            if node.type in _PASSIVE:
                continue
            if node.type not in kinds:
                raise wrong(node, f"no meaning for {node.type}")
            statements += kinds[node.type](node)
        return statements

    def _assignment(self, node: Node) -> list[str]:
        left, right = part(node, "left"), part(node, "right")
        if left.type == "member_access_expression":
            return self._to_member(node, left, right)
        single = left.type == "identifier"
        if not single and left.type != "index_expression":
            raise wrong(node, f"no meaning for a value of {content(left)}")
        name = content(left if single else part(left, "object")).lower()
        declared = self._writable(node, name)
        value = self.of_type(right, declared.type, name)
        if single:
            return self._to_variable(node, name, declared, value)
        return [f"{self.entry(left, name)} = {value}"]

    def _to_variable(self, node: Node, name: str, declared: Declared, value: str) -> list[str]:
        """Translate what assigns a whole variable of this unit."""
        if self.is_record(declared):
            return [f"{self.variable(name)}.state.update({value}.state)"]
        if declared.length or declared.is_instance:
            raise wrong(node, f"{name} is no single value")
        self._written.add(name)
        return [f"v_{name} = {value}"]

    def _to_member(self, node: Node, left: Node, right: Node) -> list[str]:
        """Translate what assigns a member of a structure of this unit."""
        name = content(part(left, "object")).lower()
        if not self.is_record(self._writable(node, name)):
            raise wrong(node, f"no meaning for a value of {content(left)}")
        member = self.expression(left)
        value = self.of_type(right, member.type, content(left))
        return [f"{member.code} = {value}"]

    def _writable(self, node: Node, name: str) -> Declared:
        declared = self.known(node, name)
        if declared.section in ("VAR_INPUT", "VAR CONSTANT") or name in self.counters:
            raise wrong(node, f"{name} may not be written")
        return declared

    def _if(self, node: Node) -> list[str]:
        lines = self._branch("if", node, "consequence")
        for child in node.children:
            if child.type == "elsif_clause":
                lines += self._branch("elif", child, "body")
            elif child.type == "else_clause":
                body = self._sequence(child.children_by_field_name("body"))
                lines += ["else:", *_inside(body)]
        return lines

    def _branch(self, word: str, clause: Node, body: str) -> list[str]:
        condition = self.of_type(part(clause, "condition"), "BOOL", "a condition")
        inside = self._sequence(clause.children_by_field_name(body))
        return [f"{word} {condition}:", *_inside(inside)]

    def _for(self, node: Node) -> list[str]:
        name = content(part(node, "control")).lower()
        declared = self._writable(node, name)
        if declared.type != "DINT" or declared.length:
            raise wrong(node, "a FOR counts with DINT")
        if node.child_by_field_name("step") is not None:
            raise wrong(node, "no BY expected")
        start, end = (self.expression(part(node, end)) for end in ("start", "end"))
        if (start.type, end.type) != ("DINT", "DINT"):
            raise wrong(node, f"a FOR from {start.type} to {end.type}, expected DINT")
        self._written.add(name)
        bounds = (start.bounds[0], end.bounds[1]) if start.bounds and end.bounds else None
        self.counters[name] = Typed("DINT", self.variable(name), bounds)
        body = self._sequence(node.children_by_field_name("body"))
        del self.counters[name]
        ends = f"{start.code}, {end.code}"
        turns = f"range({ends} + 1)" if self._one_turn else f"agreed_turns({ends})"
        return [f"for v_{name} in {turns}:", *_inside(body)]

    def _while(self, node: Node) -> list[str]:
        return self._branch("while", node, "body")

    def _invocation(self, node: Node) -> list[str]:
        call = node.named_children[0]
        name = content(part(call, "function")).lower()
        unit = self.unit_of(node, name)
        instance = self.variable(name)
        before, after = list[str](), list[str]()
        for argument in part(call, "arguments").named_children:
            if argument.type != "named_argument":
                raise wrong(argument, "inputs are given by name")
            given = content(part(argument, "name")).lower()
            told = b"=>" in (argument.text or b"")
            port = "output" if told else "input"
            declared = unit.declared.get(given)
            if declared is None or declared.section != f"VAR_{port.upper()}":
                raise wrong(argument, f"{given} is no {port} of {unit.name}")
            place = f"{instance}.state[{given!r}]"
            value = part(argument, "value")
            if told:
                target = content(value).lower()
                taken = self._writable(argument, target)
                if value.type != "identifier" or taken.type != declared.type:
                    raise wrong(argument, f"{content(value)} takes no {declared.type}")
                after += self._to_variable(argument, target, taken, place)
            else:
                code = self.of_type(value, declared.type, given)
                before.append(f"{place} = {code}")
        return [*before, f"{instance}.run()", *after]


def _inside(lines: Sequence[str]) -> list[str]:
    return [f" {line}" for line in lines or ["pass"]]
