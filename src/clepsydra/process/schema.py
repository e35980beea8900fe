"""A JSON Schema of process files, from which editors complete and check keys while one types."""

from __future__ import annotations

from typing import Any

from clepsydra.process import told
from clepsydra.process.declared import table_schema
from clepsydra.process.kinds import kinds
from clepsydra.process.reader import GENERAL_KEYS, REQUIRED_KEYS

#: What a table must have or fit, which it may leave to a variant.
_WHOLE = ("required", "allOf")


def process_schema() -> dict[str, Any]:
    """Return the schema of a process file.

    What a file with variants must have is not checked: a variant may bring it. A file with
    elements of its own may have other tables too.

    Examples
    --------
    >>> pump = process_schema()["properties"]["pumps"]["additionalProperties"]
    >>> pump["properties"]["lag"]["description"]
    'a time constant [s], above 0'
    """
    schemas = {kind: table_schema(kind) for kind in kinds()}
    parts, wholes = {}, {}
    for kind, schema in schemas.items():
        part = {key: value for key, value in schema.items() if key not in _WHOLE}
        whole = {key: value for key, value in schema.items() if key in _WHOLE}
        parts[kind.table] = told.by_name(kind.kind, part)
        wholes[kind.table] = {"additionalProperties": whole}
    properties = {**GENERAL_KEYS, **parts}
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Clepsydra process file",
        "type": "object",
        "properties": properties,
        "allOf": [
            {
                "if": {"not": {"required": ["variants"]}},
                "then": {"required": [*REQUIRED_KEYS], "properties": wholes},
            },
            {
                "if": {"not": {"required": ["elements"]}},
                "then": {"propertyNames": {"enum": [*properties]}},
            },
        ],
    }
