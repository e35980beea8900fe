"""Figures keep within their picture, whatever they show."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.figure_picture import drawn

TIME = np.linspace(0.0, 10.0, 400)


def picture(*panels):
    return drawn(Figure("Fig. 1", "a < b", tuple(panels)))


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_panels_and_all_their_words_stand_apart_and_inside(number):
    names = ["level", "setpoint", "what the document shows", "what is found with its numbers"]
    curves = tuple(Curve(name, TIME, np.sin(TIME)) for name in names)
    whole = picture(*[Panel(f"panel {i}", "level [m]", curves) for i in range(number)])
    FigureCanvasAgg(whole).draw()
    boxes = [axes.get_tightbbox() for axes in whole.axes]
    assert len(boxes) == number
    for axes, box in zip(whole.axes, boxes, strict=True):
        assert [text.get_text() for text in axes.get_legend().get_texts()] == names
        assert 0.0 <= box.x0 < box.x1 <= whole.bbox.x1, box
        assert 0.0 <= box.y0 < box.y1 <= whole.bbox.y1, box
    for one, two in combinations(boxes, 2):
        assert not one.overlaps(two)


def test_one_label_has_one_colour_in_all_panels():
    ours, other = Curve("ours", TIME, TIME), Curve("theirs", TIME, -TIME)
    first, second = picture(Panel("", "a", (ours, other)), Panel("", "b", (ours,))).axes
    one, two = (line.get_color() for line in first.lines)
    assert one == second.lines[0].get_color() != two


@pytest.mark.parametrize("value", [0.0, 5.0, -1e-9])
def test_a_flat_line_stands_in_the_middle(value):
    (axes,) = picture(Panel("", "level [m]", (Curve("level", TIME, np.full(400, value)),))).axes
    low, high = axes.get_ylim()
    assert (low + high) / 2 == pytest.approx(value, abs=1e-12 + 1e-6 * (high - low))


def test_what_is_not_positive_is_left_out_of_logarithmic_axes():
    panel = Panel("", "|G|", (Curve("gain", TIME, TIME - 5.0),), "ω [rad/s]", True, True)
    (line,) = picture(panel).axes[0].lines
    shown = np.isfinite(line.get_xdata()) & np.isfinite(line.get_ydata())
    assert np.array_equal(shown, TIME > 5.0)


def test_a_curve_has_a_value_for_each_place():
    with pytest.raises(ValueError, match="3 places and 2 values"):
        Curve("level", np.zeros(3), np.zeros(2))
