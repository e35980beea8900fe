"""A JSON Schema of lesson files, from which editors complete and check keys while one types."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

from clepsydra.laboratory.lessons.lesson import Lesson
from clepsydra.process.declared import table_schema
from clepsydra.studies.file.controller_reader import controller_schema


def lesson_schema() -> dict[str, Any]:
    """Return the schema of a lesson file.

    Examples
    --------
    >>> task = lesson_schema()["properties"]["tasks"]["items"]
    >>> task["required"], task["properties"]["noise"]["description"]
    (['title'], 'whether it is noisy')
    """
    found = deepcopy(table_schema(Lesson))
    own = found["properties"]
    for way in (own, own["setups"]["additionalProperties"]["properties"]):
        way["controllers"]["additionalProperties"] = controller_schema(tuned=False)
    schema = "http://json-schema.org/draft-07/schema#"
    return {"$schema": schema, "title": "Clepsydra lesson file", **found}
