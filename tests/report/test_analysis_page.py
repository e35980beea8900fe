"""The page of an analysis: what it shows, and that its pictures show the right numbers."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.report.analysis_page import analysis_page_text
from clepsydra.report.analysis_pictures import (
    bode_figure,
    directionality_figure,
    nyquist_figure,
    roots_figure,
    step_figure,
)
from clepsydra.report.analysis_tables import dead_time_grid, hankel_grid, reach_grid

LATE = Path(__file__).parents[1] / "dead-time.toml"


@pytest.fixture(scope="module")
def late():
    return cl.load(LATE).analysis


def check_page(text):
    assert text.count("<svg") == 6
    identifiers = re.findall(r'\bid="([^"]+)"', text)
    assert len(identifiers) == len(set(identifiers))
    assert "<script" not in text
    assert "http" not in re.sub(r'(xmlns(:xlink)?|http-equiv)="[^"]*"', "", text)


@pytest.fixture(scope="module")
def page(late):
    return analysis_page_text(late)


@pytest.mark.thorough
def test_a_process_with_dead_time_has_a_page(page):
    check_page(page)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["quadruple-tank", "averaging-tank"])
def test_every_process_has_a_page(name):
    check_page(analysis_page_text(cl.load(name).analysis))


@pytest.mark.thorough
def test_two_pages_of_one_analysis_are_equal(late, page):
    assert analysis_page_text(late) == page


def line(axes):
    """Return the curve with the most points."""
    return max(axes.lines, key=lambda entry: len(entry.get_xdata()))


def test_bode_phase_counts_the_dead_time(late):
    magnitude, phase = bode_figure(late).axes
    curve = line(phase)
    omegas, angles = curve.get_xdata(), np.radians(curve.get_ydata())
    expected = -5.0 * omegas + sum(np.arctan2(-omegas, -pole.real) for pole in late.poles)
    assert angles == pytest.approx(expected, abs=1e-8)
    assert omegas[-1] * 5.0 > 2 * np.pi  # far enough to be seen
    assert magnitude.get_ylabel() == "cm/(l/min)"
    # At the lowest frequency the gain is the static one, in cm per l/min.
    gain = line(magnitude).get_ydata()[0]
    assert gain == pytest.approx(100 / 6e4 * late.static_gain[0, 0], rel=1e-2)


def test_the_step_stays_at_zero_for_the_dead_time(late):
    axes = step_figure(late).axes[0]
    curve = line(axes)
    seconds = 60.0 if "min" in axes.get_xlabel() else 1.0
    times, values = curve.get_xdata() * seconds, curve.get_ydata()
    assert np.all(values[times <= 5.0] == 0.0)
    assert np.all(values[times > 5.01] > 0.0)
    assert len(step_figure(late).axes[0].child_axes) == 1
    step = 0.1 * 8e-3 / 60
    # After five time constants 1 - e^-5 and what the second lag still holds back.
    assert values[-1] == pytest.approx(100 * step * late.static_gain[0, 0], rel=0.02)


def test_nyquist_starts_at_the_static_gain_in_ranges(late):
    curve = line(nyquist_figure(late).axes[0])
    curves = [entry for entry in nyquist_figure(late).axes[0].lines if len(entry.get_xdata()) > 200]
    starts = [entry.get_xdata()[0] for entry in curves]
    share = late.static_gain[0, 0] * (8e-3 / 60) / 0.5
    assert min(abs(start / share - 1) for start in starts) < 1e-2
    assert len(curve.get_xdata()) > 100


@pytest.fixture(scope="module")
def averaging():
    return cl.load("averaging-tank:all-inputs").analysis


@pytest.mark.parametrize("draw", [step_figure, nyquist_figure])
def test_a_channel_without_effect_says_so(averaging, draw):
    # Equation (24) at rest: what flows in is as strong as what is there, so only its own
    # strength moves the concentration, and strength moves no volume.
    silent = [
        "no effect" in [entry.get_text() for entry in axes.texts] for axes in draw(averaging).axes
    ]
    assert averaging.model.inputs == ("inflow", "outflow", "inflow.impurity")
    assert averaging.model.outputs == ("concentration", "volume")
    assert silent == [True, True, False, False, False, True]


@pytest.mark.parametrize("draw", [step_figure, nyquist_figure, bode_figure])
def test_a_narrow_panel_still_names_its_input(averaging, draw):
    titles = [axes.get_title(loc="left") for axes in draw(averaging).axes]
    named = [words for words in titles if words]
    assert len(set(named)) == len(named) == 6
    assert "inflow" in named[0] and "outflow" in named[1]
    assert max(len(row) for words in named for row in words.splitlines()) <= 24


def test_only_what_is_there_is_in_the_legend_of_roots(averaging):
    for analysis in (averaging, cl.load("quadruple-tank").analysis):
        legend = roots_figure(analysis).axes[0].get_legend()
        words = [entry.get_text() for entry in legend.get_texts()]
        assert words == ["pole", "zero"][: 1 + (analysis.zeros.size > 0)]


def test_one_channel_has_singular_values_alone(late):
    assert [axes.get_ylabel() for axes in directionality_figure(late).axes] == [
        "singular values [% per %]"
    ]


def test_every_relative_gain_of_three_by_three_is_named():
    B, levels, pumps = np.array([[5.0, 1, 2], [1, 4, 0.5], [3, 2, 6]]), "abc", "uvw"
    model = cl.LinearModel(
        -np.diag([0.1, 0.2, 0.3]), B, B[:, :0], np.eye(3), 0.0 * B,
        tuple(levels), tuple(pumps), (), tuple(levels),
    )  # fmt: skip
    analysis = SimpleNamespace(model=model, poles=np.diag(model.A), zeros=np.zeros(0), pairing=())
    axes = directionality_figure(analysis).axes[0]
    words = {entry.get_text() for entry in axes.get_legend().get_texts()}
    assert words == {f"{level} by {pump}" for level in levels for pump in pumps}


def test_tables(late):
    assert dead_time_grid(late).rows == (("level_2", "5.00 s"),)
    assert [row[1] for row in reach_grid(late).rows] == ["tank_2.level", "tank_1.level"]
    assert len(hankel_grid(late).rows) >= 2


@pytest.mark.thorough
def test_an_integrator_is_named_among_the_hankel_values():
    grid = hankel_grid(cl.load("averaging-tank").analysis)
    assert "none for the pole at 0 rad/s" in grid.rows[-1][1]
