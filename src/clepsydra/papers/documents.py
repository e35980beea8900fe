"""The documents of the audit, in the order in which they are told."""

from __future__ import annotations

import importlib

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.papers.experiment import Document

#: Key of each document to the package that holds it; loaded when it is asked for.
PACKAGES = {
    "averaging-tank": "averaging_tank",
    "eight-tanks": "eight_tanks",
    "four-tank-variable-structure": "four_tank_variable_structure",
    "three-tanks": "three_tanks",
    "four-tank-laboratory": "four_tank_laboratory",
}


def load_document(key: str) -> Document:
    """Return a document with its experiments.

    Parameters
    ----------
    key : str
        See `PACKAGES`.

    Raises
    ------
    InputError
        There is no such document.

    Examples
    --------
    >>> load_document("three-tanks").key
    'three-tanks'
    """
    if key not in PACKAGES:
        raise InputError(
            "document",
            key,
            f"one of {', '.join(PACKAGES)}",
            suggestion(key, PACKAGES, "choose one of these"),
        )
    module = importlib.import_module(f"clepsydra.papers.{PACKAGES[key]}.document")
    document = module.DOCUMENT
    assert isinstance(document, Document) and document.key == key
    return document
