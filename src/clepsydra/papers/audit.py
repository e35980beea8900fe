"""The audit: every experiment of the documents run, every printed number judged."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from clepsydra.base.words import listed
from clepsydra.papers.document import Document, Findings, documents, load_document
from clepsydra.papers.row import COUNTED, VERDICTS, Row
from clepsydra.papers.side_by_side import side_by_side

#: Keys of a document and of one of its experiments.
_Task = tuple[str, str]


@dataclass(frozen=True)
class AuditProgress:
    """How many experiments are done, of how many, and the one that ended last."""

    done: int
    of: int
    name: str


def _counts(rows: Sequence[Row]) -> dict[str, int]:
    counted = Counter(row.verdict for row in rows)
    return {verdict: counted[verdict] for verdict in VERDICTS}


@dataclass(frozen=True)
class DocumentAudit:
    """A document with what its experiments found, by their names in its order."""

    document: Document
    experiments: Mapping[str, Findings]

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows."""
        return tuple(row for found in self.experiments.values() for row in found.rows)

    @property
    def counts(self) -> dict[str, int]:
        """How often each verdict was given, in the order of `VERDICTS`."""
        return _counts(self.rows)

    @property
    def headlines(self) -> tuple[Row, ...]:
        """The rows of the claims by which the document stands, in its order."""
        rows = {(row.place, row.name): row for row in self.rows}
        return tuple(rows[key] for key in self.document.headlines)


@dataclass(frozen=True)
class Audit:
    """All that was audited."""

    documents: tuple[DocumentAudit, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows of all documents."""
        return tuple(row for document in self.documents for row in document.rows)

    @property
    def counts(self) -> dict[str, int]:
        """How often each verdict was given, in the order of `VERDICTS`."""
        return _counts(self.rows)

    @property
    def headlines(self) -> tuple[Row, ...]:
        """The rows of the claims by which the documents stand."""
        return tuple(row for document in self.documents for row in document.headlines)

    def as_list(self) -> list[dict[str, Any]]:
        """Return every row as values for JSON."""
        return [row.as_dict() for row in self.rows]

    @property
    def summary(self) -> str:
        """The result in three sentences."""
        bare = sum(row.is_bare for row in self.rows if row.verdict == "reproduced")
        return summary_of(self.counts, bare, _counts(self.headlines))


def summary_of(
    counts: Mapping[str, int], bare: int = 0, headlines: Mapping[str, int] | None = None
) -> str:
    """Return how often each verdict was given in sentences; what there is none of is not said.

    Parameters
    ----------
    counts : mapping
        Verdict to how often it was given.
    bare : int
        How many of those that are reproduced are nothing but 0, 1 or −1.
    headlines : mapping, optional
        The same as `counts` for the headline claims alone.

    Examples
    --------
    >>> counts = dict.fromkeys(VERDICTS, 0) | {"reproduced": 14, "misprint": 1, "claim holds": 5}
    >>> summary_of(counts | {"remark": 1}, 3, {"claim holds": 2, "remark": 1})
    'Of 15 printed numbers and formulas 14 are reproduced (3 of them a bare 0 or ±1) and 1 is a \
misprint; all 5 claims that can be judged hold. Of the 3 headline claims 2 hold and 1 hangs on \
what is left open. Outside the count stands 1 remark on what is left open.'
    """
    claims = counts["claim holds"] + counts["claim fails"]
    numbers = sum(counts[verdict] for verdict in COUNTED) - claims
    apart = f" ({bare} of them a bare 0 or ±1)" if bare else ""
    found = _told(
        (counts["reproduced"], f"is reproduced{apart}", f"are reproduced{apart}"),
        (counts["misprint"], "is a misprint", "are misprints"),
        (counts["not reproducible"], "cannot be reproduced", "cannot be reproduced"),
    )
    held = f"of {claims} claims {counts['claim holds']} hold"
    if claims and not counts["claim fails"]:
        held = f"all {claims} claims that can be judged hold"
    outside = _told(
        (
            counts["consistent"],
            "row that is consistent with what it was solved from",
            "rows that are consistent with what they were solved from",
        ),
        (
            counts["damaged text"],
            "row that the text's conversion seems to have damaged",
            "rows that the text's conversion seems to have damaged",
        ),
        (counts["remark"], "remark on what is left open", "remarks on what is left open"),
    )
    words = f"Of {numbers} printed numbers and formulas {listed(found)}; {held}."
    if headlines:
        words += _headline_words(headlines)
    if not outside:
        return words
    alone = len(outside) == 1 and outside[0].startswith("1 ")
    return f"{words} Outside the count {'stands' if alone else 'stand'} {listed(outside)}."


def _headline_words(headlines: Mapping[str, int]) -> str:
    found = _told(
        (headlines.get("claim holds", 0), "holds", "hold"),
        (headlines.get("claim fails", 0), "fails", "fail"),
        (headlines.get("remark", 0), "hangs on what is left open", "hang on what is left open"),
    )
    total = sum(headlines.values())
    return f" Of the {total} headline claims {listed(found)}." if total else ""


def _told(*parts: tuple[int, str, str]) -> list[str]:
    return [f"{n} {one if n == 1 else several}" for n, one, several in parts if n]


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
    tasks = [[(document.key, name) for name in document.experiments] for document in loaded]
    count = sum(map(len, tasks))
    found: dict[_Task, Findings] = {}
    for task, findings in side_by_side(_run, tasks, workers):
        found[task] = findings
        if progress is not None:
            title = load_document(task[0]).experiments[task[1]]
            progress(AuditProgress(len(found), count, f"{task[0]}: {title}"))
    audited = []
    for document in loaded:
        of_document = {name: found[document.key, name] for name in document.experiments}
        audited.append(DocumentAudit(document, of_document))
        names = Counter((row.place, row.name) for row in audited[-1].rows)
        twice = [name for name, count in names.items() if count > 1]
        assert not twice, f"{document.key} judges {twice} more than once"
    return Audit(tuple(audited))


def _run(task: _Task) -> Findings:
    key, experiment = task
    for other, document in documents().items():
        if other != key:
            document.forget()
    return load_document(key).findings(experiment)
