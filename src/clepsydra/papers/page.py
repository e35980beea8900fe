"""The page of an audit: one HTML file that opens anywhere, without a script."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.files import whole_file
from clepsydra.papers.audit import Audit, DocumentAudit
from clepsydra.papers.figure_svg import figure_svg
from clepsydra.papers.row import VERDICTS, Row
from clepsydra.papers.row_words import difference_words, printed_words, value_words
from clepsydra.report.template import rendered

if TYPE_CHECKING:
    from markupsafe import Markup


@dataclass(frozen=True)
class _Picture:
    title: str
    note: str
    svg: Markup


@dataclass(frozen=True)
class _Part:
    title: str
    rows: tuple[Row, ...]
    pictures: tuple[_Picture, ...]


@dataclass(frozen=True)
class _Chapter:
    audited: DocumentAudit
    notable: tuple[Row, ...]
    parts: tuple[_Part, ...]


def write_page(result: Audit, path: str | Path) -> None:
    """Write the page of an audit; an existing file is replaced only by a whole one.

    Parameters
    ----------
    result : Audit
    path : str or Path
        An HTML file.

    Raises
    ------
    InputError
        The folder cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_page(Audit(()), Path(folder, "papers.html"))
    ...     Path(folder, "papers.html").read_text("utf-8")[:15]
    '<!DOCTYPE html>'
    """
    with whole_file(Path(path)) as part:
        part.write_text(page_text(result), encoding="utf-8", newline="\n")


def page_text(result: Audit) -> str:
    """Return the page of an audit as HTML.

    Examples
    --------
    >>> "Of 0 printed numbers" in page_text(Audit(()))
    True
    """
    chapters = [_chapter(document) for document in result.documents]
    return rendered(
        "papers.html.jinja",
        audit=result,
        chapters=chapters,
        verdicts=VERDICTS,
        printed_words=printed_words,
        value_words=value_words,
        difference_words=difference_words,
    )


def _chapter(audited: DocumentAudit) -> _Chapter:
    from markupsafe import Markup

    parts = []
    for number, (name, found) in enumerate(audited.experiments.items()):
        pictures = tuple(
            _Picture(
                f"{figure.number}: {figure.title}" if figure.number else figure.title,
                figure.note,
                Markup(figure_svg(figure, f"{audited.document.key}-{number}-{place}")),
            )
            for place, figure in enumerate(found.figures)
        )
        parts.append(_Part(audited.document.experiments[name], found.rows, pictures))
    notable = tuple(row for row in audited.rows if not row.is_as_printed)
    return _Chapter(audited, notable, tuple(parts))
