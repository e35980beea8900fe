"""Pages of sections: one HTML file each that opens anywhere, without a network."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.files import whole_file
from clepsydra.base.section import Section
from clepsydra.report.html_section import html
from clepsydra.report.template import rendered


def page_text(section: Section) -> str:
    """Return a section as a page of its own, without a script.

    Everything from the user's files is escaped; only pictures, which escape their own words, are
    put in as they are.

    Parameters
    ----------
    section : Section
        Its title is that of the page.

    Examples
    --------
    >>> "<h1>A &amp; B</h1>" in page_text(Section("A & B"))
    True
    """
    main = html(section, 1, scripted=False)
    return rendered("page.html.jinja", title=section.title, main=main, assets=None)


def write_page(text: str, path: str | Path) -> None:
    """Write a page; an existing file is replaced only by a whole one.

    Parameters
    ----------
    text : str
    path : str or Path

    Raises
    ------
    InputError
        The folder cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_page("<!DOCTYPE html>", Path(folder, "page.html"))
    ...     Path(folder, "page.html").read_text("utf-8")
    '<!DOCTYPE html>'
    """
    with whole_file(Path(path)) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
