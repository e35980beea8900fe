"""A registry: things of one kind by their names, each registered by the file that defines it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, TypeVar

from clepsydra.base.errors import InputError

T = TypeVar("T")


class Registry(Mapping[str, T]):
    """The things of one kind, by name; whoever asks first has the files of a folder imported.

    A file that is there registers what it defines as it is imported, so that no list elsewhere
    names it. What registers from outside of the folder, a test or a user's module, stands beside.

    Parameters
    ----------
    package : str
        The folder: its modules are imported, those of folders below it are not.
    order : callable, optional
        The key by which the things are sorted; as they came without.

    Examples
    --------
    >>> shapes = Registry[int]("clepsydra.base", order=lambda corners: corners)
    >>> shapes.add("square", 4), shapes.add("triangle", 3)
    (4, 3)
    >>> list(shapes), shapes["square"]
    (['triangle', 'square'], 4)
    >>> shapes.add("square", 5)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: clepsydra.base: got 'square', expected a name that no other \
one has; rename one of the two.
    """

    def __init__(self, package: str, order: Callable[[T], Any] | None = None) -> None:
        self._package, self._order = package, order
        self._things: dict[str, T] = {}
        self._imported = False

    def add(self, name: str, thing: T) -> T:
        """Register a thing by its name and return it; no second one by that name is taken."""
        if name in self._things:
            raise InputError(
                self._package, name, "a name that no other one has", "rename one of the two"
            )
        things = {**self._things, name: thing}
        if (order := self._order) is not None:
            things = dict(sorted(things.items(), key=lambda item: order(item[1])))
        self._things = things
        return thing

    def _all(self) -> dict[str, T]:
        if not self._imported:
            self._imported = True
            for module in iter_modules(import_module(self._package).__path__):
                if not module.ispkg:
                    import_module(f"{self._package}.{module.name}")
        return self._things

    def __getitem__(self, name: str) -> T:
        return self._all()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())
