"""Axes of small pictures: round numbers at their ticks, and curves where they belong."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clepsydra.report.small_axes import Axes, Curve, ticks

FRAME = Axes(left=10.0, top=20.0, width=100.0, height=50.0, x=(0.0, 10.0), y=(-1.0, 1.0))


def points_of(shape):
    """The points of each part of a path of straight lines."""
    data = ElementTree.fromstring(shape).get("d")
    parts = [re.findall(r"-?[\d.]+", part) for part in data.split("M")[1:]]
    return [np.reshape([float(number) for number in part], (-1, 2)).tolist() for part in parts]


@given(low=st.floats(-1e6, 1e6), power=st.floats(-6.0, 6.0))
def test_a_few_ticks_lie_between_the_ends_and_say_where_they_are(low, power):
    span = max(10.0**power, 1e-6 * abs(low))
    found = ticks(low, low + span)
    assert 1 <= len(found) <= 4
    places = np.array(list(found))
    assert np.all((places >= low - 1e-5 * span) & (places <= low + span * (1.0 + 1e-5)))
    told = [float(words.replace("−", "-")) for words in found.values()]
    assert told == pytest.approx(places, rel=1e-9, abs=1e-9 * span)
    assert len(set(found.values())) == len(found)


def test_a_curve_goes_through_its_points_and_is_broken_where_it_is_not_finite():
    y = np.array([-1.0, 0.0, np.nan, np.inf, 1.0, 0.5])
    curve = Curve(np.array([0.0, 1.0, 2.0, 3.0, 5.0, 10.0]), y, "#0072B2")
    first, second = points_of(FRAME.curve(curve))
    assert first == [[10.0, 70.0], [20.0, 45.0]]
    assert second == [[60.0, 20.0], [110.0, 32.5]]
    assert FRAME.curve(Curve(curve.x, np.full(6, np.nan), "#0072B2")) == ""


def test_what_is_held_goes_level_and_then_up():
    curve = Curve(np.array([0.0, 5.0, 10.0]), np.array([0.0, 1.0, -1.0]), "#0072B2", held=True)
    (points,) = points_of(FRAME.curve(curve))
    assert points == [[10.0, 45.0], [60.0, 45.0], [60.0, 20.0], [110.0, 20.0], [110.0, 70.0]]


@pytest.mark.parametrize(("named", "below"), [(True, ["0", "5", "10"]), (False, [])])
def test_ticks_are_named_beside_their_places(named, below):
    shapes = [ElementTree.fromstring(shape) for shape in FRAME.frame(named=named)]
    words = [shape for shape in shapes if shape.tag == "text"]
    right = [each.text for each in words if each.get("text-anchor") == "middle"]
    up = {each.text: float(each.get("y")) for each in words if each.get("text-anchor") == "end"}
    assert right == below
    assert list(up) == ["−1", "0", "1"]
    assert np.diff(list(up.values())) == pytest.approx([-25.0, -25.0], abs=0.11)
