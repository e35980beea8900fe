"""The shapes that a picture of blocks is made of, as SVG text."""

from __future__ import annotations

from html import escape

from clepsydra.report.colours import INK
from clepsydra.report.drawing.style import FONT, PAPER, colour_style

#: Size of letters [pt].
SIZE = 7.5


class Canvas:
    """A picture, shape by shape, on paper of its own.

    Parameters
    ----------
    width, height : float
        [pt]
    title : str
        What it shows, for readers who do not see it.

    Examples
    --------
    >>> canvas = Canvas(30.0, 20.0, "nothing")
    >>> canvas.text(5.0, 10.0, "a < b")
    >>> "a &lt; b" in canvas.svg()
    True
    """

    def __init__(self, width: float, height: float, title: str) -> None:
        self.width, self.height, self.title = width, height, title
        self._shapes: list[str] = []
        self.box((0.0, width), (0.0, height), PAPER)

    def svg(self) -> str:
        """Return the picture as one ``<svg>`` element."""
        return (
            f'<svg viewBox="0 0 {self.width:g} {self.height:g}" role="img" class="blocks" '
            f'xmlns="http://www.w3.org/2000/svg" font-size="{SIZE}">\n'
            f"<title>{escape(self.title)}</title>"
            f"<style>.blocks text{{font-family:{FONT}}}{colour_style('blocks')}</style>\n"
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
        extra += "" if size == SIZE else f' font-size="{size:g}"'
        extra += ' font-weight="600"' if bold else ""
        self._shapes.append(
            f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}"{extra}>{escape(words)}</text>'
        )

    def lines(self, data: str, colour: str, width: float) -> None:
        """Draw the lines of a path's data."""
        if data:
            self._shapes.append(
                f'<path d="{data}" fill="none" stroke="{colour}" stroke-width="{width:g}"'
                ' stroke-linejoin="round"/>'
            )

    def box(self, x: tuple[float, float], y: tuple[float, float], fill: str) -> None:
        """Fill a rectangle."""
        self._shapes.append(
            f'<rect x="{x[0]:.1f}" y="{y[0]:.1f}" width="{x[1] - x[0]:.1f}" '
            f'height="{y[1] - y[0]:.1f}" fill="{fill}"/>'
        )

    def circle(self, x: float, y: float, radius: float, fill: str, edge: str = "none") -> None:
        """Draw a circle."""
        self._shapes.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="{fill}" stroke="{edge}"'
            ' stroke-width="0.8"/>'
        )
