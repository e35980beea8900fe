"""Matplotlib figures as SVG text that can stand in a page beside others."""

from __future__ import annotations

import io
import re
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Letters become outlines, so that a picture looks the same on every machine; the salt makes
#: the identifiers, and with them the file, the same at every run.
_SETTINGS: dict[Any, Any] = {"svg.fonttype": "path", "svg.hashsalt": "clepsydra"}
_NOTHING = {"Date": None, "Creator": None, "Format": None, "Type": None}


def svg_text(figure: Figure, title: str, prefix: str) -> str:
    """Return a figure as one ``<svg>`` element for use inside HTML.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
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
