"""The processes that come with Clepsydra."""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable


def catalogue_names() -> list[str]:
    """Return the names of the processes of the catalogue, sorted.

    Examples
    --------
    >>> catalogue_names()[:3]
    ['averaging-tank', 'eight-tanks', 'equalisation-tank']
    """
    files = resources.files("clepsydra.process.catalogue").iterdir()
    return sorted(file.name[:-5] for file in files if file.name.endswith(".toml"))


def catalogue_file(name: str) -> Traversable:
    """Return the file of a process of the catalogue, to read or to copy."""
    return resources.files("clepsydra.process.catalogue") / f"{name}.toml"
