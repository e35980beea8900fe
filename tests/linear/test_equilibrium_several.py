"""Several equilibria, ways round a stuck search, states without a floor, sensors out of range."""

from __future__ import annotations

import dataclasses

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq

from clepsydra import Signal
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibria, find_equilibrium
from clepsydra.linear.equilibrium_continuation import by_homotopy, by_pseudo_transient
from clepsydra.linear.equilibrium_request import read_request
from clepsydra.linear.equilibrium_search import EquilibriumSearch
from clepsydra.process.reader import load_process


def wavy(level):
    """An outflow that falls here and there while the level rises."""
    return 2.0 * level + 0.6 * ca.sin(25.0 * level)


def wavy_number(level):
    return 2.0 * level + 0.6 * np.sin(25.0 * level)


@pytest.fixture
def three_rests(make_process):
    return make_process(
        lambda x, u, d: [-(x[0] - 0.2) * (x[0] - 0.5) * (x[0] - 0.85) + 0.0 * u[0]], 1, 1
    )


def test_all_three_equilibria_of_a_cubic(three_rests):
    found = find_equilibria(three_rests)
    levels = sorted(float(point.state[0]) for point in found)
    assert levels == pytest.approx([0.2, 0.5, 0.85], rel=1e-12)


def test_the_first_is_that_of_find_equilibrium_and_names_another(three_rests):
    found = find_equilibria(three_rests)
    np.testing.assert_array_equal(found[0].state, find_equilibrium(three_rests).state)
    assert "there is another equilibrium" in found[0].warnings[-1]
    assert any(
        "another equilibrium" in word for word in analyse(three_rests).operating_point.warnings
    )


def test_one_equilibrium_has_no_warning(minimum):
    found = find_equilibria(minimum.process)
    assert len(found) == 1
    assert found[0].warnings == ()


def test_a_level_left_open_is_one_point(make_process):
    process = make_process(lambda x, u, d: [u[0] - 5.0], 1, 1, initial=0.3)
    found = find_equilibria(process)
    assert len(found) == 1
    assert found[0].state[0] == pytest.approx(0.3)


@pytest.mark.parametrize("share", np.linspace(0.03, 0.97, 12).round(3).tolist())
@pytest.mark.parametrize("law", ["wavy", "cubic"])
def test_pseudo_transient_ends_where_the_motion_does(make_process, three_rests, law, share):
    """Between rests that attract it does not stay at the one that repels, nor jump over it."""
    wave = make_process(lambda x, u, d: [u[0] / 5.0 - wavy(x[0])], 1, 1)
    process, rate = {
        "wavy": (wave, lambda x: 1.0 - wavy_number(x)),
        "cubic": (three_rests, lambda x: -(x - 0.2) * (x - 0.5) * (x - 0.85)),
    }[law]
    search = EquilibriumSearch(process, read_request(process, None, None, None))
    state, _ = search.values(by_pseudo_transient(search, share).unknowns)
    # The motion of one state never turns: it ends at the first root on its way.
    grid = np.linspace(share, 1.0 if rate(share) > 0.0 else 0.0, 4000)
    signs = np.sign(rate(grid))
    change = int(np.flatnonzero(signs[1:] != signs[:-1])[0])
    expected = brentq(rate, *sorted(grid[change : change + 2]))
    assert state[0] == pytest.approx(expected, rel=1e-9)


def test_the_search_is_helped_where_newton_is_stuck(make_process):
    process = make_process(lambda x, u, d: [u[0] / 5.0 * 1.7 - wavy(x[0])], 1, 1)
    search = EquilibriumSearch(process, read_request(process, None, None, None))
    stuck = [share for share in np.linspace(0.02, 0.98, 25) if not search.run(share).solved]
    assert stuck  # otherwise this says nothing
    for share in stuck:
        state, _ = search.values(by_pseudo_transient(search, share).unknowns)
        assert wavy_number(state[0]) == pytest.approx(1.7, abs=1e-9)


def test_homotopy_reaches_the_asked_outputs(minimum):
    levels = minimum.levels((2.0, 3.5))
    asked = {"level_1": 50 * levels[0], "level_2": 50 * levels[1]}
    search = EquilibriumSearch(minimum.process, read_request(minimum.process, None, asked, None))
    _, inputs = search.values(by_homotopy(search).unknowns)
    assert inputs == pytest.approx((2.0, 3.5), rel=1e-11)


def with_state(process, signal):
    return dataclasses.replace(process, state=(process.state[0], signal))


def test_a_concentration_may_rest_at_zero(make_process):
    process = make_process(lambda x, u, d: [u[0] - 10 * x[0], -0.3 * x[1] * x[0]], 2, 1)
    salt = Signal("tank_1.salt", "kg/m^3", low=0.0, high=10.0, initial=2.0)
    point = find_equilibrium(with_state(process, salt))
    assert point.state == pytest.approx([0.5, 0.0], abs=1e-12)
    assert point.warnings == ()


def test_a_position_below_its_range_is_named(make_process):
    process = make_process(lambda x, u, d: [u[0] - 10 * x[0], -x[1] - 0.25], 2, 1)
    stem = Signal("valve_1.position", "1", low=0.0, high=1.0, initial=0.5)
    with pytest.raises(Exception, match=r"valve_1.position would be -0.25, below its range"):
        find_equilibrium(with_state(process, stem))


def test_a_sensor_beyond_its_range_warns(make_process):
    process = make_process(lambda x, u, d: [u[0] / 10 - x[0]], 1, 1)
    narrow = dataclasses.replace(process.measurements[0], low=0.0, high=0.4)
    point = find_equilibrium(dataclasses.replace(process, measurements=(narrow,)))
    assert "level_1 would read 0.5" in point.warnings[0]


def test_what_rounding_leaves_of_a_zero_is_a_zero():
    """The standby pump stands still: what one processor leaves of its speed another does not."""
    process = load_process("wet-well")
    search = EquilibriumSearch(process, read_request(process, None, None, None))
    unknowns = search.unknowns_at(*(search.values(search.run(None).unknowns)))
    left = search.unknown_names.index("standby.actual")
    for rounding in (0.0, 6e-27, -1e-17):
        state, _ = search.values(np.where(np.arange(len(unknowns)) == left, rounding, unknowns))
        assert state[left] == 0.0
