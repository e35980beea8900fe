"""Equilibria of many plants: each as it is found alone, and why others have none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.linear.equilibria import ManyEquilibria
from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium

PLANTS = (
    "quadruple-tank", "quadruple-tank-nonminimum-phase", "three-tanks", "averaging-tank",
    "eight-tanks", "laboratory-four-tanks", "wet-well", "equalisation-tank",
)  # fmt: skip


def spread(process, count, share, seed=3):
    """Return every parameter but gravity within a share of its value, independent of the others."""
    numbers = np.random.default_rng(seed)
    return {
        s.name: np.minimum(s.initial * numbers.uniform(1 - share, 1 + share, count), s.high)
        for s in process.parameters
        if s.initial and s.name != "gravity"
    }


def asked(plant):
    outputs, free = zip(*plant.analysis.pairing, strict=True)
    return ManyEquilibria(plant.point, outputs, free), outputs, free


def alone(plant, values, draw, outputs, free):
    """Return where one of them rests as the search for one finds it; None where nowhere."""
    parameters = tuple(
        replace(s, initial=float(values[s.name][draw])) if s.name in values else s
        for s in plant.process.parameters
    )
    at, process = plant.point.as_dict(), replace(plant.process, parameters=parameters)
    try:
        return find_equilibrium(
            process,
            inputs={u.name: at[u.name] for u in process.inputs if u.name not in free},
            outputs={name: at[name] for name in outputs},
            disturbances={d.name: at[d.name] for d in process.disturbances},
        )
    except NoEquilibrium:
        return None


@pytest.mark.parametrize("name", PLANTS)
def test_each_rests_where_the_search_for_one_finds_it(name):
    plant = cl.load(name)
    many, outputs, free = asked(plant)
    values = spread(plant.process, 60, 0.2)
    found = many.find(values)
    assert found.feasible.any()
    for draw in range(60):
        one = alone(plant, values, draw, outputs, free)
        assert (one is not None) == found.feasible[draw], found.reasons
        if one is not None:
            # Rounding in the unknowns: the search for one keeps fourteen digits.
            np.testing.assert_allclose(found.state[:, draw], one.state, rtol=1e-11, atol=1e-15)
            np.testing.assert_allclose(found.inputs[:, draw], one.inputs, rtol=1e-11)


def test_one_alone_rests_as_one_of_many_in_every_bit():
    plant = cl.load("quadruple-tank-nonminimum-phase")
    many, _, _ = asked(plant)
    values = spread(plant.process, 500, 0.3)
    together = many.find(values)
    assert 0 < together.feasible.sum() < 500
    for draw in (0, 7, 123, 499, *np.flatnonzero(~together.feasible)[:5]):
        one = many.find({name: column[[draw]] for name, column in values.items()})
        np.testing.assert_array_equal(one.state[:, 0], together.state[:, draw])
        np.testing.assert_array_equal(one.inputs[:, 0], together.inputs[:, draw])
        assert one.feasible[0] == together.feasible[draw]


def test_a_plant_with_the_numbers_of_the_point_rests_at_it():
    plant = cl.load("laboratory-four-tanks")
    many, _, _ = asked(plant)
    values = spread(plant.process, 3, 0.1)
    for name, column in values.items():
        column[1] = plant.process.signal(name).initial
    found = many.find(values)
    np.testing.assert_array_equal(found.state[:, 1], plant.point.state)
    np.testing.assert_array_equal(found.inputs[:, 1], plant.point.inputs)
    assert found.state[0, 0] != plant.point.state[0]


def test_johanssons_inputs_for_other_holes():
    """k_1 γ_1 u_1 + (1 - γ_2) k_2 u_2 = a_1 √(2 g h_1), and the same of the second tank."""
    plant = cl.load("quadruple-tank")
    many, _, _ = asked(plant)
    holes = 7.1e-6 * np.array([0.9, 1.0, 1.1])
    found = many.find({"outlet_1.area": holes})
    p = {s.name: s.initial for s in plant.process.parameters}
    k1, k2, g1, g2 = (
        p[n] for n in ("pump_1.gain", "pump_2.gain", "splitter_1.tank_1", "splitter_2.tank_2")
    )
    mixed = np.array([[g1 * k1, (1 - g2) * k2], [(1 - g1) * k1, g2 * k2]])
    for draw, hole in enumerate(holes):
        out = [hole, 5.7e-6] * np.sqrt(2 * 9.81 * plant.point.state[:2])
        np.testing.assert_allclose(found.inputs[:, draw], np.linalg.solve(mixed, out), rtol=1e-12)


def test_why_there_is_no_steady_state_is_counted():
    plant = cl.load("quadruple-tank")
    many, _, _ = asked(plant)
    found = many.find({"outlet_1.area": 7.1e-6 * np.array([1.0, 2.0, 3.0, 0.1, 1.0])})
    assert found.counts == {"pump_1 would leave its range": 2, "pump_2 would leave its range": 1}
    np.testing.assert_array_equal(found.feasible, [True, False, False, False, True])


def test_loads_are_held_too():
    plant = cl.load("quadruple-tank")
    many, outputs, _ = asked(plant)
    found = many.find({"inflow_1": np.array([0.0, 1.5e-6])})
    at = plant.point.as_dict()
    one = find_equilibrium(
        plant.process, outputs={n: at[n] for n in outputs}, disturbances={"inflow_1": 1.5e-6}
    )
    np.testing.assert_allclose(found.inputs[:, 1], one.inputs, rtol=1e-12)
    assert found.inputs[0, 1] < found.inputs[0, 0]
