"""The audit: every experiment of the documents run, every printed number judged."""

from __future__ import annotations

import multiprocessing
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass

from clepsydra.papers.document import Document, Findings, documents, load_document
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


class _Judged:
    """Something with rows, and how often each verdict was given."""

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows."""
        raise NotImplementedError

    @property
    def counts(self) -> dict[str, int]:
        """How often each verdict was given, in the order of `VERDICTS`."""
        counted = Counter(row.verdict for row in self.rows)
        return {verdict: counted[verdict] for verdict in VERDICTS}


@dataclass(frozen=True)
class DocumentAudit(_Judged):
    """A document with what its experiments found.

    Parameters
    ----------
    document : Document
    experiments : mapping
        Name of each experiment to what it found, in the order of the document.
    """

    document: Document
    experiments: Mapping[str, Findings]

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows."""
        return tuple(row for found in self.experiments.values() for row in found.rows)


@dataclass(frozen=True)
class Audit(_Judged):
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
    keys: Sequence[str] = (),
    *,
    workers: int = 1,
    progress: Callable[[AuditProgress], None] | None = None,
) -> Audit:
    """Run the experiments of documents and judge every printed number and claim.

    Parameters
    ----------
    keys : sequence of str
        Of documents; all if left out, each once.
    workers : int
        Processes that share the experiments; with more than one, guard a script's start by
        ``if __name__ == "__main__"``.
    progress : callable, optional
        Called after each experiment.

    Raises
    ------
    InputError
        There is no such document.
    """
    loaded = [load_document(key) for key in dict.fromkeys(keys or documents())]
    tasks = [(document.key, name) for document in loaded for name in document.experiments]
    found: dict[tuple[str, str], Findings] = {}
    with _results(tasks, min(workers, len(tasks))) as results:
        for key, name, findings in results:
            found[key, name] = findings
            if progress is not None:
                title = load_document(key).experiments[name]
                progress(AuditProgress(len(found), len(tasks), f"{key}: {title}"))
    return Audit(tuple(_document_audit(document, found) for document in loaded))


def _document_audit(document: Document, found: dict[tuple[str, str], Findings]) -> DocumentAudit:
    result = DocumentAudit(
        document, {name: found[document.key, name] for name in document.experiments}
    )
    names = Counter((row.place, row.name) for row in result.rows)
    twice = [name for name, count in names.items() if count > 1]
    assert not twice, f"{document.key} judges {twice} more than once"
    return result


def _run(task: tuple[str, str]) -> tuple[str, str, Findings]:
    key, name = task
    return key, name, load_document(key).findings(name)


@contextmanager
def _results(
    tasks: Sequence[tuple[str, str]], workers: int
) -> Iterator[Iterator[tuple[str, str, Findings]]]:
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
