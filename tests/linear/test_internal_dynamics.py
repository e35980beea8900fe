"""Internal dynamics: transmission zeros by another route, a formula, and a run that shows them."""

import numpy as np
import pytest

from clepsydra import LinearModel
from clepsydra.linear.analysis import analyse
from clepsydra.linear.internal_dynamics import internal_dynamics
from clepsydra.linear.zeros import zeros
from clepsydra.process.reader import load_process

#: γ1, γ2 of Johansson's table I.
SPLITS = {"quadruple-tank": (0.70, 0.60), "quadruple-tank-nonminimum-phase": (0.43, 0.34)}


@pytest.mark.parametrize("name", SPLITS)
def test_modes_are_the_zeros_of_johanssons_formula(name):
    """(1 + s T3) (1 + s T4) = (1 − γ1) (1 − γ2) / (γ1 γ2), his equation for the zeros."""
    model = analyse(load_process(name)).model
    T3, T4 = (-1.0 / model.A[k, k] for k in (2, 3))
    g1, g2 = SPLITS[name]
    ratio = (1 - g1) * (1 - g2) / (g1 * g2)
    by_formula = np.sort(np.roots([T3 * T4, T3 + T4, 1.0 - ratio]).real)[::-1]
    found = internal_dynamics(model)
    assert found.modes.real == pytest.approx(by_formula, rel=1e-9)
    assert zeros(model).real == pytest.approx(by_formula, rel=1e-9)
    assert found.stable == (g1 + g2 > 1.0)


def test_the_words_name_what_runs_away():
    words = internal_dynamics(analyse(load_process("quadruple-tank-nonminimum-phase")).model).words
    assert "tank_3.level and tank_4.level run away" in words
    assert "78.4 s" in words  # 1 / 0.01276 rad/s


def test_what_no_output_shows_counts_beside_the_zeros():
    """The level of the basin alone is controlled: mixing and a slow sensor are modes, no zeros."""
    process = load_process("equalisation-tank")
    model = analyse(process).model
    assert not len(zeros(model))
    found = internal_dynamics(model)
    own = np.sort(np.diag(model.A)[1:])[::-1]
    assert found.modes.real == pytest.approx(own, rel=1e-9)
    assert found.stable


def test_a_hidden_integrator_is_no_rest():
    A, B = np.diag([-1.0, 0.0]), np.array([[1.0], [1.0]])
    model = LinearModel(
        A, B, B[:, :0], np.array([[1.0, 0.0]]), np.zeros((1, 1)), ("a", "b"), ("u",), (), ("y",)
    )
    found = internal_dynamics(model)
    assert not found.stable
    assert "never comes to rest" in found.words


def test_with_a_full_relative_degree_nothing_is_hidden():
    found = internal_dynamics(analyse(load_process("three-tanks")).model)
    assert found.stable
    assert not len(found.modes)


def test_directions_leave_the_outputs_at_rest():
    model = analyse(load_process("quadruple-tank-nonminimum-phase")).model
    found = internal_dynamics(model)
    assert model.C @ found.directions == pytest.approx(0.0, abs=1e-12)
    # Along a direction and with the inputs that hold the outputs, ẋ = z x.
    x, z = found.directions[:, 0], found.modes[0]
    u = -np.linalg.solve(model.C @ model.B, model.C @ model.A @ x)
    assert model.A @ x + model.B @ u == pytest.approx(z * x, rel=1e-9, abs=1e-15)
