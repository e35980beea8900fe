"""Lie derivatives against differences, against integration, and what has none."""

from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from written_plants import plant_of

from clepsydra.linear.analysis import analyse
from clepsydra.linear.lie_derivatives import (
    NotLinearisable,
    input_affine_equations,
    lie_derivative,
)
from clepsydra.linear.linear_model import InternalDelays
from clepsydra.linear.relative_degree import relative_degree
from clepsydra.process.catalogue_names import catalogue_file
from clepsydra.process.reader import load_process

PROCESSES = ["quadruple-tank", "laboratory-four-tanks", "three-tanks", "wet-well"]


def sizes(equations):
    rest = np.abs(equations.point.state)
    return np.where(rest > 0.0, rest, 1.0)


def states_near(equations, count, seed=3):
    """States in which every tank holds water and no level equals its neighbour's."""
    random = np.random.default_rng(seed)
    rest = equations.point.state
    return rest * random.uniform(0.85, 1.15, (count, len(rest)))


@pytest.mark.parametrize("name", PROCESSES)
def test_each_derivative_is_the_slope_of_the_one_before_along_the_drift(name):
    found = relative_degree(analyse(load_process(name)).model)
    equations = found.equations
    for x in states_near(equations, 5):
        f = equations.at(equations.drift, x).ravel()
        step = 1e-5 / np.max(np.abs(f / sizes(equations)))
        for chain in found.derivatives:
            for before, after in pairwise(chain):
                up, down = (equations.at(before, x + sign * step * f) for sign in (1.0, -1.0))
                slope = float((up - down)[0, 0]) / (2.0 * step)
                assert float(equations.at(after, x)[0, 0]) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("name", PROCESSES)
def test_inputs_act_by_the_effects_and_by_nothing_else(name):
    """L + E u is how fast the last derivative below changes along the whole of ẋ = f + G u."""
    found = relative_degree(analyse(load_process(name)).model)
    equations = found.equations
    at = equations.point.as_dict()
    rest = np.array([at[each] for each in equations.inputs])
    for x, share in zip(states_near(equations, 4), (0.7, 0.9, 1.1, 1.3), strict=True):
        u = share * rest
        rates = equations.at(equations.rates, x, u).ravel()
        assert equations.at(equations.drift + equations.fields @ equations.moved, x, u).ravel() == (
            pytest.approx(rates, rel=1e-12, abs=1e-18)
        )
        promised = equations.at(found.drift + found.decoupling @ equations.moved, x, u).ravel()
        step = 1e-5 / np.max(np.abs(rates / sizes(equations)))
        for j, chain in enumerate(found.derivatives):
            below = chain[-2]
            up, down = (equations.at(below, x + sign * step * rates, u) for sign in (1.0, -1.0))
            slope = float((up - down)[0, 0]) / (2.0 * step)
            assert promised[j] == pytest.approx(slope, rel=1e-5, abs=1e-12)


def test_the_third_derivative_of_a_level_is_that_of_an_integrated_run():
    """Three tanks in series: integrated by SciPy, differentiated by a Taylor polynomial."""
    from scipy.integrate import solve_ivp

    found = relative_degree(analyse(load_process("three-tanks")).model)
    equations = found.equations
    x0 = equations.point.state * np.array([1.1, 0.95, 1.05])
    u = 1.2 * np.array([equations.point.as_dict()["feed"]])
    constants = [each.value for each in equations.constants]
    symbols = [
        equations.state,
        equations.moved,
        ca.vertcat(*(c.symbol for c in equations.constants)),
    ]
    rates = ca.Function("rates", symbols, [equations.rates])
    times = np.linspace(0.0, 4.0, 41)
    run = solve_ivp(
        lambda _, x: np.array(rates(x, u, constants)).ravel(),
        (0.0, 4.0), x0, "DOP853", times, rtol=1e-13, atol=1e-15,
    )  # fmt: skip
    level = run.y[2]
    third = 6.0 * np.polynomial.polynomial.polyfit(times, level, 7)[3]
    promised = equations.at(found.drift + found.decoupling @ equations.moved, x0, u)[0, 0]
    assert found.degrees == (3,)
    assert promised == pytest.approx(third, rel=1e-5)
    # The input's own share is what is tested: without it the derivative is another.
    assert abs(equations.at(found.drift, x0, u)[0, 0] - third) > 0.1 * abs(third)


def test_the_bracket_free_rule_of_products():
    x = ca.SX.sym("x", 2)
    field = ca.vertcat(x[1], -x[0])
    product = lie_derivative(x[0] * x[1], field, x)
    expected = x[1] * x[1] - x[0] * x[0]
    value = ca.Function("difference", [x], [product - expected])([0.3, -1.7])
    assert float(value) == pytest.approx(0.0, abs=1e-15)


def test_a_pump_with_a_dead_band_acts_by_the_piece_it_runs_in(tmp_path):
    text = catalogue_file("quadruple-tank").read_text("utf-8")
    edit = 'nominal = "3.00 V"', 'nominal = "3.00 V"\ndead_band = "0.5 V"'
    equations = input_affine_equations(plant_of(tmp_path, text, edit).analysis.model)
    plain = input_affine_equations(analyse(load_process("quadruple-tank")).model)
    assert equations.at(equations.fields) == pytest.approx(plain.at(plain.fields))
    x = equations.point.state
    # Half a volt less of what the pumps of the plain process do.
    less = plain.at(plain.drift, x).ravel() - 0.5 * plain.at(plain.fields).sum(axis=1)
    assert equations.at(equations.drift, x).ravel() == pytest.approx(less, rel=1e-12)


def test_a_product_of_inputs_is_refused_by_name():
    with pytest.raises(NotLinearisable, match=r"inflow, inflow\.impurity"):
        input_affine_equations(analyse(load_process("averaging-tank")).model)


def test_dead_time_is_refused():
    late = load_process(Path(__file__).parents[1] / "dead-time.toml")
    model = analyse(late).model
    assert isinstance(model.delays, InternalDelays)
    with pytest.raises(NotLinearisable, match="dead time"):
        input_affine_equations(model)
