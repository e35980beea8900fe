"""Figures keep within their picture, whatever they show."""

import re
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest

from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.figure_svg import figure_svg

TIME = np.linspace(0.0, 10.0, 400)
SVG = "{http://www.w3.org/2000/svg}"


def _svg(*panels):
    return figure_svg(Figure("Fig. 1", "a < b", tuple(panels)), "p")


def _words(picture):
    """Return each text with the room that it takes (left, top, right, bottom) [pt]."""
    for word in picture.iter(f"{SVG}text"):
        x, y, half = float(word.attrib["x"]), float(word.attrib["y"]), 2.0 * len(word.text)
        shift = {"start": half, "middle": 0.0, "end": -half}[word.get("text-anchor", "start")]
        if "transform" in word.attrib:  # turned by a quarter to the left
            yield word.text, (x - 5.5, y - half, x + 1.5, y + half)
        else:
            yield word.text, (x + shift - half, y - 5.5, x + shift + half, y + 1.5)


def _axes(picture):
    """Return the box of each panel, from the line down its left side and along its floor."""
    for path in picture.iter(f"{SVG}path"):
        ends = re.fullmatch(r"M([\d.]+) ([\d.]+)V([\d.]+)H([\d.]+)", path.attrib["d"])
        if ends:
            left, top, bottom, right = map(float, ends.groups())
            yield f"axes at {left}, {top}", (left, top, right, bottom)


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_panels_and_all_their_words_stand_apart_and_inside(number):
    names = ["level", "setpoint", "what the document shows", "what is found with its numbers"]
    curves = tuple(Curve(name, TIME, np.sin(TIME)) for name in names)
    text = _svg(*[Panel(f"panel {i}", "level [m]", curves) for i in range(number)])
    picture = ElementTree.fromstring(text)
    width, height = map(float, picture.attrib["viewBox"].split()[2:])
    words, boxes = list(_words(picture)), list(_axes(picture))
    assert len(boxes) == number
    for each in (*(f"panel {i}" for i in range(number)), "level [m]", *names, "time [s]"):
        expected = 1 if each.startswith("panel") else number
        assert [word for word, _ in words].count(each) == expected
    for thing, (left, top, right, bottom) in words + boxes:
        assert 0.0 <= left < right <= width and 0.0 <= top < bottom <= height, thing
    for (thing, one), (other, two) in combinations(words + boxes, 2):
        apart = one[2] <= two[0] or two[2] <= one[0] or one[3] <= two[1] or two[3] <= one[1]
        assert apart, (thing, other)


def test_one_label_has_one_colour_in_all_panels():
    ours, other = Curve("ours", TIME, TIME), Curve("theirs", TIME, -TIME)
    text = _svg(Panel("", "a", (ours, other)), Panel("", "b", (ours,)))
    strokes = re.findall(r'<line|stroke="(#\w{6})" stroke-width="1\.4"', text)
    colours = [colour for colour in strokes if colour]
    assert len(colours) == 3 and colours[0] == colours[2] != colours[1]


@pytest.mark.parametrize("value", [0.0, 5.0, -1e-9, np.nan])
def test_a_flat_line_stands_in_the_middle_and_missing_values_nowhere(value):
    panel = Panel("", "level [m]", (Curve("level", TIME, np.full(400, value)),))
    picture = ElementTree.fromstring(_svg(panel))
    ((_, (left, top, right, bottom)),) = _axes(picture)
    lines = [path.attrib["d"] for group in picture.iter(f"{SVG}g") for path in group]
    middle = f"M{10 * left:.0f} {5 * (top + bottom):.0f}l{10 * (right - left):.0f} 0"
    assert lines == ([] if np.isnan(value) else [middle])


def test_what_is_not_positive_is_left_out_of_logarithmic_axes():
    panel = Panel(
        "", "|G|", (Curve("gain", TIME, 1.0 / (1.0 + TIME)),), "ω [rad/s]", True, True
    )  # fmt: skip
    text = _svg(panel)
    assert "nan" not in text.lower() and "inf" not in text.lower()


def test_a_curve_has_a_value_for_each_place():
    with pytest.raises(ValueError, match="3 places and 2 values"):
        Curve("level", np.zeros(3), np.zeros(2))
