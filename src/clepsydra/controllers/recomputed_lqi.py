"""LQI whose gains are recomputed in every sample from the linear model at the present state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca

from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup
from clepsydra.controllers.blocks.sampled_matrices import (
    from_upper_triangle,
    riccati_step,
    sampled_expressions,
    upper_triangle,
)
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step
from clepsydra.controllers.blocks.varying_gains import varying_lqi
from clepsydra.controllers.linear_quadratic_integral import check_lqi_anti_windup
from clepsydra.controllers.nonlinear_lqi import NonlinearLqi
from clepsydra.controllers.observers.measured_state import StateSource
from clepsydra.controllers.process_equations import NEARLY_EMPTY, ProcessEquations, model_parameter
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "recomputed LQI"


class Recomputed(NamedTuple):
    """Gains of a sample, and the cost to go from which those of the next one follow.

    Parameters
    ----------
    feedback, integral : list of list of casadi.SX [m][n], [m][q]
    cost : list of casadi.SX
        Upper triangle of P.
    holds : casadi.SX
        Whether the step is taken; else gains and P stay as they were.

    Examples
    --------
    >>> Recomputed([[ca.SX(2)]], [[ca.SX(1)]], [ca.SX(3)], ca.SX(1)).holds
    SX(1)
    """

    feedback: list[list[ca.SX]]
    integral: list[list[ca.SX]]
    cost: list[ca.SX]
    holds: ca.SX


def recomputed_lqi_law(
    source: StateSource,
    anti_windup: AntiWindup = "back_calculation",
    *,
    doublings: int = 0,
    steps: int = 1,
) -> StepLaw:
    """Write the step law of LQI with gains that follow the operating point without a table.

    In every sample A = ∂f/∂x and B = ∂f/∂u are those at the present state, and at the inputs
    filtered with a time constant: an input that stands at a limit for a moment says nothing of
    the equilibrium that the process moves to, and a flow of zero, in a mixed tank, would say that
    the concentration cannot be moved at all. They are held over the sample together with
    Bryson's cost,

        ∫ Σ (y_j/ȳ_j)² + Σ (u_i/ū_i)² dt + Δt Σ (w_j/(ȳ_j T_j))²,   w⁺ = w + Δt (y − r),

    and the Riccati difference equation takes one step with them. Its cost to go P is the state
    of the law; the gains F, G follow from it. Where the process stands still, P comes to the
    solution of the algebraic equation, and the gains to those of the stationary regulator.

    The output is u = u° − F (x − x°) + I, and the integral takes up what a change of F makes
    (`blocks.varying_gains`). A step is not taken, and gains and P stay, where a signal or a
    sensor is bad, the time step is none, R + Γᵀ P Γ is not positive definite, or a number runs
    over. Levels count as 2 % of their height at least, since the slope of an outlet grows
    without bound as its tank empties.

    Parameters
    ----------
    source : StateSource
        Sensors of every state, or an observer.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
    doublings : int
        Of the power series that holds the model over a sample.
    steps : int
        Of the difference equation in a sample.

    Returns
    -------
    StepLaw
        Inputs and outputs as for `lqi_law`; parameters largest_error and horizon [s] of each
        controlled measurement, largest_move of each output, input_filter_time [s], size and
        reference of each state, model.*, bias, low_limit, high_limit and, for back-calculation,
        tracking_time [s] of each output, and those of the observer; state integral, last_output,
        filtered, feedback and integral_gain of each output, cost, and that of the observer.

    Raises
    ------
    InputError
        The anti-windup is unknown or clamping.

    References
    ----------
    J. R. Cloutier, State-dependent Riccati equation techniques: an overview, American Control
    Conference 1997, 932-936, doi 10.1109/ACC.1997.609663, for the equation solved along the
    way.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.observers.measured_state import MeasuredState
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("averaging-tank").linear)
    >>> law = recomputed_lqi_law(MeasuredState(equations))
    >>> sum(entry.matrix == "cost" for entry in law.state)
    10
    """
    check_lqi_anti_windup(anti_windup)
    law = _Law(NonlinearLqi(source, anti_windup), doublings, steps)
    return step_law(
        "recomputed_lqi",
        inputs=law.common.inputs(),
        parameters=law.parameters(),
        state=law.state(),
        outputs=law.common.outputs(),
        equations=law.equations,
        description=(f"Anti-windup: {IN_WORDS[anti_windup]}.",),
    )


@dataclass(frozen=True, eq=False)
class _Law:
    common: NonlinearLqi
    doublings: int
    steps: int

    @cached_property
    def _linear(self) -> list[ca.SX]:
        """A, B and C."""
        equations = self.common.equations
        readings = ca.vertcat(*(equations.reading(name) for name in equations.outputs))
        return [equations.A, equations.B, ca.jacobian(readings, equations.state)]

    def parameters(self) -> list[Signal]:
        common, found = self.common, []
        for y in common.controlled:
            words = f"largest acceptable error of {y.name}"
            found.append(signals.size(path(y, "largest_error"), y, words))
        for u in common.manipulated:
            words = f"largest acceptable move of {u.name}"
            found.append(signals.size(path(u, "largest_move"), u, words))
        for y in common.controlled:
            words = f"time for which a largest error of {y.name} may last"
            found.append(signals.duration(path(y, "horizon"), words))
        words = "time constant in which the model follows the inputs"
        found.append(signals.duration("input_filter_time", words))
        for x in common.equations.signals_of_states():
            words = f"size in which numbers are scaled, of {x.name}"
            found.append(signals.size(path(x, "size"), x, words))
        constants = dict.fromkeys(
            (*common.source.constants, *common.equations.used_in(self._linear))
        )
        found += [model_parameter(each) for each in constants]
        return [*found, *common.source.parameters(), *common.output_parameters()]

    def state(self) -> list[Signal]:
        common = self.common
        found = common.gain_signals(kept=True)
        words = "cost to go, in scaled states and errors"
        found += [
            Signal(name, description=words, matrix="cost") for name in cost_names(common.equations)
        ]
        found += [
            signals.like(u, path(u, "filtered"), f"{u.name}, filtered") for u in common.manipulated
        ]
        return [*common.states(), *found]

    def equations(self, symbols: Symbols) -> Equations:
        common = self.common
        reading = common.read(symbols)
        inputs = self._filtered(symbols)
        found = self._recomputed(symbols, reading.known.state, list(inputs.values()))
        usable = ca.logic_and(reading.feedback.numbers, reading.feedback.sensors)
        holds = ca.logic_and(found.holds, ca.logic_and(usable, is_time_step(symbols["time_step"])))
        former = common.gains_in(symbols, "feedback")
        former_integral = common.gains_in(symbols, "integral_gain")
        feedback = _chosen(holds, found.feedback, former)
        integral = _chosen(holds, found.integral, former_integral)
        stages, named = varying_lqi(
            symbols,
            common.manipulated,
            reading.feedback,
            feedback,
            former,
            integral,
            common.anti_windup,
        )
        kept = dict(inputs)
        for what, rows in (("feedback", feedback), ("integral_gain", integral)):
            for names, row in zip(common.names_of(what), rows, strict=True):
                kept |= zip(names, row, strict=True)
        kept |= {
            name: ca.if_else(holds, value, symbols[name])
            for name, value in zip(cost_names(common.equations), found.cost, strict=True)
        }
        return common.ended(reading, stages, named | {"gains_recomputed": holds}, kept)

    def _filtered(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the inputs that were applied, filtered."""
        good = is_time_step(symbols["time_step"])
        step = ca.if_else(good, symbols["time_step"], 0)
        share = step / (ca.fmax(symbols["input_filter_time"], signals.SHORTEST_TIME) + step)
        found = {}
        for u in self.common.equations.inputs:
            last = symbols[path(u, "filtered")]
            moved = last + share * (symbols[path(u, "last_output")] - last)
            found[path(u, "filtered")] = ca.if_else(is_number(moved), moved, last)
        return found

    def _recomputed(
        self, symbols: Symbols, state: Sequence[ca.SX], inputs: Sequence[ca.SX]
    ) -> Recomputed:
        equations = self.common.equations
        n, m, q = len(equations.states), len(equations.inputs), len(equations.outputs)
        here = equations.bounded(state, NEARLY_EMPTY)
        A, B, C = equations.evaluated(self._linear, here, inputs, symbols)
        good = is_time_step(symbols["time_step"])
        time = ca.if_else(good, symbols["time_step"], 1)
        sizes, moves, errors, horizons = (
            ca.vertcat(*(symbols[path(name, part)] for name in of))
            for part, of in (
                ("size", equations.states), ("largest_move", equations.inputs),
                ("largest_error", equations.outputs), ("horizon", equations.outputs),
            )
        )  # fmt: skip
        # In units of what weighs one, all numbers are near one.
        A = ca.diag(1 / sizes) @ A @ ca.diag(sizes)
        B = ca.diag(1 / sizes) @ B @ ca.diag(moves)
        C = ca.diag(1 / errors) @ C @ ca.diag(sizes)
        weight = ca.diagcat(C.T @ C, ca.SX.eye(m))
        sampled = sampled_expressions(A, B, weight, time, self.doublings)
        of_a_second = sampled.cost * (1 / time)
        sums = ca.diag(time / horizons) @ C
        held = ca.blockcat([[sampled.held, ca.SX(n, q)], [sums, ca.SX.eye(q)]])
        moved = ca.vertcat(sampled.moved, ca.SX(q, m))
        cost = ca.diagcat(of_a_second[:n, :n], ca.SX.eye(q), of_a_second[n:, n:])
        cost[:n, n + q :] = of_a_second[:n, n:]
        cost[n + q :, :n] = of_a_second[n:, :n]
        size = n + q
        to_go = from_upper_triangle([symbols[name] for name in cost_names(equations)], size)
        step = riccati_step(held, moved, cost, to_go)
        definite = step.definite
        for _ in range(1, self.steps):
            symmetric = from_upper_triangle(upper_triangle(step.cost), size)
            step = riccati_step(held, moved, cost, symmetric)
            definite = ca.logic_and(definite, step.definite)
        gain = ca.diag(moves) @ ca.densify(step.gain)
        feedback = [[gain[i, j] / sizes[j] for j in range(n)] for i in range(m)]
        integral = [
            [gain[i, n + j] / (errors[j] * horizons[j]) for j in range(q)] for i in range(m)
        ]
        entries = upper_triangle(step.cost)
        diagonal = [step.cost[k, k] >= 0 for k in range(size)]
        numbers = [is_number(value) for row in (*feedback, *integral) for value in row]
        holds = all_of([definite, *diagonal, *map(is_number, entries), *numbers])
        return Recomputed(feedback, integral, entries, holds)


def cost_names(equations: ProcessEquations) -> list[str]:
    """Return the names of the cost to go of states and errors, on and above its diagonal.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> cost_names(process_equations(cl.load("averaging-tank").linear))[0]
    'tank.level.cost.tank.level'
    """
    names = [*equations.states, *equations.outputs]
    return [effect(x, "cost", other) for j, x in enumerate(names) for other in names[j:]]


def _chosen(holds: ca.SX, now: list[list[ca.SX]], before: list[list[ca.SX]]) -> list[list[ca.SX]]:
    return [
        [ca.if_else(holds, *pair) for pair in zip(*rows, strict=True)]
        for rows in zip(now, before, strict=True)
    ]
