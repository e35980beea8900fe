"""What an editor is told of the keys of a file, in the words of JSON Schema."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from clepsydra.base.units import text_pattern

Schema = Mapping[str, Any]
#: A quantity as a file has it: text with a unit, or a number where it needs none.
QUANTITY: Schema = {"type": ["string", "number"]}


def written(unit: str, *, signed: bool = False) -> Schema:
    """Return the schema of a quantity without words, of any kind where no SI unit is given."""
    if not unit:
        return QUANTITY
    return {"type": "string", "pattern": text_pattern(unit, signed=signed, zero=True)}


def quantity(words: str, unit: str = "") -> dict[str, Any]:
    """Return the schema of a quantity, not below zero where its SI unit is known.

    >>> quantity("a level")
    {'description': 'a level', 'type': ['string', 'number']}
    >>> quantity("a level", "m")["description"]
    'a level [m]'
    """
    return {"description": f"{words} [{unit}]" if unit else words, **written(unit)}


def text(words: str) -> dict[str, Any]:
    """Return the schema of a text, as a name."""
    return {"description": words, "type": "string"}


def choice(words: str, choices: Sequence[str]) -> dict[str, Any]:
    """Return the schema of one of a few words."""
    return {"description": words, "enum": list(choices)}


def names(words: str) -> dict[str, Any]:
    """Return the schema of a list of names, at least one."""
    return {"description": words, "type": "array", "items": {"type": "string"}, "minItems": 1}


def quantities(words: str, count: int | None = None, unit: str = "") -> dict[str, Any]:
    """Return the schema of a list of quantities, of so many where a count is given."""
    each = written(unit)
    found = {"description": words, "type": "array", "items": each, "minItems": count or 1}
    return found if count is None else found | {"maxItems": count}


def pairs(words: str, *units: str) -> dict[str, Any]:
    """Return the schema of a list of pairs of quantities in two SI units."""
    each = {"type": "array", "items": [*map(written, units)], "minItems": 2, "maxItems": 2}
    return {"description": words, "type": "array", "items": each, "minItems": 1}


def by_name(words: str, each: Schema = QUANTITY) -> dict[str, Any]:
    """Return the schema of a table of names of one's own, each with a value."""
    return {"description": words, "type": "object", "additionalProperties": each}


def listed(words: str, each: Schema, least: int = 0) -> dict[str, Any]:
    """Return the schema of a list of tables."""
    return {"description": words, "type": "array", "items": each, "minItems": least}


def flag(words: str) -> dict[str, Any]:
    """Return the schema of what is true or false."""
    return {"description": words, "type": "boolean"}


def table(
    properties: Mapping[str, Schema], required: Sequence[str] = (), *checks: Schema
) -> dict[str, Any]:
    """Return the schema of a table of some keys and no others.

    >>> table({"select": choice("which", ["low", "high"])}, ["select"])["required"]
    ['select']
    """
    found = {"type": "object", "properties": dict(properties), "additionalProperties": False}
    found |= {"required": [*required]} if required else {}
    return found | ({"allOf": [*checks]} if checks else {})
