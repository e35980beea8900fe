"""An audit in a screen and on a page: its counts, its rows, and on the page its figures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from clepsydra.base.section import Line, Mark, Picture, Section, Table
from clepsydra.papers.audit import Audit, DocumentAudit
from clepsydra.papers.figure_picture import drawn
from clepsydra.papers.row import COUNTED, VERDICTS, Row, value_words
from clepsydra.report.page import page_text as section_page
from clepsydra.report.page import svg_text
from clepsydra.report.quantities import number_text

#: Letters of a cell of the rows on a screen.
_LETTERS = 30
#: Letters of a claim, beside what comes out of it.
_SENTENCE = 66
_OUTCOME = {"claim holds": "holds", "claim fails": "fails", "remark": "left open"}
_WORDS = (
    "Reproduced: the computed number rounds to the printed one, or is within the tolerance that "
    "its reason states. Misprint: it does not, and other printed numbers or the document's own "
    "equations show the computed one to be right. Consistent: the computed number was solved from "
    "the printed one or fitted to it, so that its agreement proves nothing. Damaged text: our "
    "sources were converted to text, and what stands here looks like damage of that conversion. "
    "Remark: a claim or number that hangs on what the document leaves open, since it holds in one "
    "reading of that and fails in another. Difference: of the computed from the printed number."
)


def audit_answer(result: Audit, *, every: bool = False) -> Section:
    """Return what an audit found: counts, and on request every row that is not as printed."""
    parts: list[Line | Table] = [Line(result.summary, Mark.ANSWER), Line("")]
    counts = []
    for each in result.documents:
        numbers, total = [each.counts[verdict] for verdict in COUNTED], len(each.rows)
        counts.append((each.document.key, *map(str, (*numbers, total - sum(numbers), total))))
    heads = tuple(verdict.replace(" ", "\n") for verdict in COUNTED)
    parts.append(Table("", ("document", *heads, "not\ncounted", "rows"), tuple(counts), kept=2))
    if every or len(result.documents) == 1:
        for each in filter(lambda audited: audited.headlines, result.documents):
            parts += [Line(""), _headlines(each)]
    head, listed = ("place", "what", "printed", "computed", "verdict"), 0
    for each in result.documents:
        rows = [
            (row.place, row.name, row.shown, value_words(row.computed), row.verdict)
            for row in _notable(each.rows)
        ]
        listed += len(rows)
        if every:
            title = f"{each.document.key}: what is not as printed"
            cells = tuple(tuple(map(_short, row)) for row in rows)
            parts.append(Table(title, head, cells, names=5))
    if listed and not every:
        words = "1 row that is" if listed == 1 else f"{listed} rows that are"
        parts += [Line(""), Line(f"{words} not as printed: --all, or on the page.")]
    return Section("", tuple(parts))


def page_text(result: Audit) -> str:
    """Return the page of an audit: one HTML file that opens anywhere, without a script."""
    named: list[tuple[str, DocumentAudit | Audit]] = [
        *((each.document.key, each) for each in result.documents),
        ("All", result),
    ]
    counts = [
        (name, *(str(each.counts[verdict]) for verdict in VERDICTS), str(len(each.rows)))
        for name, each in named
    ]
    table = Table("", ("Document", *VERDICTS, "rows"), tuple(counts))
    head = (Line(result.summary, Mark.ANSWER), table, Line(_WORDS))
    return section_page(Section("Documents audited", (*head, *map(_chapter, result.documents))))


def _chapter(audited: DocumentAudit) -> Section:
    parts: list[Line | Section] = [Line(audited.document.reference)]
    if audited.headlines:
        parts.append(Section("What it concludes", (_table(audited.headlines),)))
    if notable := _notable(audited.rows):
        parts.append(Section("What is not as printed", (_table(notable),)))
    for number, (name, found) in enumerate(audited.experiments.items()):
        shown: list[Picture | Section] = []
        for place, figure in enumerate(found.figures):
            title = f"{figure.number} {figure.title}".strip()
            picture = svg_text(drawn(figure), title, f"{audited.document.key}-{number}-{place}")
            shown.append(Picture(picture, ". ".join(filter(None, (title, figure.note)))))
        if found.rows:
            shown.append(Section(_counted(found.rows), (_table(found.rows),), folded=True))
        parts.append(Section(audited.document.experiments[name], tuple(shown)))
    return Section(audited.document.title, tuple(parts))


def _headlines(audited: DocumentAudit) -> Table:
    """Return what comes out of the headline claims of a document, in its order."""
    cells = tuple(
        (_OUTCOME[row.verdict], _short(row.shown, _SENTENCE)) for row in audited.headlines
    )
    return Table("", ("comes out", f"what {audited.document.key} concludes"), cells, names=2)


def _notable(rows: Iterable[Row]) -> list[Row]:
    return [row for row in rows if not row.is_as_printed]


def _counted(rows: Sequence[Row]) -> str:
    counted = [row for row in rows if row.is_counted]
    as_printed = sum(row.is_as_printed for row in counted)
    words = f"{len(counted)} printed numbers and claims, {as_printed} as printed"
    more = len(rows) - len(counted)
    return f"{words}, and {more} rows outside the count" if more else words


def _table(rows: Sequence[Row]) -> Table:
    """Return rows as text, a reason behind what it is about."""
    cells = tuple(
        (
            row.place,
            ". ".join(filter(None, (row.name, row.reason))),
            row.shown,
            f"{value_words(row.computed)} {row.unit}".strip(),
            difference_words(row.difference),
            row.verdict,
        )
        for row in rows
    )
    return Table(
        "", ("Place", "What", "Printed", "Computed", "Difference", "Verdict"), cells, names=4
    )


def _short(text: str, letters: int = _LETTERS) -> str:
    return text if len(text) <= letters else f"{text[: letters - 1]}…"


def difference_words(difference: float | None) -> str:
    """Return a relative difference in percent, or how many times the print it is.

    Examples
    --------
    >>> difference_words(0.03561), difference_words(-2e-7), difference_words(None)
    ('+3.6 %', '0 %', '')
    >>> difference_words(99.0), difference_words(-5406.0)
    ('100 ×', '−5400 ×')
    """
    if difference is None:
        return ""
    if abs(difference) >= 10.0:
        return f"{float(f'{difference + 1.0:.2g}'):g} ×".replace("-", "−")
    percent = 100.0 * difference
    if abs(percent) < 5e-4:
        return "0 %"
    return f"{'+' if percent > 0 else '−'}{number_text(abs(percent), 2)} %"
