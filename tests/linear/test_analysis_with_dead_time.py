"""The whole analysis of a process with dead time, against closed forms of two tanks in a row."""

import json
from pathlib import Path

import numpy as np
import pytest

from clepsydra.linear.analysis import analyse
from clepsydra.linear.response import frequency_response
from clepsydra.process.reader import load_process

FILE = Path(__file__).parents[1] / "dead-time.toml"
FLOW, AREAS, HOLES, GRAVITY, DELAY = 5e-5, (0.01, 0.03), (0.3e-4, 0.25e-4), 9.81, 5.0


def rates():
    """Return 1/T of each tank: T = 2 h A / q at rest."""
    levels = [(FLOW / hole) ** 2 / (2 * GRAVITY) for hole in HOLES]
    return [FLOW / (2 * level * area) for level, area in zip(levels, AREAS, strict=True)]


@pytest.fixture(scope="module")
def analysis():
    return analyse(load_process(FILE))


def test_poles_gain_and_dead_time(analysis):
    fast, slow = sorted(rates(), reverse=True)
    assert analysis.poles.real == pytest.approx([-slow, -fast], rel=1e-9)
    assert analysis.dead_times.tolist() == [[DELAY]]
    assert analysis.static_gain[0, 0] == pytest.approx(1.0 / AREAS[1] / rates()[1], rel=1e-9)
    assert not analysis.minimum_phase
    assert any("dead time of 5 s" in word for word in analysis.words)


def test_frequency_response_is_the_closed_form(analysis):
    s = 1j * np.array([0.001, 0.02, 0.3])
    expected = rates()[0] / AREAS[1] * np.exp(-DELAY * s) / ((s + rates()[0]) * (s + rates()[1]))
    found = frequency_response(analysis.model, s.imag)[:, 0, 0]
    assert found == pytest.approx(expected, rel=1e-9)


def test_singular_values_are_the_magnitude_in_ranges(analysis):
    found = analysis.directionality
    s = 1j * found.frequencies
    size = np.abs(rates()[0] / AREAS[1] / ((s + rates()[0]) * (s + rates()[1])))
    scale = (8e-3 / 60) / 0.5
    assert found.singular_values[:, 0] == pytest.approx(size * scale, rel=1e-9)
    assert found.relative_gains[:, 0, 0] == pytest.approx(np.ones(len(s)), rel=1e-12)


@pytest.mark.thorough
def test_reach_and_hankel_values(analysis):
    assert [mode.state for mode in analysis.reach.controllability] == [
        "tank_2.level",
        "tank_1.level",
    ]
    # The largest Hankel singular value is at least half of |G(0)|, since |G| is at most twice
    # their sum, and here the first carries most of it.
    gain = analysis.directionality.singular_values[0, 0]
    assert analysis.reach.hankel.values[0] > 0.5 * gain


def test_json_names_it_all(analysis):
    document = json.loads(json.dumps(analysis.as_dict(), allow_nan=False))
    assert document["dead_times"] == [[5.0]]
    assert document["units"]["dead_times"] == "s"
    assert set(document["units"]) >= {"singular_values", "frequencies", "hankel_singular_values"}
    assert len(document["directionality"]["relative_gains"][0]) == 1


def test_zero_directions_of_the_quadruple_tank_block():
    analysis = analyse(load_process("quadruple-tank-nonminimum-phase"))
    (found,) = analysis.right_half_plane_zeros
    assert found.zero == pytest.approx(analysis.zeros[0], rel=1e-9)
    process, model = analysis.operating_point.process, analysis.model
    spans = np.array([[process.signal(name).span for name in group] for group in
                      (model.outputs, model.inputs)])  # fmt: skip
    s = found.zero
    gain = model.C @ np.linalg.solve(s * np.eye(4) - model.A, model.B)
    in_ranges = gain * spans[1] / spans[0][:, None]
    assert np.abs(in_ranges @ found.input_direction).max() < 1e-9 * np.abs(in_ranges).max()
    assert np.abs(found.output_direction.conj() @ in_ranges).max() < 1e-9


def test_words_name_a_mode_that_no_input_moves():
    words = analyse(load_process("equalisation-tank")).words
    assert any("No input moves" in word and "strength.lagged" in word for word in words)
