"""The names that a package publishes, read from its stub and loaded when they are used."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from clepsydra.base.errors import UnknownName


def published_names(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` for a package with a stub.

    The stub, ``__init__.pyi`` beside the package's file, declares once what is published, with its
    types, as lines ``from module import name as name``. A module that is called as a function is
    refused like an unknown name: what a package is made of stands beside what it publishes.
    A module pickles as its name: a function of a notebook that uses it goes to another process.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    file : str
        Its ``__file__``.
    """
    names = declared_names(Path(file).with_suffix(".pyi").read_text(encoding="utf-8"))

    class Pickled(ModuleType):
        def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
            return importlib.import_module, (self.__name__,)

    class Part(Pickled):
        def __call__(self, *given: object, **named: object) -> None:
            name = self.__name__.rpartition(".")[2]
            if name in names:
                raise UnknownName(f"cl.{name}", "a call", dir(self))
            raise UnknownName(package, name, names)

    class Package(Pickled):
        def __setattr__(self, name: str, value: object) -> None:
            if isinstance(value, ModuleType):  # one that has just been imported
                value.__class__ = Part
            super().__setattr__(name, value)

    def load(name: str) -> Any:
        if name not in names:
            # What Python itself looks for, __path__ and the like, is no misspelt name.
            if name.startswith("__"):
                raise AttributeError(f"module {package!r} has no attribute {name!r}")
            raise UnknownName(package, name, names)
        module = importlib.import_module(names[name])
        if not hasattr(module, name):  # a module of the interface, which is a name itself
            part = importlib.import_module(f"{names[name]}.{name}")
            part.__class__ = Part
            return part
        return getattr(module, name)

    sys.modules[package].__class__ = Package
    published = sorted(names)
    return load, lambda: [*published, "__version__"], published


def declared_names(stub: str) -> dict[str, str]:
    """Return the names that a stub declares, each to the module that has it.

    Examples
    --------
    >>> declared_names("from math import sqrt as sqrt")
    {'sqrt': 'math'}
    """
    return {
        alias.name: node.module
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom) and node.module is not None
        for alias in node.names
        if alias.asname == alias.name
    }
