"""The picture of a program of blocks: boxes from left to right, with wires at right angles."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Iterator
from itertools import accumulate

from clepsydra.program.program import Program
from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing.block_diagram import Box, Port, block_box, diagram
from clepsydra.report.drawing.rising import nearest_rising
from clepsydra.report.drawing.shapes import (
    FRAME,
    PAPER,
    STEEL,
    box,
    circle,
    path,
    picture,
    text,
    width,
)
from clepsydra.report.quantities import fitted

#: Rows of ports [pt]. Outputs stand half a row below inputs, and wires that pass a column a
#: quarter or three, so that no two wires of a channel run in one line.
_ROW = 11.0
_HEAD, _GAP, _TRACK, _MARGIN, _STUB = 27.0, 11.0, 5.0, 8.0, 7.0
#: Size of letters, of the names of ports [pt], and how many letters beside a port are shown.
_SIZE, _SMALL, _LETTERS = 7.5, 6.5, 24
#: Colour and width of a wire that carries no number, and of one that does [pt].
_STROKES = (MUTED, 0.6), (INK, 1.1)
#: Where words end in a box and outside of it, by the way that leads out.
_ANCHORS = {-1: ("start", "end"), 1: ("end", "start")}


def program_svg(program: Program, title: str, settings: Iterable[str] = ()) -> str:
    """Draw what the calls of a program are wired to.

    Wires of numbers are thick, those of truth values and whole numbers thin. An open circle
    stands where operations compute what a port gets. A signal that many boxes read, a signal of
    the program and what it keeps for the next sample stand by their names.

    Parameters
    ----------
    program : Program
        Its calls own their state.
    title : str
        What it shows, for readers who do not see it.
    settings : iterable of str
        As for `diagram`.
    """
    return _drawn(diagram(program, settings), title)


def block_svg(block: Program, title: str, settings: Iterable[str] = ()) -> str:
    """Draw one block with its ports.

    Parameters
    ----------
    title : str
        What it shows, for readers who do not see it.
    settings : iterable of str
        As for `block_box`.
    """
    return _drawn([block_box(block, settings)], title)


def _drawn(boxes: list[Box], title: str) -> str:
    bands = [_Band(boxes, number) for number in range(1 + max(box.band for box in boxes))]
    wide = max(band.ends[-1][1] + band.room for band in bands) + _MARGIN
    shapes: list[str] = []
    top = _MARGIN
    for band in bands:
        shapes += band.draw(top)
        top += band.height
    return picture("blocks", (wide, top), title, "", shapes, font_size=_SIZE)


class _Item:
    """What stands in a column: a box, or a wire that passes."""

    def __init__(self, column: int, box: Box | None = None) -> None:
        self.column, self.box, self.top, self.height = column, box, 0.0, _ROW / 2
        if box is not None:
            rows = max(len(box.inputs), len(box.outputs)) + bool(_foot(box))
            self.height = _HEAD + _ROW * rows


class _Band:
    """Columns of boxes side by side, and the wires between them."""

    def __init__(self, boxes: list[Box], number: int) -> None:
        self.items = {k: _Item(b.column, b) for k, b in enumerate(boxes) if b.band == number}
        columns = range(1 + max(item.column for item in self.items.values()))
        self.columns = [[i for i in self.items.values() if i.column == c] for c in columns]
        self.readers: dict[Port, list[Port]] = {}
        for item in self.items.values():
            for port in item.box.inputs if item.box else ():
                for wire in port.wires:
                    self.readers.setdefault(wire, []).append(port)
        #: Where each wire passes a column, the box that it comes from included.
        self.ways: dict[tuple[Port, int], _Item] = {}
        for wire, ports in self.readers.items():
            first = self.items[wire.box]
            self.ways[wire, first.column] = first
            for column in range(first.column + 1, max(self.items[p.box].column for p in ports)):
                self.ways[wire, column] = lane = _Item(column)
                self.columns[column].append(lane)
        self._place()
        self.ends: list[tuple[float, float]] = []
        self.tracks: list[dict[Port, float]] = []
        self.room = _MARGIN
        for number, items in enumerate(self.columns):
            found = [item.box for item in items if item.box]
            left = self.ends[-1][1] + self.room if self.ends else _MARGIN
            left += max((_room(port) for box in found for port in box.inputs), default=0.0)
            self.ends.append((left, left + max(map(_width, found))))
            self.room = max((_room(port) for box in found for port in box.outputs), default=0.0)
            tracks = self._tracks(number)
            self.tracks.append({w: self.ends[-1][1] + self.room + k for w, k in tracks.items()})
            self.room += max(tracks.values(), default=0.0) + _TRACK

    def _place(self) -> None:
        for column in self.columns:
            _stack(column, {})
        for turn in range(8):
            for column in self.columns if turn % 2 == 0 else reversed(self.columns):
                _stack(column, self._pulls(left_only=turn == 0))
        every = [item for column in self.columns for item in column]
        lift = min(item.top for item in every)
        for item in every:
            at = _ROW * (0.25 if item.column % 2 else 0.75) if item.box is None else 0.0
            item.top = _ROW * math.floor((item.top - lift - at) / _ROW + 0.5) + at
        self.height = max(item.top + item.height for item in every) + _GAP

    def _pulls(self, *, left_only: bool) -> dict[_Item, list[float]]:
        """Return how far the ends of wires would have to move so that these ran level."""
        pulls: dict[_Item, list[float]] = {}
        for (wire, column), item in self.ways.items():
            start = self._start(wire, column)
            for end, other in self._ends(wire, column):
                pulls.setdefault(other, []).append(start - end)
                if not left_only:
                    pulls.setdefault(item, []).append(end - start)
        return pulls

    def _start(self, wire: Port, column: int) -> float:
        item = self.ways[wire, column]
        return self._y(wire) if item.box else item.top

    def _ends(self, wire: Port, column: int) -> list[tuple[float, _Item]]:
        """Return where a wire that leaves a column arrives in the next one."""
        ends = [(self._y(port), self.items[port.box]) for port in self.readers[wire]]
        lane = self.ways.get((wire, column + 1))
        return [e for e in ends if e[1].column == column + 1] + ([(lane.top, lane)] if lane else [])

    def _y(self, port: Port) -> float:
        item = self.items[port.box]
        assert item.box is not None
        inward = port in item.box.inputs
        row = item.box.inputs.index(port) if inward else item.box.outputs.index(port) + 0.5
        return item.top + _HEAD + _ROW * row

    def _tracks(self, column: int) -> dict[Port, float]:
        """Return how far behind a column each wire turns that leaves it."""
        spans = {}
        for wire, where in self.ways:
            if where == column:
                places = [self._start(wire, column), *(y for y, _ in self._ends(wire, column))]
                spans[wire] = min(places), max(places)
        taken: list[float] = []
        found = {}
        for wire, (low, high) in sorted(spans.items(), key=lambda item: item[1]):
            free = (k for k, below in enumerate(taken) if below + 1.0 < low)
            track = next(free, len(taken))
            taken[track : track + 1] = [high]
            found[wire] = _TRACK * (1 + track)
        return found

    def draw(self, top: float) -> Iterator[str]:
        """Draw everything, from a height in the picture on."""
        for item in (item for column in self.columns for item in column):
            item.top += top
        lines, dots = {False: "", True: ""}, []
        for (wire, column), item in self.ways.items():
            left, right = self.ends[column]
            track, start = self.tracks[column][wire], self._start(wire, column)
            places = [y for y, _ in self._ends(wire, column)]
            data = f"M{right if item.box else left:.1f} {start:.1f}H{track:.1f}"
            data += f"M{track:.1f} {min(start, *places):.1f}V{max(start, *places):.1f}"
            for place in places:
                data += f"M{track:.1f} {place:.1f}H{self.ends[column + 1][0]:.1f}"
            lines[wire.real] += data
            dots += [(track, place, wire.real) for place in sorted({start, *places})[1:-1]]
        for item in self.items.values():
            for port, at, out in self._ports(item):
                if not self._wired(port):
                    lines[port.real] += f"M{at:.1f} {self._y(port):.1f}H{at + _STUB * out:.1f}"
        for real, data in lines.items():
            colour, thick = _STROKES[real]
            yield path(data, thick, stroke=colour)
        for x, y, real in dots:
            yield circle(x, y, 1.5, _STROKES[real][0], "none")
        for item in self.items.values():
            yield from self._draw_box(item)

    def _wired(self, port: Port) -> bool:
        return bool(port.wires) or port in self.readers

    def _ports(self, item: _Item) -> Iterator[tuple[Port, float, int]]:
        """Yield each port of a box with its place across, and which way leads out of the box."""
        if item.box is not None:
            left, right = self.ends[item.column]
            yield from ((port, left, -1) for port in item.box.inputs)
            yield from ((port, right, 1) for port in item.box.outputs)

    def _draw_box(self, item: _Item) -> Iterator[str]:
        block, (left, right) = item.box, self.ends[item.column]
        assert block is not None
        top, bottom = item.top, item.top + item.height
        yield box((left, right), (top, bottom), STEEL if block.kind else PAPER, FRAME, 0.9)
        yield text(left + 4.0, top + 10.0, block.title or block.kind, "start", font_weight=600)
        if block.title and block.kind:
            yield _small(left + 4.0, top + 18.0, block.kind)
        if _foot(block):
            yield _small(left + 4.0, bottom - 4.0, _foot(block))
        for port, at, out in self._ports(item):
            y, (inner, outer) = self._y(port), _ANCHORS[out]
            if port.name:
                yield _small(at - 4.0 * out, y + 2.3, port.name, inner, INK)
            if port.names:
                # Above its wire, or else at its end.
                base = y - 1.9 if self._wired(port) else y + 2.3
                yield _small(at + (_STUB + 2.0) * out, base, _names(port), outer)
            if port.computed:
                yield circle(at, y, 2.0, width=0.8)


def _small(x: float, y: float, words: str, anchor: str = "start", colour: str = MUTED) -> str:
    return text(x, y, words, anchor, colour=colour, font_size=_SMALL)


def _names(port: Port) -> str:
    """Return what stands beside a port, as much as there is room for."""
    words = ", ".join(port.names)
    if len(words) <= _LETTERS or len(port.names) == 1:
        return fitted(words, _LETTERS)
    return f"{words[:_LETTERS].rpartition(', ')[0] or fitted(port.names[0], _LETTERS)}, …"


def _room(port: Port) -> float:
    """Return how much room the names beside a port take [pt]."""
    return _STUB + (4.0 + width(_names(port), _SMALL) if port.names else 0.0)


def _foot(box: Box) -> str:
    settings = f"{box.settings} parameter{'s' * (box.settings > 1)}" * bool(box.settings)
    return ", ".join(filter(None, (settings, f"keeps {box.kept}" * bool(box.kept))))


def _width(box: Box) -> float:
    ports = sum(
        max((width(port.name, _SMALL) for port in side), default=0.0)
        for side in (box.inputs, box.outputs)
    )
    title = width(box.title or box.kind, _SIZE, bold=True)
    small = max(width(words, _SMALL) for words in (box.kind, _foot(box)))
    return 8.0 + max(ports + 1.5 * _SMALL, title, small)


def _stack(column: list[_Item], pulls: dict[_Item, list[float]]) -> None:
    """Move each item of a column where it is pulled, as far as the others let it.

    Boxes keep their order. Least squares of the distances: what would overlap moves as one.
    """
    wanted = {item: item.top + statistics.fmean(pulls.get(item, [0.0])) for item in column}
    keys: dict[_Item, float] = {}
    for item in column:
        before = max((keys[other] for other in keys if other.box and item.box), default=-math.inf)
        keys[item] = max(before, wanted[item] + item.height / 2)
    column.sort(key=keys.__getitem__)
    heights = [item.height + _GAP * bool(item.box) + _ROW / 2 for item in column]
    above = list(accumulate(heights[:-1], initial=0.0))
    tops = nearest_rising(wanted[item] - top for item, top in zip(column, above, strict=True))
    for item, top, before in zip(column, tops, above, strict=True):
        item.top = top + before
