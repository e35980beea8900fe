"""The page of an audit: one HTML file that opens anywhere, without a script."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.section import Line, Mark, Picture, Section, Table
from clepsydra.papers.audit import Audit, DocumentAudit
from clepsydra.papers.figure_picture import drawn
from clepsydra.papers.row import VERDICTS, Row
from clepsydra.papers.row_words import difference_words, printed_words, value_words
from clepsydra.report.page import page_text as section_page
from clepsydra.report.page import svg_text

_WORDS = (
    "Reproduced: the computed number rounds to the printed one, or is within the tolerance that "
    "its reason states. Misprint: it does not, and other printed numbers or the document's own "
    "equations show the computed one to be right. Consistent: the computed number was solved from "
    "the printed one or fitted to it, so that its agreement proves nothing. Damaged text: our "
    "sources were converted to text, and what stands here looks like damage of that conversion. "
    "Remark: a finding of ours on something that the document does not claim. Difference: of the "
    "computed from the printed number."
)


def page_text(result: Audit) -> str:
    """Return the page of an audit as HTML.

    Examples
    --------
    >>> "Of 0 printed numbers" in page_text(Audit(()))
    True
    """
    chapters = [_chapter(document) for document in result.documents]
    parts: list[Line | Table | Section] = [Line(result.summary, Mark.ANSWER), _counts(result)]
    return section_page(Section("Documents audited", (*parts, Line(_WORDS), *chapters)))


def _counts(result: Audit) -> Table:
    """Return how many rows of each document have which verdict."""
    rows = [
        (each.document.key, *(str(each.counts[verdict]) for verdict in VERDICTS),
         str(len(each.rows)))
        for each in result.documents
    ]  # fmt: skip
    every = ("All", *(str(result.counts[verdict]) for verdict in VERDICTS), str(len(result.rows)))
    return Table("", ("Document", *VERDICTS, "rows"), (*rows, every))


def _chapter(audited: DocumentAudit) -> Section:
    parts: list[Line | Table | Picture | Section] = [Line(audited.document.reference)]
    notable = [row for row in audited.rows if not row.is_as_printed]
    if notable:
        parts.append(Section("What is not as printed", (_table(notable),)))
    for number, (name, found) in enumerate(audited.experiments.items()):
        pictures = [
            Picture(
                svg_text(drawn(figure), title, f"{audited.document.key}-{number}-{place}"),
                ". ".join(filter(None, (title, figure.note))),
            )
            for place, figure in enumerate(found.figures)
            for title in [f"{figure.number} {figure.title}".strip()]
        ]
        rows = (Section(_counted(found.rows), (_table(found.rows),), folded=True),)
        parts.append(
            Section(audited.document.experiments[name], (*pictures, *(rows if found.rows else ())))
        )
    return Section(audited.document.title, tuple(parts))


def _counted(rows: Sequence[Row]) -> str:
    counted = [row for row in rows if row.is_counted]
    as_printed = sum(row.is_as_printed for row in counted)
    words = f"{len(counted)} printed numbers and claims, {as_printed} as printed"
    more = len(rows) - len(counted)
    return f"{words}, and {more} rows outside the count" if more else words


def _table(rows: Sequence[Row]) -> Table:
    """Return rows as text, a reason behind what it is about."""
    return Table(
        "",
        ("Place", "What", "Printed", "Computed", "Difference", "Verdict"),
        tuple(
            (
                row.place,
                f"{row.name}. {row.reason}" if row.reason else row.name,
                printed_words(row),
                f"{value_words(row.computed)} {row.unit}".strip(),
                difference_words(row.difference),
                row.verdict,
            )
            for row in rows
        ),
        names=4,
    )
