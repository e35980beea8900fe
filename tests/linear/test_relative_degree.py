"""Relative degrees and decoupling matrices against closed forms, and their refusals."""

import dataclasses

import numpy as np
import pytest

from clepsydra import LinearModel
from clepsydra.linear.analysis import analyse
from clepsydra.linear.lie_derivatives import NotLinearisable
from clepsydra.linear.linearise import linearise
from clepsydra.linear.relative_degree import linear_relative_degrees, relative_degree
from clepsydra.process.reader import load_process


def test_the_decoupling_matrix_of_four_tanks_is_gamma_k_over_area():
    found = relative_degree(analyse(load_process("quadruple-tank")).model)
    # 0.50 V/cm · γ k / A of Johansson's table I.
    by_hand = np.diag([0.5 * 0.70 * 3.33 / 28.0, 0.5 * 0.60 * 3.35 / 32.0])
    assert found.degrees == (1, 1)
    assert found.at_point == pytest.approx(by_hand, rel=1e-12, abs=1e-18)


@pytest.mark.parametrize("name", ["quadruple-tank", "three-tanks", "wet-well", "equalisation-tank"])
def test_effects_are_the_markov_parameters_of_the_linear_model(name):
    model = analyse(load_process(name)).model
    found = relative_degree(model)
    for j, degree in enumerate(found.degrees):
        row = model.C[j] @ np.linalg.matrix_power(model.A, degree - 1) @ model.B
        assert found.at_point[j] == pytest.approx(row, rel=1e-9)
        for earlier in range(degree - 1):
            early = model.C[j] @ np.linalg.matrix_power(model.A, earlier) @ model.B
            assert np.max(np.abs(early)) == 0.0


def test_inputs_that_cross_are_paired_by_the_largest_pivots():
    found = relative_degree(analyse(load_process("averaging-tank:inflow-constant")).model)
    assert dict(found.order) == {0: 1, 1: 0}
    assert found.at_point[0, 0] == 0.0 == found.at_point[1, 1]


def test_a_chain_too_long_is_refused_with_its_length():
    with pytest.raises(NotLinearisable, match="level_8, relative degree: got 8"):
        relative_degree(analyse(load_process("eight-tanks")).model)


def test_an_output_that_no_input_moves_has_none():
    A, B = np.diag([-1.0, -2.0]), np.array([[1.0], [0.0]])
    model = LinearModel(
        A, B, B[:, :0], np.array([[0.0, 1.0]]), np.zeros((1, 1)), ("a", "b"), ("u",), (), ("y",)
    )
    with pytest.raises(NotLinearisable, match="an input that moves it"):
        linear_relative_degrees(model)


def test_outputs_that_answer_to_the_same_pump_have_a_singular_decoupling_matrix():
    """Tanks 1 and 4 are fed by pump 1 alone at first, so that pump 2 decides nothing."""
    point = analyse(load_process("quadruple-tank")).operating_point
    with pytest.raises(NotLinearisable, match="decoupling matrix is singular"):
        relative_degree(linearise(point).select(outputs=["level_1", "level_4"]))


def test_more_outputs_than_inputs_are_refused():
    model = analyse(load_process("quadruple-tank")).model
    with pytest.raises(NotLinearisable, match="as many as there are inputs"):
        relative_degree(model.select(outputs=["level_1"]))


def test_the_relative_degree_does_not_depend_on_units():
    model = analyse(load_process("three-tanks")).model
    scale = np.array([1e-6, 1e3, 1e9])
    other = dataclasses.replace(
        model, A=model.A * scale / scale[:, None], B=1e-7 * model.B / scale[:, None],
        C=1e8 * model.C * scale, E=model.E / scale[:, None],
    )  # fmt: skip
    assert linear_relative_degrees(other) == linear_relative_degrees(model) == (3,)
