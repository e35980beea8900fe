"""Pictures written as SVG, shape by shape."""

from __future__ import annotations

from html import escape

from clepsydra.report.colours import INK

#: Width of a picture [pt], as wide as the text of an A4 page.
WIDTH = 532.0
#: Size of letters [pt].
SIZE = 7.5


class Chart:
    """An SVG picture, shape by shape.

    Parameters
    ----------
    height : float
        [pt]
    title : str
        What it shows, for readers who do not see it.
    prefix : str
        Put before every identifier, so that several pictures may share a page.
    width : float
        [pt]

    Examples
    --------
    >>> chart = Chart(20.0, "nothing", "a")
    >>> chart.text(5.0, 10.0, "a < b")
    >>> "a &lt; b" in chart.svg()
    True
    """

    def __init__(self, height: float, title: str, prefix: str, width: float = WIDTH) -> None:
        self.width, self.height, self.title, self.prefix = width, height, title, prefix
        self._shapes: list[str] = []

    def svg(self) -> str:
        """Return the picture as one ``<svg>`` element for use inside HTML."""
        hatch = (
            f'<pattern id="{self.prefix}-hatch" width="4" height="4" '
            f'patternUnits="userSpaceOnUse"><path d="M0 4L4 0" stroke="#9aa4af" '
            f'stroke-width=".5"/></pattern>'
        )
        return (
            f'<svg viewBox="0 0 {self.width:g} {self.height:g}" role="img" '
            f'xmlns="http://www.w3.org/2000/svg" font-size="{SIZE}" fill="{INK}">\n'
            f"<title>{escape(self.title)}</title><defs>{hatch}</defs>\n"
            + "\n".join(self._shapes)
            + "\n</svg>"
        )

    def text(
        self,
        x: float,
        y: float,
        words: str,
        *,
        anchor: str = "start",
        colour: str = INK,
        size: float = SIZE,
        bold: bool = False,
    ) -> None:
        """Write words whose baseline is at y."""
        extra = "" if anchor == "start" else f' text-anchor="{anchor}"'
        extra += "" if colour == INK else f' fill="{colour}"'
        extra += "" if size == SIZE else f' font-size="{size:g}"'
        extra += ' font-weight="600"' if bold else ""
        self._shapes.append(f'<text x="{x:.1f}" y="{y:.1f}"{extra}>{escape(words)}</text>')

    def lines(self, data: str, colour: str, width: float, opacity: float = 1.0) -> None:
        """Draw the lines of a path's data."""
        if data:
            faint = "" if opacity == 1.0 else f' opacity="{opacity:g}"'
            self._shapes.append(
                f'<path d="{data}" fill="none" stroke="{colour}" stroke-width="{width:g}" '
                f'stroke-linejoin="round"{faint}/>'
            )

    def box(
        self, x: tuple[float, float], y: tuple[float, float], fill: str, opacity: float = 1.0
    ) -> None:
        """Fill a rectangle."""
        left, top = min(x), min(y)
        faint = "" if opacity == 1.0 else f' opacity="{opacity:g}"'
        self._shapes.append(
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{abs(x[1] - x[0]):.1f}" '
            f'height="{abs(y[1] - y[0]):.1f}" fill="{fill}"{faint}/>'
        )

    def circle(
        self, x: float, y: float, radius: float, fill: str, edge: str = "none", width: float = 0.8
    ) -> None:
        """Draw a circle."""
        self._shapes.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="{fill}" '
            f'stroke="{edge}" stroke-width="{width:g}"/>'
        )
