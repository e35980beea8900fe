"""What the fields of an element or a vessel declare, and how a table of a file fills them.

Beside quantities (`clepsydra.base.quantity`) a field may hold the name of another element, a
choice, a flag, or a part that several keys describe.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from typing import Any

from clepsydra.base.quantity import Quantity, declared
from clepsydra.process.table_reader import TableReader

#: The key that has the name of its field, among those that are required.
OWN = ""
#: The key of an element's tag in the plant's control system.
TAG = "tag"
_TAG_TOLD = {"description": "its name in the plant's control system", "type": "string"}
#: Takes the table, the key, and the values of the fields read so far.
Read = Callable[["TableReader", str, Mapping[str, Any]], Any]
#: What an editor is told of a key, or of each of several, in the words of JSON Schema.
Schema = Mapping[str, Any]
Told = Mapping[str, Schema]


class DeclaredKeys:
    """The keys that the fields of a class declare, as an attribute of the class."""

    def __get__(self, instance: object, owner: type) -> tuple[str, ...]:
        """Return them, with the tag of what may have one."""
        if not is_dataclass(owner):
            raise AttributeError("keys")
        return (*keys_of(owner), *((TAG,) if getattr(owner, "tagged", False) else ()))


@dataclass(frozen=True)
class Part:
    """What a field holds that is no quantity.

    Parameters
    ----------
    told : mapping
        The keys of a file that it knows, each with what an editor is told of it in the words of
        JSON Schema; the name of the field where empty.
    fills : bool
        It returns a dictionary, which fills the fields of its names.
    wanted : str
        The kind that the element must have that it names, see `Connection`.
    carries_flow : bool
        Liquid runs to or from it.
    schema : mapping
        What an editor is told of the key that has the name of the field.
    required : tuple of str
        Those of its keys that a table must have.
    checks : tuple of mapping
        Further schemas that a table must fit.
    """

    read: Read
    told: Told = field(default_factory=dict)
    fills: bool = False
    wanted: str = ""
    carries_flow: bool = True
    schema: Schema = field(default_factory=dict)
    required: tuple[str, ...] = ()
    checks: tuple[Schema, ...] = ()

    def properties(self, name: str) -> Told:
        """Return its keys and what is told of each, for a field of a name."""
        return self.told or {name: self.schema}


def part(
    read: Read,
    told: Told | None = None,
    *,
    default: Any = MISSING,
    fills: bool = False,
    required: Sequence[str] = (),
    checks: Sequence[Schema] = (),
    **schema: Any,
) -> Any:
    """Return a field that is read from several keys, or in a way of its own; all as in `Part`."""
    made = Part(
        read, told or {}, fills, schema=schema, required=tuple(required), checks=tuple(checks)
    )
    return field(default=default, metadata={"declared": made})


def filled() -> Any:
    """Return a field that another one fills."""
    return field(metadata={"filled": True})


def link(expected: str, wanted: str, *, optional: bool = False, carries_flow: bool = True) -> Any:
    """Return a field that holds the name of another element, see `Connection`."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
        if optional and not table.has(key):
            return ""
        name = table.name(key, expected)
        if optional and not name:
            raise table.wrong(key, expected, "leave the key out for outside the plant")
        return name

    made = Part(
        read,
        wanted=wanted,
        carries_flow=carries_flow,
        schema={"type": "string", "description": expected},
        required=() if optional else (OWN,),
    )
    return field(metadata={"declared": made})


def flag(*, default: bool, words: str = "") -> Any:
    """Return a field that is true or false; words say what, for editors."""
    read: Read = lambda table, key, known: table.flag(key, default=default)  # noqa: E731
    described: dict[str, Any] = {"description": words} if words else {}
    return part(read, default=default, type="boolean", **described)


def choice(choices: Sequence[str], default: str = "", words: str = "") -> Any:
    """Return a field that holds one of a few words, the default where the file does not say.

    Parameters
    ----------
    default : str
        The first of them where it is empty.
    words : str
        What it says, for editors.
    """
    usual = default or choices[0]
    read: Read = lambda table, key, known: table.choice(key, choices, usual)  # noqa: E731
    described: dict[str, Any] = {"description": words} if words else {}
    return part(read, default=usual, enum=list(choices), **described)


def keys_of(owner: type) -> tuple[str, ...]:
    """Return the keys that a file may give to fill the fields, in their order."""
    found: dict[str, None] = {}
    for name, each in declared(owner).items():
        found |= dict.fromkeys(each.properties(name) if isinstance(each, Part) else (name,))
    return tuple(found)


def table_schema(owner: type) -> dict[str, Any]:
    """Return the JSON Schema of a table that fills the fields of a class.

    Examples
    --------
    >>> from clepsydra.process.elements.linear_outlet import LinearOutlet
    >>> table_schema(LinearOutlet)["required"]
    ['source', 'destination', 'coefficient']
    """
    defaults = {f.name: f.default for f in fields(owner)}
    properties: dict[str, Any] = {key: {} for key in getattr(owner, "keys", keys_of(owner))}
    properties |= {TAG: _TAG_TOLD} if TAG in properties else {}
    required: list[str] = []
    checks: list[Schema] = []
    for name, each in declared(owner).items():
        if isinstance(each, Part):
            for key, told in each.properties(name).items():
                properties[key] = properties[key] or dict(told)
            required += [name if key == OWN else key for key in each.required]
            checks += each.checks
            continue
        properties[name] = each.schema(defaults[name])
        if each.required or defaults[name] is MISSING:
            if each.needs:
                checks.append({"dependencies": {each.needs: [name]}})
            elif each.unless:
                checks.append({"anyOf": [{"required": [name]}, {"required": [each.unless]}]})
            else:
                required.append(name)
    found = {"type": "object", "properties": properties, "additionalProperties": False}
    return (
        found | ({"required": required} if required else {}) | ({"allOf": checks} if checks else {})
    )


def undeclared(owner: type) -> list[str]:
    """Return the fields beside `name` that must be given and that no declaration fills."""
    return [
        each.name
        for each in fields(owner)
        if each.name != "name"
        and not each.metadata
        and each.default is each.default_factory is MISSING
    ]


def read_fields(owner: type, table: TableReader, **context: Any) -> dict[str, Any]:
    """Return the value of every declared field that the table gives.

    Quantities come last, since their units and bounds may depend on the others. What reads a part
    knows the parts before it, and the context.
    """
    defaults = {f.name: f.default for f in fields(owner)}
    found: dict[str, Any] = {}
    known = ChainMap(found, context)
    ordered = sorted(declared(owner).items(), key=lambda item: isinstance(item[1], Quantity))
    for name, each in ordered:
        if isinstance(each, Part):
            value = each.read(table, name, known)
            found |= value if each.fills else {name: value}
        elif table.has(name) or _applies(each, table):
            found[name] = table.declared(each, known, MISSING if each.required else defaults[name])
        elif defaults[name] is MISSING:
            found[name] = None
    return found


def _applies(quantity: Quantity, table: TableReader) -> bool:
    """Whether a quantity has a meaning beside the other keys of a table."""
    return (not quantity.needs or table.has(quantity.needs)) and not table.has(quantity.unless)
