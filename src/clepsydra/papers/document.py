"""A document and its experiments: a folder here, which registers itself by lying here."""

from __future__ import annotations

import importlib
import pkgutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

from clepsydra import papers
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.papers.figure import Figure
from clepsydra.papers.row import Row

#: A function that keeps what it found.
_Keeping = type(cache(len))
#: What an experiment returns or yields, in the order of the document.
Found = Iterable[Row | Figure]


class Findings(NamedTuple):
    """What an experiment found."""

    rows: tuple[Row, ...]
    figures: tuple[Figure, ...] = ()


@dataclass(frozen=True)
class Document:
    """A published document.

    Parameters
    ----------
    package : str
        The folder, in which each experiment is a module with a function ``run() -> Found``, and
        ``printed.csv`` the table of what is printed.
    number : int
        Documents are told in this order.
    title : str
        Of the document.
    reference : str
        Authors, year, and where it was published.
    experiments : mapping
        Name of each, "closed-loop" for the module closed_loop, to its title.
    headlines : sequence of (place, name)
        Rows of the claims by which its abstract and its conclusions stand.
    """

    package: str
    number: int
    title: str
    reference: str
    experiments: Mapping[str, str]
    headlines: Sequence[tuple[str, str]] = ()

    @property
    def key(self) -> str:
        """How the command line calls it: "averaging-tank"."""
        return self.package.rpartition(".")[2].replace("_", "-")

    def findings(self, experiment: str) -> Findings:
        """Run an experiment, and return its rows with the keys of document and experiment."""
        module = importlib.import_module(f"{self.package}.{experiment.replace('-', '_')}")
        found = tuple(module.run())
        rows = (each for each in found if isinstance(each, Row))
        return Findings(
            tuple(replace(row, document=self.key, experiment=experiment) for row in rows),
            tuple(each for each in found if isinstance(each, Figure)),
        )

    def forget(self) -> None:
        """Let go of the runs that its modules keep, which come to a gigabyte."""
        modules = [each for name, each in sys.modules.items() if name.startswith(self.package)]
        for item in (item for module in modules for item in vars(module).values()):
            if isinstance(item, _Keeping) and item.__module__.startswith(self.package):
                item.cache_clear()


def documents() -> dict[str, Document]:
    """Return every document by its key: the ``DOCUMENT`` of each folder of this package.

    Examples
    --------
    >>> list(documents())[:2]
    ['averaging-tank', 'eight-tanks']
    """
    folders = [each.name for each in pkgutil.iter_modules(papers.__path__) if each.ispkg]
    found = [importlib.import_module(f"{papers.__name__}.{name}").DOCUMENT for name in folders]
    return {each.key: each for each in sorted(found, key=lambda document: document.number)}


def load_document(key: str) -> Document:
    """Return a document by its key; an unknown one is an InputError."""
    known = documents()
    if key not in known:
        expected, remedy = f"one of {', '.join(known)}", "choose one of these"
        raise InputError("document", key, expected, suggestion(key, known, remedy))
    return known[key]
