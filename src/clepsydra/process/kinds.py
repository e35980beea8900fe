"""The kinds of element that a process file may contain: those of the files of `elements`."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from functools import cache
from types import ModuleType

from clepsydra.process import elements
from clepsydra.process.element import Element


@cache
def kinds() -> tuple[type[Element], ...]:
    """Return every kind, in the order in which a process lists its elements."""
    files = [f"{elements.__name__}.{each.name}" for each in pkgutil.iter_modules(elements.__path__)]
    found = [kind for file in files for kind in kinds_of(importlib.import_module(file))]
    return tuple(sorted(found, key=lambda kind: kind.place))


def kinds_of(module: ModuleType) -> list[type[Element]]:
    """Return the kinds that a module defines, without those that only others build on."""
    found = [
        value
        for value in dict.fromkeys(v for v in vars(module).values() if inspect.isclass(v))
        if issubclass(value, Element) and value.__module__ == module.__name__
    ]
    bases = {base for kind in found for base in kind.__mro__[1:]}
    return [kind for kind in found if not (kind in bases and _unfinished(kind))]


def _unfinished(kind: type[Element]) -> bool:
    return inspect.isabstract(kind) or not hasattr(kind, "kind")
