"""Pages of sections: one HTML file each that opens anywhere, without a network."""

from __future__ import annotations

import io
import re
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_type
from clepsydra.base.files import whole_file
from clepsydra.base.section import Line, Mark, Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    return rendered("page.html.jinja", title=section.title, section=section, assets=None)


def write_page(text: str, path: str | Path) -> None:
    """Write a page; an existing file is replaced only by a whole one.

    Raises
    ------
    InputError
        The path is no file name, or the folder cannot be written to.
    """
    require_type(path, (str, Path), "report, path", "a file name", 'write as in "report.html"')
    with whole_file(Path(path)) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


_HEAD = "<head>\n"
#: So high is a page within another one.
_HEIGHT = "45rem"


def framed(text: str, title: str, *, saves: bool = False) -> str:
    """Return a page as an element of another one, as a notebook shows it.

    Its script runs, and reaches nothing outside of its frame.

    Parameters
    ----------
    text : str
        The page, as of `page_text`.
    title : str
        Of the frame, for readers who do not see it.
    saves : bool
        Whether it saves files.

    Examples
    --------
    >>> found = framed(page_text(Section("A")), "Study of A")
    >>> found.startswith('<iframe title="Study of A" sandbox="allow-scripts" srcdoc="&lt;!DOCTYPE')
    True
    """
    # Links to places of the page would lead to those of the notebook.
    own = text.replace(_HEAD, f'{_HEAD}<base href="about:srcdoc">\n', 1)
    style = f"width: 100%; height: {_HEIGHT}; border: 0"
    allowed = "allow-scripts allow-downloads" if saves else "allow-scripts"
    return (
        f'<iframe title="{escape(title)}" sandbox="{allowed}" srcdoc="{escape(own)}" '
        f'style="{style}"></iframe>'
    )


#: What a report says where it has no script.
STILL_WORDS = (
    "The pictures of this report are still: when Clepsydra was installed from its sources, what"
    " makes them interactive could not be built. Install it once more with a network, or a wheel."
)


def page_assets() -> dict[str, str] | None:
    """Return script and style that make the pictures of a report interactive, and its worker.

    They are built from `page/`, which needs Node and its packages once, when Clepsydra is
    installed from its sources; a wheel has them. Without them it is None, and pictures are still.
    """
    return _built(script="report.js", style="report.css", worker="live.js")


def lab_assets() -> dict[str, str] | None:
    """Return script and style of a laboratory; None as for a report."""
    return _built(script="lab.js", style="lab.css")


def _built(**files: str) -> dict[str, str] | None:
    folder = resources.files("clepsydra.report") / "page"
    try:
        return {key: (folder / name).read_text("utf-8") for key, name in files.items()}
    except FileNotFoundError:
        return None


def rendered(template: str, **values: Any) -> str:
    """Return a page made from a template of this package.

    Everything from the user's files is escaped; only pictures, which escape their own words, and
    what this package brings are put in as they are.

    Parameters
    ----------
    template : str
        Name of its file.
    **values
        What it shows; it refuses a name that it is not given.
    """
    import jinja2

    folder = resources.files("clepsydra.report")
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda name: folder.joinpath(name).read_text("utf-8")),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.tests["listed"] = _is_listed
    return environment.get_template(template).render(**values)


def _is_listed(part: object) -> bool:
    return isinstance(part, Line) and part.mark in (Mark.POINT, Mark.REFUSED)


#: Letters become outlines, so that a picture looks the same on every machine; the salt makes
#: the identifiers, and with them the file, the same at every run.
_SETTINGS: dict[Any, Any] = {"svg.fonttype": "path", "svg.hashsalt": "clepsydra"}
_NOTHING = {"Date": None, "Creator": None, "Format": None, "Type": None}


def svg_text(figure: Figure, title: str, prefix: str) -> str:
    """Return a figure as one ``<svg>`` element for use inside HTML.

    Parameters
    ----------
    title : str
        What the picture shows, for readers who do not see it.
    prefix : str
        An identifier put before every id, so that several pictures may share a page.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> svg_text(Figure(figsize=(2, 1)), "nothing", "a").splitlines()[1]
    '<title>nothing</title>'
    """
    import matplotlib

    stream = io.StringIO()
    with matplotlib.rc_context(_SETTINGS):
        figure.savefig(stream, format="svg", metadata=_NOTHING)
    text = stream.getvalue()
    body = text[text.index(">", text.index("<svg")) + 1 :]
    body = re.sub(r"\s*<metadata>.*?</metadata>|\s*<!--.*?-->", "", body, flags=re.DOTALL)
    body = re.sub(r'\bid="', f'id="{prefix}-', body)
    body = re.sub(r'href="#', f'href="#{prefix}-', body)
    body = body.replace("url(#", f"url(#{prefix}-")
    # Hundredths of a point are finer than any printer; matplotlib writes millionths.
    body = re.sub(r' d="[^"]*"', lambda path: _rounded(path.group()), body)
    width, height = (72.0 * length for length in figure.get_size_inches())
    return (
        f'<svg viewBox="0 0 {width:g} {height:g}" role="img"'
        f' xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">\n'
        f"<title>{escape(title)}</title>{body}"
    )


def _rounded(path: str) -> str:
    return re.sub(r"\d+\.\d{3,}", lambda number: f"{float(number.group()):.2f}", path)
