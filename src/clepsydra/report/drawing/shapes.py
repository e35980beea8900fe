"""The shapes that every drawing is made of, as SVG text on paper of its own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from clepsydra.report.colours import INK, MUTED

PAPER, DARK_PAPER = "#ffffff", "#14181d"
#: Bodies of plant equipment, pipes, frames of boxes.
STEEL, PIPE, FRAME = "#e9edf1", "#6e7781", "#7d868f"
#: What is abnormal.
ALARM = "#9c3708"
#: Liquid, and what is dissolved in it: one tint a component, in the order of the file.
TINTS = ("#d3e2ee", "#eadcc0", "#d5e6cf", "#e4d6e9", "#f1d5cb", "#cfe6e4")
#: Each colour in the dark.
_DARK = {
    PAPER: DARK_PAPER,
    INK: "#e6edf3",
    MUTED: "#9aa7b4",
    STEEL: "#2a313a",
    PIPE: "#8b949e",
    FRAME: "#7d868f",
    ALARM: "#ffa06b",
    **dict(
        zip(TINTS, ("#1c3a52", "#4b3d1c", "#274128", "#41304a", "#56301f", "#1a4340"), strict=True)
    ),
}
FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Liberation Sans','DejaVu Sans',sans-serif"


def colour_style(scope: str) -> str:
    """Return the rules by which the drawings of a class turn dark on a dark page.

    A picture of its own follows the reader's system, one in a page the page. Where a viewer knows
    no such rules, the colours stay those of a light page, and they have paper of their own.
    """
    rules = [f"svg.{scope}:root{{color-scheme:light dark}}"]
    for light, dark in _DARK.items():
        for what in ("fill", "stroke"):
            rules.append(f'.{scope} [{what}="{light}"]{{{what}:light-dark({light},{dark})}}')
    return "".join(rules)


#: Letters by their width in DejaVu Sans, the widest of the fonts that a viewer may take [em].
_WIDTHS = {
    0.42: " !'\"()*,-./:;I[\\]fijlrt|°²³·",
    0.65: "?_`abcdeghknopqsuvxyz$0123456789{}µτFJLP",
    0.8: "ABCDEGHKNOQRSTUVXYZ&",
}
_WIDTH = {letter: width for width, letters in _WIDTHS.items() for letter in letters}
_WIDEST, _BOLD = 1.0, 1.13


def width(words: str, size: float, bold: bool = False) -> float:
    """Return how wide words are at most, in the unit of the size of their letters.

    Examples
    --------
    >>> round(width("pump_1", 10.0), 1), round(width("pump_1", 10.0, bold=True), 1)
    (42.5, 48.0)
    """
    return size * (_BOLD if bold else 1.0) * sum(_WIDTH.get(letter, _WIDEST) for letter in words)


def shortened(words: str, room: float, size: float, bold: bool = False) -> str:
    """Return words with their middle left out where they are wider than their room.

    Examples
    --------
    >>> shortened("a_rather_long_tank_name", 100.0, 10.0)
    'a_rathe…nk_name'
    """
    shown, kept = words, len(words)
    while width(shown, size, bold) > room and kept > 2:
        kept -= 1
        shown = f"{words[: (kept + 1) // 2]}…{words[len(words) - kept // 2 :]}"
    return shown


def wrapped(name: str, room: float, size: float, bold: bool = False) -> list[str]:
    """Return a name in one line, or in two, parted where its words are.

    Examples
    --------
    >>> wrapped("level_1", 80.0, 10.0), wrapped("outlet_temperature", 80.0, 10.0)
    (['level_1'], ['outlet_', 'temperature'])
    """
    fitting = [k for k in range(1, len(name) + 1) if width(name[:k], size, bold) <= room]
    place = name.rfind("_", 0, len(fitting)) + 1
    if len(fitting) == len(name) or not place:
        return [shortened(name, room, size, bold)]
    return [name[:place], shortened(name[place:], room, size, bold)]


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


def titled(title: str, *shapes: str, kind: str = "", moved: str = "", **more: object) -> str:
    """Return shapes as one thing, with what it is called, moved where they were drawn around 0.

    Examples
    --------
    >>> titled("a < b", "<path/>", kind="basin")
    '<g class="basin"><title>a &lt; b</title><path/></g>'
    """
    content = f"<title>{escape(title)}</title>{''.join(shapes)}"
    return element("g", content, class_=kind, transform=moved, **more)


def picture(
    kind: str, size: tuple[float, float], title: str, rules: str, shapes: Iterable[str],
    **more: object,
) -> str:  # fmt: skip
    """Return a picture of a kind that `colour_style` knows as one ``<svg>`` element.

    Parameters
    ----------
    size : (float, float)
        Width and height.
    title : str
        What it shows, for readers who do not see it.
    rules : str
        Of style, beside those of colours and letters.
    **more
        Attributes of the picture.
    """
    width, height = size
    rules = f".{kind} text{{font-family:{FONT}}}{rules}{colour_style(kind)}"
    room = {"x": 0, "y": 0, "width": width, "height": height}
    paper = element("rect", class_="paper", **room, fill=PAPER)
    content = "\n".join([f"<title>{escape(title)}</title><style>{rules}</style>", paper, *shapes])
    space = {"xmlns": "http://www.w3.org/2000/svg", "viewBox": f"0 0 {width:g} {height:g}"}
    return element("svg", content, **space, role="img", class_=kind, **more)
