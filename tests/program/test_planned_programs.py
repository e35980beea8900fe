"""The programs that predictive control solves in closed loops of the catalogue, by another solver.

A run records what its controller read and what it applied. From these alone, and from the tables of
the prediction, each program is formed anew here, so that nothing of the law stands on both sides.
"""

from dataclasses import replace

import numpy as np
import pytest
from quadratic_programs import by_active_sets

import clepsydra as cl
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.routines.current_observer import corrected, predicted
from clepsydra.program.routines.predictive_plan import SOFTNESS, linear_plan

#: With both pumps at their limits it asks for what sends interior points round in circles.
AT_LIMITS = "laboratory-four-tanks-nonminimum-phase:volts"
#: For these there is no predictive controller that is robust.
REFUSED = {
    "averaging-tank:all-inputs", "equalisation-tank:dosing", "equalisation-tank:relief",
    "wet-well:start-stop",
}  # fmt: skip
#: Every process of the catalogue as it is, and in each variant that it is not in by itself.
PLANTS = [
    name
    for each in cl.catalogue()
    for name in (
        each.name,
        *(f"{each.name}:{v}" for v in each.variants if v not in each.default_variants),
    )
    if name not in REFUSED
]


class Planned:
    """The plans of a controller [m inputs, n moves, N estimates], from what a run recorded."""

    def __init__(self, controller, tables, observer):
        self.controller, self.observer = controller, observer
        law, self.manipulated = controller.law, controller.manipulated
        bounded = [
            p.name.removesuffix(".high_bound") for p in law.parameters if p.part == "high_bound"
        ]
        curves, slopes, lengths, self.reached, ends, spans = (each.full() for each in tables)
        blocks, samples, moves = len(lengths), lengths.sum(), ends.shape[1]
        self.blocks = blocks
        self.low, self.high, self.bias, largest = (
            self.of(self.manipulated, part)
            for part in ("low_limit", "high_limit", "bias", "largest_move")
        )
        errors = self.of(controller.setpoints, "largest_error") ** -2.0
        weights = controller.values["move_weight"] / (samples * largest) ** 2
        changes = np.eye(moves) - np.eye(moves, k=-len(self.manipulated))
        self.hessian = np.zeros((moves + 1, moves + 1))
        self.hessian[:-1, :-1] = np.tensordot(errors, curves.reshape(-1, moves, moves), 1)
        self.hessian[:-1, :-1] += changes.T @ np.diag(np.tile(weights, blocks)) @ changes
        self.hessian[-1, -1] = SOFTNESS * samples
        self.slopes = np.tensordot(errors, slopes.reshape(len(errors), moves, -1), 1)
        self.rows = np.vstack([np.eye(moves), -np.eye(moves), ends])
        overstepped = np.append(np.zeros(2 * moves), -np.repeat(spans, blocks))
        self.rows = np.column_stack([self.rows, overstepped])
        above = self.of(bounded, "high_bound") - self.of(bounded, "reference")
        self.above = np.repeat(above, blocks)

    def of(self, names, part):
        """The values of a parameter; a level that is not told rests at zero."""
        return np.array([self.controller.values.get(f"{name}.{part}", 0.0) for name in names])

    def programs(self, run):
        """The first moves [k, m] of k samples whose linear plan oversteps, and H, f, A, b of each.

        Unknowns curve by one and rows have a length of one: DAQP leaves out rows in small units.
        The moves of the rest, by the linear plan, are compared at once.
        """
        measured, controlled = self.controller.measurements, self.controller.setpoints
        read, wanted, applied = (
            np.column_stack([run.values[name] for name in of])
            for of in (measured, [f"{name}.setpoint" for name in controlled], self.manipulated)
        )
        first = [self.controller.initial_state[f"{name}.last_output"] for name in self.manipulated]
        last = np.vstack([first, applied[:-1]])
        state = self.estimates(read - self.of(measured, "reference"), applied - self.bias)
        known = np.hstack([state, wanted - self.of(controlled, "reference"), last - self.bias])
        linear, reached = (known @ each.T for each in (self.slopes, self.reached))
        room = [np.tile(each, self.blocks) for each in (self.high - last, last - self.low)]
        bounds = np.hstack([*room, self.above - reached])
        plans = -np.linalg.solve(self.hessian[:-1, :-1], linear.T).T
        over = (plans @ self.rows[:, :-1].T > bounds).any(axis=1)
        moved, free = applied - last, plans[:, : len(self.manipulated)]
        assert np.abs((moved - free)[~over] / (self.high - self.low)).max() < 1e-6
        unknown = np.diag(self.hessian) ** -0.5
        length = np.linalg.norm(self.rows * unknown, axis=1)
        scaled = self.hessian * unknown * unknown[:, None], self.rows * unknown / length[:, None]
        return moved[over], unknown, [
            (scaled[0], np.append(f, 0.0) * unknown, scaled[1], b / length)
            for f, b in zip(linear[over], bounds[over], strict=True)
        ]  # fmt: skip

    def estimates(self, read, applied):
        """The estimates [samples, N] of an observer that begins at rest."""
        observation, correction, transition, input_effect = (each.full() for each in self.observer)
        left = np.eye(len(transition)) - correction @ observation
        found, state = [], np.zeros(len(transition))
        for correct, effect in zip(read @ correction.T, applied @ input_effect.T, strict=True):
            found.append(left @ state + correct)
            state = transition @ found[-1] + effect
        return np.array(found)


@pytest.fixture
def planned(monkeypatch):
    """Return a function: a plant -> its predictive controller, and the plans that it makes."""
    given = {}

    def listened(routine, first, last):
        def told(*arguments):
            given[routine.__name__] = arguments[first:last]
            return routine(*arguments)

        name = f"clepsydra.controllers.predictive.law.{routine.__name__}"
        monkeypatch.setattr(name, told)

    listened(linear_plan, 0, 2)
    listened(corrected, 3, 5)
    listened(predicted, 2, 4)

    def controlled(plant):
        controller = cl.design.mpc(plant)
        tables, asked = given["linear_plan"]
        assert not asked.rise.numel()  # no process of the catalogue limits a rate
        return controller, Planned(controller, tables, (*given["corrected"], *given["predicted"]))

    return controlled


def noisy(scenario):
    """Return a scenario with its noise of measurements from the first sample on."""
    random = np.random.default_rng(1)
    spread = [each.deviation for each in scenario.noises[: scenario.noise.shape[1]]]
    return replace(scenario, noise=random.normal(size=scenario.noise.shape) * spread, noises=())


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name == AT_LIMITS else pytest.mark.thorough)
        for name in PLANTS
    ],
)
def test_every_first_move_in_closed_loop_is_that_of_another_solver(planned, name):
    """In the scenario of a study, and in the same with noise throughout."""
    plant = cl.load(name)
    controller, plans = planned(plant)
    usual = default_scenario(plant.linear)
    for scenario in (usual, noisy(usual)):
        run = Loop(controller, plant.linear).run(scenario)
        assert run.final_state["controller.unsolved"] == 0.0
        moves, unknown, programs = plans.programs(run)
        assert programs
        exact = by_active_sets(programs)
        expected = (exact * unknown)[:, : moves.shape[1]]
        difference = np.abs(moves - expected) / (plans.high - plans.low)
        assert difference.max() < 1e-6
