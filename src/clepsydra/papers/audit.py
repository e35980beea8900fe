"""The audit: every experiment of the documents run, every printed number judged."""

from __future__ import annotations

import multiprocessing
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass

from clepsydra.papers.documents import PACKAGES, load_document
from clepsydra.papers.experiment import Document, Experiment, Findings
from clepsydra.papers.figure import Figure
from clepsydra.papers.row import COUNTED, VERDICTS, Row


@dataclass(frozen=True)
class AuditProgress:
    """How far an audit is.

    Parameters
    ----------
    done, of : int
        Experiments.
    name : str
        The one that ended last.
    """

    done: int
    of: int
    name: str


@dataclass(frozen=True)
class ExperimentAudit:
    """An experiment with what it found."""

    experiment: Experiment
    rows: tuple[Row, ...]
    figures: tuple[Figure, ...]


@dataclass(frozen=True)
class DocumentAudit:
    """A document with what its experiments found.

    Parameters
    ----------
    document : Document
    experiments : tuple of ExperimentAudit
        In the order of the document.
    """

    document: Document
    experiments: tuple[ExperimentAudit, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows."""
        return tuple(row for each in self.experiments for row in each.rows)

    @property
    def counts(self) -> dict[str, int]:
        """How often each verdict was given, in the order of `VERDICTS`."""
        counted = Counter(row.verdict for row in self.rows)
        return {verdict: counted[verdict] for verdict in VERDICTS}


@dataclass(frozen=True)
class Audit:
    """All that was audited.

    Parameters
    ----------
    documents : tuple of DocumentAudit
    """

    documents: tuple[DocumentAudit, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows of all documents."""
        return tuple(row for document in self.documents for row in document.rows)

    @property
    def counts(self) -> dict[str, int]:
        """How often each verdict was given."""
        counted = Counter(row.verdict for row in self.rows)
        return {verdict: counted[verdict] for verdict in VERDICTS}

    @property
    def summary(self) -> str:
        """The result in two sentences."""
        counts = self.counts
        claims = counts["claim holds"] + counts["claim fails"]
        numbers = sum(counts[verdict] for verdict in COUNTED) - claims
        return (
            f"Of {numbers} printed numbers and formulas {counts['reproduced']} are reproduced, "
            f"{counts['misprint']} are misprints, and {counts['not reproducible']} cannot be "
            f"reproduced; of {claims} claims {counts['claim holds']} hold. Outside the count stand "
            f"{counts['consistent']} rows that are consistent with what they were solved from, "
            f"{counts['damaged text']} that the text's conversion seems to have damaged, and "
            f"{counts['remark']} remarks of ours."
        )


def audit(
    documents: Sequence[str] = (),
    *,
    workers: int = 1,
    progress: Callable[[AuditProgress], None] | None = None,
) -> Audit:
    """Run the experiments of documents and judge every printed number and claim.

    Parameters
    ----------
    documents : sequence of str
        Keys; all if left out, each once.
    workers : int
        Processes that share the experiments; with more than one, guard a script's start by
        ``if __name__ == "__main__"``.
    progress : callable, optional
        Called after each experiment.

    Raises
    ------
    InputError
        There is no such document.

    Examples
    --------
    >>> from clepsydra.papers.documents import load_document
    >>> [document.key for document in map(load_document, ["three-tanks"])]
    ['three-tanks']
    """
    loaded = [load_document(key) for key in dict.fromkeys(documents or PACKAGES)]
    tasks = [(d.key, place) for d in loaded for place in range(len(d.experiments))]
    found: dict[tuple[str, int], Findings] = {}
    with _results(tasks, min(workers, len(tasks))) as results:
        for key, place, findings in results:
            found[key, place] = findings
            if progress is not None:
                name = f"{key}: {load_document(key).experiments[place].title}"
                progress(AuditProgress(len(found), len(tasks), name))
    return Audit(tuple(_document_audit(document, found) for document in loaded))


def _document_audit(document: Document, found: dict[tuple[str, int], Findings]) -> DocumentAudit:
    parts = []
    for place, experiment in enumerate(document.experiments):
        findings = found[document.key, place]
        parts.append(ExperimentAudit(experiment, findings.rows, findings.figures))
    names = Counter((row.place, row.name) for part in parts for row in part.rows)
    twice = [name for name, count in names.items() if count > 1]
    assert not twice, f"{document.key} judges {twice} more than once"
    return DocumentAudit(document, tuple(parts))


def _run(task: tuple[str, int]) -> tuple[str, int, Findings]:
    key, place = task
    return key, place, load_document(key).experiments[place].findings(key)


@contextmanager
def _results(
    tasks: Sequence[tuple[str, int]], workers: int
) -> Iterator[Iterator[tuple[str, int, Findings]]]:
    if workers <= 1:
        yield map(_run, tasks)
        return
    # Forked processes would share locks of threads that are not there.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context)
    try:
        futures = [pool.submit(_run, task) for task in tasks]
        yield (future.result() for future in as_completed(futures))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
