"""`cl.audit`: the documents that Clepsydra was built from, number by number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.interface.shown import Answered, lifted
from clepsydra.papers import against_limit as beside
from clepsydra.papers import audit as inner

if TYPE_CHECKING:
    from clepsydra.base.section import Section


class Audit(Answered, inner.Audit):
    """Every printed number of the documents with its verdict: `rows`."""

    def answer(self, *, every: bool = False) -> Section:
        """Return how many of what, and on request every row that is not as printed."""
        from clepsydra.papers.answer import audit_answer

        return audit_answer(self, every=every)

    def report(self, path: str | Path) -> None:
        """Write a page with the reasons and the redrawn figures."""
        from clepsydra.papers.answer import page_text
        from clepsydra.report.page import write_page

        write_page(page_text(self), path)


def audit(
    documents: Sequence[str] = (),
    *,
    workers: int = 1,
    progress: Callable[[inner.AuditProgress], None] | None = None,
) -> Audit:
    """Run the experiments of five published documents and judge every printed number.

    Parameters
    ----------
    documents : sequence of str
        Keys of documents; all if left out.
    workers : int
        Processes at once.
    progress : callable, optional
        Takes how far it is.

    Raises
    ------
    InputError
        A document is unknown.
    """
    return lifted(Audit, inner.audit(documents, workers=workers, progress=progress))


class AgainstLimit(Answered, beside.AgainstLimit):
    """The documents' controllers and ours against the physical limit: `outcomes`."""

    def answer(self, *, every: bool = False) -> Section:
        """Return how near they come, and on request the table of each experiment."""
        from clepsydra.papers.limit_page import limit_answer

        return limit_answer(self, every=every)

    def report(self, path: str | Path) -> None:
        """Write a page in Markdown with the table of each experiment."""
        from clepsydra.papers.limit_page import page_text
        from clepsydra.report.page import write_page

        write_page(page_text(self), path)


def against_limit(
    documents: Sequence[str] = (),
    *,
    workers: int = 1,
    progress: Callable[[beside.ContestProgress], None] | None = None,
) -> AgainstLimit:
    """Run the controllers of five published documents, and ours, beside the best input there is.

    Parameters
    ----------
    documents : sequence of str
        Keys of documents; all if left out.
    workers : int
        Processes at once.
    progress : callable, optional
        Takes how far it is.

    Raises
    ------
    InputError
        A document is unknown.
    """
    found = beside.against_limit(documents, workers=workers, progress=progress)
    return lifted(AgainstLimit, found)
