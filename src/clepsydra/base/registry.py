"""A registry: things of one kind by their names, each registered by the file that defines it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, Generic, TypeVar

from clepsydra.base.errors import InputError

T = TypeVar("T")
A = TypeVar("A")


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
            raise self._taken(name)
        things = {**self._things, name: thing}
        if (order := self._order) is not None:
            things = dict(sorted(things.items(), key=lambda item: order(item[1])))
        self._things = things
        return thing

    def _taken(self, name: str) -> InputError:
        return InputError(
            self._package, name, "a name that no other one has", "rename one of the two"
        )

    @cached_property
    def _files(self) -> dict[str, Path]:
        """The modules of the folder, each with its file."""
        return {
            f"{self._package}.{module.name}": Path(folder, f"{module.name}.py")
            for folder in import_module(self._package).__path__
            for module in iter_modules([folder])
            if not module.ispkg
        }

    def _all(self) -> dict[str, T]:
        if not self._imported:
            self._imported = True
            for module in self._files:
                import_module(module)
        return self._things

    def __getitem__(self, name: str) -> T:
        return self._all()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())


class AnnouncedRegistry(Registry[T], Generic[T, A]):
    r"""One whose files announce in their text what they define; asked for, a file comes alone.

    Parameters
    ----------
    package : str
        As of `Registry`.
    order : callable
        The key by which things and announcements are sorted.
    announced : callable
        Takes the text of a file and returns the names that it announces, each with what is said
        of it there.

    Examples
    --------
    The classes of a folder that are registries, by the length of their names:

    >>> import re
    >>> def announced(text):
    ...     return {name: name for name in re.findall(r"class (\w*Registry)\(", text)}
    >>> known = AnnouncedRegistry[str, str]("clepsydra.base", len, announced)
    >>> known.add("OwnRegistry", "OwnRegistry"), list(known)
    ('OwnRegistry', ['Registry', 'OwnRegistry', 'AnnouncedRegistry'])
    """

    def __init__(
        self,
        package: str,
        order: Callable[[T | A], Any],
        announced: Callable[[str], Mapping[str, A]],
    ) -> None:
        super().__init__(package, order)
        self._place, self._announced_in = order, announced

    def add(self, name: str, thing: T, module: str = "") -> T:
        """Register a thing by its name and return it; no second one by that name is taken.

        Parameters
        ----------
        module : str
            The one that registers it: a name that is announced is that of its own file.
        """
        if name in self._announced and self._announced[name][0] != module:
            raise self._taken(name)
        return super().add(name, thing)

    @cached_property
    def _announced(self) -> dict[str, tuple[str, A]]:
        """What is announced, each with its module."""
        return {
            name: (module, said)
            for module, file in self._files.items()
            for name, said in self._announced_in(file.read_text(encoding="utf-8")).items()
        }

    def is_own(self, name: str) -> bool:
        """Return whether a file of the folder defines it, and nobody else."""
        return name in self._announced

    def known(self) -> dict[str, T | A]:
        """Return what is known of each without importing a file: itself, or its announcement."""
        said: dict[str, T | A] = {name: each for name, (_, each) in self._announced.items()}
        said |= self._things
        return dict(sorted(said.items(), key=lambda item: self._place(item[1])))

    def __getitem__(self, name: str) -> T:
        if name not in self._things and name in self._announced:
            import_module(self._announced[name][0])
        return self._things[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.known())

    def __len__(self) -> int:
        return len(self._announced.keys() | self._things.keys())
