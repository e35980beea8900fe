"""Program units of Structured Text and what they declare."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from clepsydra.deploy.proof.text.tree import content, part, wrong
from clepsydra.deploy.proof.text.values import ZEROS, literal

if TYPE_CHECKING:
    from tree_sitter import Node

_UNITS = {
    "function_block_declaration": "FUNCTION_BLOCK",
    "function_declaration": "FUNCTION",
    "program_declaration": "PROGRAM",
}
_SECTIONS = ("var_input", "var_output", "var_block", "var_temp")
_QUIET = ("comment", "pragma")


@dataclass(frozen=True)
class Declared:
    """A declared variable.

    Parameters
    ----------
    section : str
        "VAR_INPUT", "VAR_OUTPUT", "VAR", "VAR CONSTANT", "VAR RETAIN" or "VAR_TEMP".
    type : str
        An elementary type, or the name of a function block in lower case.
    initial : object
        Its initial value, a list of an array; None of an instance.
    length : int
        Of an array, else 0.
    """

    section: str
    type: str
    initial: Any
    length: int = 0

    @property
    def is_instance(self) -> bool:
        """Whether it is an instance of a function block."""
        return self.type not in ZEROS


@dataclass(frozen=True)
class Unit:
    """A function block, a function, a program or the type of a structure.

    Parameters
    ----------
    kind : str
        "FUNCTION_BLOCK", "FUNCTION", "PROGRAM", or "STRUCT" for the type of a structure.
    name : str
    declared : dict
        Name in lower case to what was declared; of a function also what it returns.
    body : tuple of Node
        Its statements.
    """

    kind: str
    name: str
    declared: dict[str, Declared] = field(default_factory=dict)
    body: tuple[Node, ...] = ()


def units_of(root: Node) -> dict[str, Unit]:
    """Return the function blocks, functions and programs of a text, by name in lower case.

    Raises
    ------
    StructuredTextError
        Something else stands in the text, or a declaration is wrong.

    Examples
    --------
    See `Unit`.
    """
    found: dict[str, Unit] = {}
    for node in root.children:
        if node.type in (*_QUIET, "configuration_declaration"):
            continue
        if node.type == "type_declaration":
            units = tuple(_records(node))
        elif node.type in _UNITS:
            units = (_unit(node),)
        else:
            raise wrong(node, f"no meaning for {node.type}")
        for unit in units:
            if unit.name.lower() in found:
                raise wrong(node, f"{unit.name} is declared twice")
            found[unit.name.lower()] = unit
    return found


def _records(node: Node) -> Iterator[Unit]:
    """Yield the types of structures that are declared, each as a unit that gives its members."""
    for each in node.named_children:
        definition = each.child_by_field_name("definition")
        if definition is None or definition.type != "structure_type_inline":
            raise wrong(each, f"no meaning for {content(each)}")
        members = {}
        for field_node in definition.named_children:
            if field_node.type not in _QUIET:
                kind = content(part(field_node, "type")).upper()
                if kind not in ZEROS:
                    raise wrong(field_node, f"no meaning for a member of type {kind}")
                name = content(part(field_node, "name")).lower()
                if name in members:
                    raise wrong(field_node, f"{name} is declared twice")
                members[name] = Declared("VAR_OUTPUT", kind, ZEROS[kind])
        yield Unit("STRUCT", content(part(each, "name")), members)


def _unit(node: Node) -> Unit:
    declared: dict[str, Declared] = {}
    for child in node.named_children:
        if child.type in _SECTIONS:
            _declare(child, declared)
    body = tuple(
        child
        for child in node.children_by_field_name("body")
        if child.type not in ("empty_statement", *_QUIET)
    )
    known = {*_SECTIONS, *_QUIET, "empty_statement"}
    title = [part(node, "name")]
    if _UNITS[node.type] == "FUNCTION":
        title.append(part(node, "return_type"))
        kind = content(title[1]).upper()
        if kind not in ZEROS:
            raise wrong(node, f"no meaning for a function of {kind}")
        declared[content(title[0]).lower()] = Declared("VAR_TEMP", kind, ZEROS[kind])
    for child in node.named_children:
        if child.type not in known and child not in (*title, *body):
            raise wrong(child, f"no meaning for {child.type}")
    return Unit(_UNITS[node.type], content(title[0]), declared, body)


def _declare(section: Node, declared: dict[str, Declared]) -> None:
    keyword = section.children[0].type.upper()
    qualifiers = [
        content(qualifier).upper()
        for child in section.children
        if child.type == "var_qualifier_list"
        for qualifier in child.children
    ]
    known = {(), ("CONSTANT",), ("RETAIN",)} if keyword == "VAR" else {()}
    if tuple(qualifiers) not in known:
        raise wrong(section, f"no meaning for {keyword} {' '.join(qualifiers)}")
    for node in section.named_children:
        if node.type in ("var_qualifier_list", *_QUIET):
            continue
        if node.type != "variable_declaration":
            raise wrong(node, f"no meaning for {node.type}")
        names = [n for n in node.children_by_field_name("names") if n.type == "identifier"]
        for each in names:
            name = content(each).lower()
            if name in declared:
                raise wrong(node, f"{name} is declared twice")
            declared[name] = _variable(" ".join([keyword, *qualifiers]), node)


def _variable(section: str, node: Node) -> Declared:
    kind = part(node, "type")
    values = [
        child
        for child in node.children_by_field_name("initial_value")
        if child.type not in ("[", "]", ",")
    ]
    if kind.type == "array_type":
        return _array(section, node, kind, values)
    name = content(kind)
    if name.upper() in ZEROS:
        name = name.upper()
        initial = literal(values[0], name) if values else ZEROS[name]
        return Declared(section, name, initial)
    if kind.type != "identifier" or section not in ("VAR", "VAR_OUTPUT") or values:
        raise wrong(node, f"no meaning for {content(node)}")
    return Declared(section, name.lower(), None)


def _array(section: str, node: Node, kind: Node, values: list[Node]) -> Declared:
    name = content(part(kind, "element_type")).upper()
    if name not in ZEROS or section == "VAR_TEMP":
        raise wrong(node, f"no meaning for {content(node)}")
    bounds = part(kind, "range")
    low, high = (int(content(part(bounds, end))) for end in ("lower", "upper"))
    if low != 0:
        raise wrong(node, "arrays start at 0 here")
    entries: list[Any] = []
    for value in values:
        if value.type == "array_repetition":
            count = int(content(part(value, "count")))
            entries += [literal(value.named_children[1], name)] * count
        else:
            entries.append(literal(value, name))
    if not values:
        entries = [ZEROS[name]] * (high + 1)
    if len(entries) != high + 1:
        raise wrong(node, f"{len(entries)} values for {high + 1} entries")
    return Declared(section, name, entries, high + 1)
