"""Lists of names that load their module only when they are used."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any


def lazy_names(
    package: str, names: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` for a package's list of names.

    Parameters
    ----------
    package : str
        The package that publishes the names, its ``__name__``.
    names : mapping
        Published name to the module that defines it.

    Examples
    --------
    >>> load, listing, published = lazy_names("example", {"sqrt": "math"})
    >>> load("sqrt")(9.0), listing(), published
    (3.0, ['sqrt'], ['sqrt'])
    """

    def load(name: str) -> Any:
        if name not in names:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(names[name]), name)

    published = sorted(names)
    return load, lambda: published, published
