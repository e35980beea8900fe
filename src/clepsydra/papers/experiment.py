"""A document and its experiments."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

from clepsydra.papers.figure import Figure
from clepsydra.papers.row import Row


@dataclass(frozen=True)
class Findings:
    """What an experiment found.

    Parameters
    ----------
    rows : tuple of Row
    figures : tuple of Figure
    """

    rows: tuple[Row, ...]
    figures: tuple[Figure, ...] = ()


@dataclass(frozen=True)
class Experiment:
    """A part of a document that can be run alone.

    Parameters
    ----------
    name : str
        Key within the document: "closed-loop".
    title : str
    run : callable
        () -> Findings. It lives in a module, so that another process can call it.

    Examples
    --------
    >>> Experiment("nothing", "Nothing", lambda: Findings(())).findings("three-tanks").rows
    ()
    """

    name: str
    title: str
    run: Callable[[], Findings]

    def findings(self, document: str) -> Findings:
        """Run it, and return its rows with the keys of document and experiment."""
        found = self.run()
        rows = tuple(
            dataclasses.replace(row, document=document, experiment=self.name) for row in found.rows
        )
        return Findings(rows, found.figures)


@dataclass(frozen=True)
class Document:
    """A published document.

    Parameters
    ----------
    key : str
        "averaging-tank"
    title : str
        Of the document.
    reference : str
        Authors, year, and where it was published.
    experiments : tuple of Experiment
    """

    key: str
    title: str
    reference: str
    experiments: tuple[Experiment, ...]
