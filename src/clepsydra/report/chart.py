"""Charts written as SVG: scales, ticks, and the shapes that pictures of a report are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from clepsydra.report.colours import INK, LIMIT, MUTED
from clepsydra.report.envelope import envelope
from clepsydra.report.quantities import short_text

#: Width of a picture [pt], as wide as the text of an A4 page.
WIDTH = 532.0
#: Size of letters [pt], and how wide one is at most on average, as a share of that.
SIZE, LETTER = 7.5, 0.58
GRID = "#e6e9ed"
#: Columns to the point: finer than what a screen or a printer shows of a line.
_COLUMNS_PER_POINT = 1.5
#: Places are written in tenths of a point.
_TENTHS = 10.0


@dataclass(frozen=True)
class Scale:
    """From values to places in a picture.

    Parameters
    ----------
    low, high : float
        Values at its ends.
    start, end : float
        Places there [pt].
    logarithmic : bool

    Examples
    --------
    >>> Scale(0.0, 10.0, 100.0, 0.0).place(2.5), Scale(1.0, 100.0, 0.0, 50.0, True).place(10.0)
    (75.0, 25.0)
    """

    low: float
    high: float
    start: float
    end: float
    logarithmic: bool = False

    def place(self, value: float) -> float:
        """Return where a value stands [pt]."""
        return float(self.places(np.array([value]))[0])

    def places(self, values: np.ndarray) -> np.ndarray:
        """Return where values stand [pt]; what is not finite stays so."""
        low, high = self.low, self.high
        if self.logarithmic:
            values, low, high = np.log10(values), math.log10(low), math.log10(high)
        return np.asarray(self.start + (values - low) * ((self.end - self.start) / (high - low)))

    def ticks(self, most: int = 4) -> list[float]:
        """Return round values between its ends: 1, 2 or 5 times a power of ten."""
        if self.logarithmic:
            return self._decades()
        step = _step((self.high - self.low) / most)
        rounding = 1e-9 * max(1.0, abs(self.low / step), abs(self.high / step))
        first = math.ceil(self.low / step - rounding)
        last = math.floor(self.high / step + rounding)
        return [number * step for number in range(first, last + 1)]

    def _decades(self) -> list[float]:
        size = math.log10(self.high / self.low)
        factors: tuple[float, ...] = (1.0, 2.0, 5.0) if size < 2.5 else (1.0,)
        factors = (1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if size < 0.7 else factors
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        found = [factor * 10.0**decade for decade in range(first, last + 1) for factor in factors]
        inside = [v for v in found if 0.999 * self.low <= v <= 1.001 * self.high]
        return inside[:: 1 + len(inside) // 10]


def _step(least: float) -> float:
    power = 10.0 ** math.floor(math.log10(least))
    return next(f * power for f in (1.0, 2.0, 5.0, 10.0) if f * power >= least * (1 - 1e-9))


def tick_texts(ticks: Sequence[float]) -> list[str]:
    """Return the values of ticks as text, as many decimals as tell them apart.

    Examples
    --------
    >>> tick_texts([-0.5, 0.0, 0.5]), tick_texts([12.0, 12.05])
    (['−0.5', '0.0', '0.5'], ['12.00', '12.05'])
    """
    gaps = np.diff(ticks)
    if not len(gaps) or min(gaps) < 1e-5 or max(abs(t) for t in ticks) >= 1e6:
        return [short_text(tick) for tick in ticks]
    if max(gaps) > 1.01 * min(gaps):  # of a logarithmic scale
        return [short_text(tick) for tick in ticks]
    decimals = max(0, -math.floor(math.log10(gaps[0] * (1 + 1e-9))))
    return [f"{tick + 0.0:.{decimals}f}".replace("-", "−") for tick in ticks]


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
        self._boxes = 0

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
        turned: bool = False,
        bold: bool = False,
    ) -> None:
        """Write words whose baseline is at y."""
        extra = "" if anchor == "start" else f' text-anchor="{anchor}"'
        extra += "" if colour == INK else f' fill="{colour}"'
        extra += "" if size == SIZE else f' font-size="{size:g}"'
        extra += ' font-weight="600"' if bold else ""
        extra += f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
        self._shapes.append(f'<text x="{x:.1f}" y="{y:.1f}"{extra}>{escape(words)}</text>')

    def line(
        self,
        x: tuple[float, float],
        y: tuple[float, float],
        colour: str = MUTED,
        width: float = 0.6,
        dash: str = "",
        opacity: float = 1.0,
    ) -> None:
        """Draw a straight line."""
        data = f"M{x[0]:.1f} {y[0]:.1f}L{x[1]:.1f} {y[1]:.1f}"
        self._shapes.append(_stroke(data, colour, width, dash, opacity))

    def lines(self, data: str, colour: str, width: float, opacity: float = 1.0) -> None:
        """Draw the lines of a path's data."""
        if data:
            self._shapes.append(_stroke(data, colour, width, "", opacity))

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

    def hatched(self, x: tuple[float, float], y: tuple[float, float]) -> None:
        """Fill a rectangle that must not be entered."""
        self.box(x, y, LIMIT)
        self.box(x, y, f"url(#{self.prefix}-hatch)")

    def circle(
        self, x: float, y: float, radius: float, fill: str, edge: str = "none", width: float = 0.8
    ) -> None:
        """Draw a circle."""
        self._shapes.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="{fill}" '
            f'stroke="{edge}" stroke-width="{width:g}"/>'
        )

    def clip(self, x: tuple[float, float], y: tuple[float, float]) -> str:
        """Return the name of a rectangle that `curve` may be kept within."""
        self._boxes += 1
        name = f"{self.prefix}-box{self._boxes}"
        self._shapes.append(
            f'<clipPath id="{name}"><rect x="{min(x):.1f}" y="{min(y):.1f}" '
            f'width="{abs(x[1] - x[0]):.1f}" height="{abs(y[1] - y[0]):.1f}"/></clipPath>'
        )
        return name

    def curve(
        self,
        x: np.ndarray,
        y: np.ndarray,
        colour: str,
        width: float,
        *,
        dash: str = "",
        held: bool = False,
        opacity: float = 1.0,
        clip: str = "",
    ) -> None:
        """Draw a line through places [pt]; one that is held goes on level to the next place."""
        data = path_data(x, y, held=held)
        if data:
            self._shapes.append(_stroke(data, colour, width, dash, opacity, clip))


