"""Figures keep within their picture, whatever they show."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.figure_svg import figure_svg

TIME = np.linspace(0.0, 10.0, 400)


def _svg(*panels):
    return figure_svg(Figure("Fig. 1", "a < b", tuple(panels)), "p")


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_panels_stand_apart_and_inside(number):
    curves = (Curve("level", TIME, np.sin(TIME)), Curve("setpoint", TIME, 0 * TIME, "dashed"))
    text = _svg(*[Panel(f"panel {i}", "level [m]", curves) for i in range(number)])
    picture = ElementTree.fromstring(text)
    width, height = map(float, picture.attrib["viewBox"].split()[2:])
    assert text.count("level [m]") == number
    words = [e for e in picture.iter() if e.tag.endswith("text") and e.text]
    for word in words:
        assert 0.0 <= float(word.attrib["x"]) <= width
        assert 0.0 <= float(word.attrib["y"]) <= height
    places = {e.attrib["y"]: [] for e in words}
    for word in words:
        places[word.attrib["y"]].append(word.text)
    titles = [word.text for word in words if (word.text or "").startswith("panel")]
    assert titles == [f"panel {i}" for i in range(number)]


def test_one_label_has_one_colour_in_all_panels():
    ours, other = Curve("ours", TIME, TIME), Curve("theirs", TIME, -TIME)
    text = _svg(Panel("", "a", (ours, other)), Panel("", "b", (ours,)))
    strokes = re.findall(r'<line|stroke="(#\w{6})" stroke-width="1\.4"', text)
    colours = [colour for colour in strokes if colour]
    assert len(colours) == 3 and colours[0] == colours[2] != colours[1]


@pytest.mark.parametrize("values", [np.zeros(400), np.full(400, 5.0), np.full(400, np.nan), TIME])
def test_flat_and_missing_values_are_drawn(values):
    ElementTree.fromstring(_svg(Panel("", "level [m]", (Curve("level", TIME, values),))))


def test_what_is_not_positive_is_left_out_of_logarithmic_axes():
    panel = Panel(
        "", "|G|", (Curve("gain", TIME, 1.0 / (1.0 + TIME)),), "ω [rad/s]", True, True
    )  # fmt: skip
    text = _svg(panel)
    assert "nan" not in text.lower() and "inf" not in text.lower()


def test_a_curve_has_a_value_for_each_place():
    with pytest.raises(ValueError, match="3 places and 2 values"):
        Curve("level", np.zeros(3), np.zeros(2))
