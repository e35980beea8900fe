"""As much of JSON Schema, draft 7, as the schemas for editors use: what of a value one refuses."""

import re
from collections.abc import Iterator
from typing import Any

TYPES: dict[str, tuple[type, ...]] = {
    "string": (str,),
    "number": (int, float),
    "integer": (int,),
    "boolean": (bool,),
    "object": (dict,),
    "array": (list,),
}
_SILENT = {"$schema", "title", "description"}


def faults(value: Any, schema: dict[str, Any], place: str = "") -> Iterator[str]:
    """Yield what of a value a schema refuses, with its place."""
    for word in schema.keys() - _SILENT:
        yield from _RULES[word](value, schema[word], schema, place)


def _type(value, types, schema, place):
    types = [types] if isinstance(types, str) else types
    kinds = {kind for name in types for kind in TYPES[name]}
    if not isinstance(value, tuple(kinds)) or (isinstance(value, bool) and bool not in kinds):
        yield f"{place}: {value!r} is no {' or '.join(types)}"


def _properties(value, known, schema, place):
    if isinstance(value, dict):
        for key in value.keys() & known.keys():
            yield from faults(value[key], known[key], f"{place}.{key}")


def _additional(value, other, schema, place):
    if isinstance(value, dict):
        for key in value.keys() - schema.get("properties", {}).keys():
            if other is False:
                yield f"{place}.{key}: unknown"
            else:
                yield from faults(value[key], other, f"{place}.{key}")


def _required(value, keys, schema, place):
    if isinstance(value, dict):
        yield from (f"{place}: no {key}" for key in keys if key not in value)


def _dependencies(value, wanted, schema, place):
    for key in wanted.keys() & (value.keys() if isinstance(value, dict) else ()):
        yield from _required(value, wanted[key], schema, place)


def _names(value, names, schema, place):
    for key in value if isinstance(value, dict) else ():
        yield from faults(key, names, f"{place}.{key}")


def _items(value, each, schema, place):
    for number, entry in enumerate(value if isinstance(value, list) else ()):
        one = each[number] if isinstance(each, list) and number < len(each) else each
        yield from faults(entry, one if isinstance(one, dict) else {}, f"{place}[{number}]")


def _length(value, least, most, place):
    if isinstance(value, list) and not least <= len(value) <= most:
        yield f"{place}: {len(value)} entries"


def _if(value, condition, schema, place):
    then = schema.get("else" if any(faults(value, condition)) else "then", {})
    yield from faults(value, then, place)


def _of(value, schemas, place, wanted):
    found = [list(faults(value, each, place)) for each in schemas]
    if not wanted(sum(not each for each in found)):
        yield f"{place}: fits {sum(not each for each in found)} of {found}"


_RULES: dict[str, Any] = {
    "type": _type,
    "enum": lambda v, known, s, p: [] if v in known else [f"{p}: {v!r} is none of {known}"],
    "const": lambda v, known, s, p: [] if v == known else [f"{p}: {v!r} is not {known!r}"],
    "pattern": lambda v, text, s, p: [f"{p}: {v!r} fits no {text}"] if _misfits(v, text) else [],
    "minimum": lambda v, low, s, p: [f"{p}: {v} < {low}"] if _is_below(v, low) else [],
    "maximum": lambda v, high, s, p: [f"{p}: {v} > {high}"] if _is_below(high, v) else [],
    "exclusiveMinimum": lambda v, low, s, p: (
        [f"{p}: {v} <= {low}"] if v == low or _is_below(v, low) else []
    ),
    "properties": _properties,
    "additionalProperties": _additional,
    "required": _required,
    "dependencies": _dependencies,
    "propertyNames": _names,
    "items": _items,
    "minItems": lambda v, least, s, p: _length(v, least, float("inf"), p),
    "maxItems": lambda v, most, s, p: _length(v, 0, most, p),
    "if": _if,
    "then": lambda *_: [],
    "else": lambda *_: [],
    "not": lambda v, no, s, p: [] if any(faults(v, no)) else [f"{p}: fits {no}"],
    "allOf": lambda v, each, s, p: (fault for one in each for fault in faults(v, one, p)),
    "anyOf": lambda v, each, s, p: _of(v, each, p, lambda fits: fits >= 1),
    "oneOf": lambda v, each, s, p: _of(v, each, p, lambda fits: fits == 1),
}


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _is_below(value, low):
    return _is_number(value) and _is_number(low) and value < low


def _misfits(value, text):
    return isinstance(value, str) and not re.search(text, value, re.ASCII)
