"""The shapes that every drawing is made of, as SVG text on paper of its own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from clepsydra.report.colours import INK
from clepsydra.report.drawing.style import FONT, PAPER, colour_style


def element(tag: str, content: str = "", /, **attributes: object) -> str:
    """Return one element; what is empty is left out, and numbers are in tenths.

    Examples
    --------
    >>> element("line", x1=0.333, stroke_width=None, class_="a<b")
    '<line x1="0.3" class="a&lt;b"/>'
    """
    words = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{_shown(value)}"'
        for name, value in attributes.items()
        if value not in (None, "")
    )
    return f"<{tag}{words}>{content}</{tag}>" if content else f"<{tag}{words}/>"


def _shown(value: object) -> str:
    return f"{round(value, 1):.6g}" if isinstance(value, float) else escape(str(value))


def path(
    data: str, width: float = 1.5, fill: str = "none", stroke: str = INK, **more: object
) -> str:
    """Return lines along a path's data.

    Examples
    --------
    >>> path("M0 0H9")
    '<path d="M0 0H9" fill="none" stroke="#1f2328" stroke-width="1.5" stroke-linejoin="round"/>'
    """
    line = {"stroke": stroke, "stroke_width": f"{width:g}", "stroke_linejoin": "round"}
    return element("path", d=data, fill=fill, **line, **more)


def polygon(points: Sequence[tuple[float, float]], *, closed: bool = True) -> str:
    """Return the data of a path through points.

    Examples
    --------
    >>> polygon([(0.0, 1.0), (2.0, 3.25)])
    'M0.0 1.0L2.0 3.2Z'
    """
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + "Z" * closed


def circle(
    x: float, y: float, radius: float, fill: str = PAPER, stroke: str = INK, width: float = 1.4
) -> str:
    """Return a circle with an edge.

    Examples
    --------
    >>> circle(1, 2, 3.5, "none")
    '<circle cx="1" cy="2" r="3.5" fill="none" stroke="#1f2328" stroke-width="1.4"/>'
    """
    return element("circle", cx=x, cy=y, r=radius, fill=fill, stroke=stroke, stroke_width=width)


def box(
    x: tuple[float, float],
    y: tuple[float, float],
    fill: str = PAPER,
    stroke: str = INK,
    width: float | None = 1.5,
    rounded: float | None = None,
) -> str:
    """Return a rectangle from its left to its right and from its top to its bottom.

    Examples
    --------
    >>> box((0, 2), (1, 4), stroke="", width=None)
    '<rect x="0" y="1" width="2" height="3" fill="#ffffff"/>'
    """
    size = {"x": x[0], "y": y[0], "width": x[1] - x[0], "height": y[1] - y[0]}
    return element("rect", **size, rx=rounded, fill=fill, stroke=stroke, stroke_width=width)


def text(
    x: float,
    y: float,
    words: str,
    anchor: str = "middle",
    style: str = "",
    colour: str = INK,
    **more: object,
) -> str:
    """Return words whose baseline is at y.

    Examples
    --------
    >>> text(1, 2, "a<b")
    '<text x="1" y="2" text-anchor="middle" fill="#1f2328">a&lt;b</text>'
    """
    place = {"x": x, "y": y, "text_anchor": anchor, "fill": colour}
    return element("text", escape(words), **place, class_=style, **more)


def titled(title: str, *shapes: str, kind: str = "", moved: str = "") -> str:
    """Return shapes as one thing, with what it is called, moved where they were drawn around 0.

    Examples
    --------
    >>> titled("a < b", "<path/>", kind="basin")
    '<g class="basin"><title>a &lt; b</title><path/></g>'
    """
    content = f"<title>{escape(title)}</title>{''.join(shapes)}"
    return element("g", content, class_=kind, transform=moved)


def picture(
    kind: str, size: tuple[float, float], title: str, rules: str, shapes: Iterable[str],
    **more: object,
) -> str:  # fmt: skip
    """Return a picture of a kind that `colour_style` knows as one ``<svg>`` element.

    Parameters
    ----------
    kind : str
    size : (float, float)
        Width and height.
    title : str
        What it shows, for readers who do not see it.
    rules : str
        Of style, beside those of colours and letters.
    shapes : iterable of str
    **more
        Attributes of the picture.

    Examples
    --------
    >>> picture("plant", (30.0, 20.0), "no < one", "", []).count("no &lt; one")
    1
    """
    width, height = size
    rules = f".{kind} text{{font-family:{FONT}}}{rules}{colour_style(kind)}"
    room = {"x": 0, "y": 0, "width": width, "height": height}
    paper = element("rect", class_="paper", **room, fill=PAPER)
    content = "\n".join([f"<title>{escape(title)}</title><style>{rules}</style>", paper, *shapes])
    space = {"xmlns": "http://www.w3.org/2000/svg", "viewBox": f"0 0 {width:g} {height:g}"}
    return element("svg", content, **space, role="img", class_=kind, **more)