def thinned(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the places [pt] of a curve along x that can be told apart.

    Examples
    --------
    >>> x = np.linspace(0.0, 10.0, 1001)
    >>> len(thinned(x, np.sin(x))[0]) < 70
    True
    """
    if len(x) < 3:
        return x, y
    columns = max(int((x[-1] - x[0]) * _COLUMNS_PER_POINT), 1)
    places, values = envelope(x * _COLUMNS_PER_POINT, y, columns)
    return places / _COLUMNS_PER_POINT, values


def path_data(x: np.ndarray, y: np.ndarray, *, held: bool = False) -> str:
    """Return the data of an SVG path through places [pt], broken where one is not finite.

    Examples
    --------
    >>> path_data(np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 0.0, 0.0, 5.0]))
    'M0 0l20 0 10 50'
    >>> path_data(np.array([0.0, 1.0]), np.array([0.0, 5.0]), held=True)
    'M0 0h10v50'
    """
    finite = np.isfinite(x) & np.isfinite(y)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], finite.astype(int), [0]))))
    parts = []
    for start, stop in edges.reshape(-1, 2):
        places = np.rint(_TENTHS * np.column_stack([x[start:stop], y[start:stop]])).astype(int)
        parts.append(_steps(places) if held else _segments(places))
    return "".join(parts)


def _segments(places: np.ndarray) -> str:
    moves = np.diff(places, axis=0)
    moves = moves[np.any(moves != 0, axis=1)]
    if not len(moves):
        return f"M{places[0, 0]} {places[0, 1]}h0"
    # Moves that go on level are one.
    level = (moves[:, 1] == 0) & (moves[:, 0] > 0)
    starts = np.flatnonzero(~(level & np.concatenate(([False], level[:-1]))))
    joined = np.add.reduceat(moves, starts, axis=0)
    words = " ".join(f"{dx} {dy}" for dx, dy in joined.tolist())
    return f"M{places[0, 0]} {places[0, 1]}l{words}".replace(" -", "-")


def _steps(places: np.ndarray) -> str:
    words = [f"M{places[0, 0]} {places[0, 1]}"]
    x, y = places[0].tolist()
    for place in np.flatnonzero(np.diff(places[:, 1])) + 1:
        next_x, next_y = places[place].tolist()
        words.append((f"h{next_x - x}" if next_x != x else "") + f"v{next_y - y}")
        x, y = next_x, next_y
    if places[-1, 0] != x or len(words) == 1:
        words.append(f"h{places[-1, 0] - x}")
    return "".join(words)


def _stroke(data: str, colour: str, width: float, dash: str, opacity: float, clip: str = "") -> str:
    small = 1.0
    extra = ""
    if "l" in data or "h" in data:  # written in tenths
        small, extra = _TENTHS, ' transform="scale(.1)"'
    if dash:
        lengths = " ".join(f"{small * float(length):g}" for length in dash.split())
        extra += f' stroke-dasharray="{lengths}"'
    extra += "" if opacity == 1.0 else f' opacity="{opacity:g}"'
    path = (
        f'<path d="{data}" fill="none" stroke="{colour}" stroke-width="{small * width:g}" '
        f'stroke-linejoin="round"{extra}/>'
    )
    return f'<g clip-path="url(#{clip})">{path}</g>' if clip else path
