"""What a drawing shows, measured on the picture: lines, arches, vessels and words as boxes."""

import math
import re
from functools import cache
from itertools import combinations, product, starmap
from pathlib import Path
from xml.etree import ElementTree

SVG = "{http://www.w3.org/2000/svg}"
#: Size of the letters of each class of words, and whether they are bold.
_LETTERS = {"": (13.0, False), "name": (14.0, True), "small": (12.0, False), "tag": (11.5, False)}


@cache
def _font(bold):
    """DejaVu Sans, the widest font that the drawing may be shown in."""
    import matplotlib
    from matplotlib.ft2font import FT2Font

    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    font = FT2Font(Path(matplotlib.get_data_path(), "fonts", "ttf", name))
    font.set_size(100.0, 72.0)
    return font


def width(words, size, bold):
    """How wide words are [px]."""
    letters = (_font(bold).load_char(ord(letter)) for letter in words)
    return size / 100.0 * sum(letter.linearHoriAdvance / 65536 for letter in letters)


class Drawn:
    """The picture of a plant, taken apart."""

    def __init__(self, svg):
        self.root = ElementTree.fromstring(svg)
        _, _, self.width, self.height = (float(n) for n in self.root.get("viewBox").split())
        self.words = [(text, self._box(text)) for text in self.root.iter(f"{SVG}text")]
        self.vessels = [self._outline(group) for group in self._groups("vessel")]
        self.basins = [self._outline(group) for group in self._groups("basin")]
        self.lines = {
            kind: [self._line(group) for group in self._groups(kind)]
            for kind in ("pipe", "tap", "signal")
        }

    def _groups(self, kind):
        return [group for group in self.root.iter(f"{SVG}g") if group.get("class") == kind]

    def _box(self, text):
        style = text.get("class", "").split()
        size, bold = _LETTERS[next((name for name in style if name in _LETTERS), "")]
        long = width(text.text, size, bold)
        left = float(text.get("x")) - long * {"start": 0.0, "middle": 0.5, "end": 1.0}[
            text.get("text-anchor")
        ]  # fmt: skip
        base = float(text.get("y"))
        # From the top of a capital letter or a figure down to the tail of a g.
        return (left, base - 0.74 * size, left + long, base + 0.22 * size)

    def _outline(self, group):
        """The box around a vessel or a reservoir."""
        numbers = []
        for path in group.findall(f"{SVG}path"):
            found = re.findall(r"(-?[\d.]+)[ ,](-?[\d.]+)", path.get("d"))
            numbers += [(float(x), float(y)) for x, y in found]
        for rect in group.findall(f"{SVG}rect"):
            x, y, w, h = (float(rect.get(key)) for key in ("x", "y", "width", "height"))
            numbers += [(x, y), (x + w, y + h)]
        xs, ys = zip(*numbers, strict=True)
        return (min(xs), min(ys), max(xs), max(ys))

    def _line(self, group):
        """The title of a line, its straight pieces, and the middles of its arches."""
        here, pieces, arches = (0.0, 0.0), [], []
        for letter, rest in re.findall(r"([MLHVa])([^MLHVa]*)", group.find(f"{SVG}path").get("d")):
            numbers = [float(number) for number in rest.split()]
            if letter == "a":
                there = (here[0] + numbers[-2], here[1] + numbers[-1])
                arches.append(((here[0] + there[0]) / 2, (here[1] + there[1]) / 2))
            elif letter == "H":
                there = (numbers[0], here[1])
            elif letter == "V":
                there = (here[0], numbers[0])
            else:
                there = (numbers[0], numbers[1])
            if letter != "M" and there != here:
                pieces.append((here, there))
            here = there
        return group[0].text, pieces, arches


def overlap(one, other, slack=0.5):
    """Whether two boxes have more than a hair in common."""
    return (
        min(one[2], other[2]) - max(one[0], other[0]) > slack
        and min(one[3], other[3]) - max(one[1], other[1]) > slack
    )


def box_of(piece, half=0.0):
    """The box around a straight piece of a line."""
    (x1, y1), (x2, y2) = piece
    return (min(x1, x2) - half, min(y1, y2) - half, max(x1, x2) + half, max(y1, y2) + half)


def check(svg):
    """See that a picture can be read: lines, arches, words."""
    drawn = Drawn(svg)
    _check_vessels(drawn)
    _check_crossings(drawn)
    _check_words(drawn)
    return drawn


def _check_vessels(drawn):
    """No signal runs through a vessel or a reservoir."""
    for kind in ("signal", "tap"):
        for title, pieces, _ in drawn.lines[kind]:
            for piece in pieces:
                for vessel in (*drawn.vessels, *drawn.basins):
                    assert not overlap(box_of(piece, 0.6), vessel, 2.0), (kind, title, piece)


def _check_crossings(drawn):
    """Where two lines cross one of them arches, and nowhere else: a signal over a pipe."""
    every = [(kind, *line) for kind, lines in drawn.lines.items() for line in lines]
    arches = [(kind, arch) for kind, _, _, own in every for arch in own]
    needed = set()
    for (kind, title, pieces, _), (other_kind, other, others, _) in combinations(every, 2):
        # An arch is a piece from foot to foot, so its line seems to run straight on.
        for point in filter(None, starmap(_crossing, product(pieces, others))):
            found = [k for k, (x, y) in arches if math.dist((x, y), point) < 0.6]
            assert found == [max((kind, other_kind), key=_RANK.index)], (title, other, point)
            needed.add((round(point[0]), round(point[1])))
    assert {(round(x), round(y)) for _, (x, y) in arches} == needed


_RANK = ("pipe", "tap", "signal")


def _crossing(piece, across):
    """Where two pieces of lines cross in their middles; None where they only meet."""
    (x1, y1), (x2, y2) = piece
    (a1, b1), (a2, b2) = across
    if x1 == x2 and b1 == b2:
        return _crossing(across, piece)
    if y1 != y2 or a1 != a2:
        return None
    inside = min(x1, x2) + 1.0 < a1 < max(x1, x2) - 1.0
    return (a1, y1) if inside and min(b1, b2) + 1.0 < y1 < max(b1, b2) - 1.0 else None


def _check_words(drawn):
    """Words are inside the picture, and strike neither each other nor the wall of a vessel."""
    for text, box in drawn.words:
        assert box[0] >= 0.0 and box[2] <= drawn.width, (text.text, box, drawn.width)
        assert box[1] >= 0.0 and box[3] <= drawn.height, (text.text, box, drawn.height)
        for vessel in (*drawn.vessels, *drawn.basins):
            inside = vessel[0] <= box[0] and box[2] <= vessel[2]
            inside = inside and vessel[1] <= box[1] and box[3] <= vessel[3]
            assert inside or not overlap(box, vessel), (text.text, box, vessel)
        if "inside" not in text.get("class", "") and "tag" not in text.get("class", ""):
            for kind, lines in drawn.lines.items():
                for title, pieces, _ in lines:
                    struck = [p for p in pieces if overlap(box_of(p, 0.6), box)]
                    assert not struck, (text.text, box, kind, title, struck)
    for place, (text, box) in enumerate(drawn.words):
        for other, beside in drawn.words[:place]:
            assert not overlap(box, beside), (text.text, other.text, box, beside)
