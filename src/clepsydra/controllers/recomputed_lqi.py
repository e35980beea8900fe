"""LQI whose gains are recomputed in every sample from the linear model at the present state."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

import casadi as ca

from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.matrix import column
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.sampled_matrices import from_upper_triangle, upper_triangle
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step, time_step_of
from clepsydra.controllers.linear_quadratic_integral import varying_lqi
from clepsydra.controllers.observers.state_source import ProcessState
from clepsydra.controllers.process_model import evaluated, models_in
from clepsydra.linear.process_equations import NEARLY_EMPTY, ProcessEquations
from clepsydra.program.routines.recomputed_gain import recomputed_gain
from clepsydra.program.step_law import StepLaw

FAMILY = "recomputed LQI"


def recomputed_lqi_law(
    source: ProcessState,
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
    (`linear_quadratic_integral.varying_lqi`). A step is not taken, and gains and P stay, where a
    signal or a sensor is bad, the time step is none, R + Γᵀ P Γ is not positive definite, or a
    number runs over. Levels count as 2 % of their height at least, since the slope of an outlet
    grows without bound as its tank empties.

    `source`: sensors of every state, or an observer; `doublings`: of the power series that holds
    the model over a sample; `steps`: of the difference equation in a sample.

    Raises InputError: the anti-windup is unknown or clamping.

    References
    ----------
    J. R. Cloutier, State-dependent Riccati equation techniques: an overview, American Control
    Conference 1997, 932-936, doi 10.1109/ACC.1997.609663, for the equation solved along the
    way.
    """
    equations = source.equations
    readings = ca.vertcat(*map(equations.reading, equations.outputs))
    linear = [equations.A, equations.B, ca.jacobian(readings, equations.state)]

    def gains(sample: Sample, reading: Reading, known: Sequence[ca.SX]) -> dict[str, ca.SX]:
        sample.memory(*source.feedback.last(), *source.integral_gain.last())
        sample.parameters(*models_in(equations, linear))
        inputs = _filtered(sample, source.manipulated)
        moved = ca.vertcat(*inputs.values())
        here = equations.bounded(ca.vertcat(*known[: len(source.fed_back)]), NEARLY_EMPTY)
        model = evaluated(equations, linear, sample.symbols, here, moved)
        found, definite = _recomputed(sample, source, model, doublings, steps)
        sound = [reading.numbers, reading.sensors, is_time_step(sample["time_step"])]
        holds = all_of([*sound, *definite, *map(is_number, found.values())])
        kept = {name: ca.if_else(holds, value, sample[name]) for name, value in found.items()}
        sample.next_state |= inputs | kept
        sample.named["gains_recomputed"] = holds
        return kept

    return varying_lqi("recomputed_lqi", source, anti_windup, gains=gains)


def _filtered(sample: Sample, manipulated: Sequence[Signal]) -> dict[str, ca.SX]:
    """Return the inputs that were applied, filtered."""
    step = ca.if_else(is_time_step(sample["time_step"]), sample["time_step"], 0)
    words = "time constant in which the model follows the inputs"
    (time,) = sample.parameters(signals.duration("input_filter_time", words))
    share = step / (ca.fmax(time, signals.SHORTEST_TIME) + step)
    found = {}
    for u in manipulated:
        filtered = signals.like(u, path(u, "filtered"), f"{u.name}, filtered")
        last, applied = sample.memory(filtered, signals.last_output(u))
        moved = last + share * (applied - last)
        found[path(u, "filtered")] = ca.if_else(is_number(moved), moved, last)
    return found


def _recomputed(
    sample: Sample, source: ProcessState, model: list[ca.SX], doublings: int, steps: int
) -> tuple[dict[str, ca.SX], list[ca.SX]]:
    """Return gains and cost to go by name, and the conditions under which the step is taken."""
    A, B, C = model
    (n, m), q = B.shape, C.shape[0]
    time, _ = time_step_of(sample.symbols)
    errors, moves, sizes = (
        ca.vertcat(
            *sample.parameters(
                *signals.growing(
                    (signals.size(path(x, p), x, f"{words} {x.name}") for x in of), power
                )
            )
        )
        # Gains grow with the moves, and as the errors get smaller.
        for p, of, words, power in (
            ("largest_error", source.controlled, "largest acceptable error of", -0.5),
            ("largest_move", source.manipulated, "largest acceptable move of", 0.5),
            ("size", source.fed_back, "size in which numbers are scaled, of", 0.0),
        )
    )
    for y in source.controlled:
        words = f"time for which a largest error of {y.name} may last"
        sample.parameters(signals.duration(path(y, "horizon"), words))
    horizons = column(sample.symbols, "horizon", source.controlled)
    # In units of what weighs one, all numbers are near one.
    A = ca.diag(1 / sizes) @ A @ ca.diag(sizes)
    B = ca.diag(1 / sizes) @ B @ ca.diag(moves)
    C = ca.diag(1 / errors) @ C @ ca.diag(sizes)
    weight = ca.diagcat(C.T @ C, ca.SX.eye(m))
    sums = ca.diag(time / horizons) @ C
    names, words = cost_names(source.equations), "cost to go, in scaled states and errors"
    last = sample.memory(*(Signal(name, description=words, matrix="cost") for name in names))
    step = recomputed_gain(
        ca.horzcat(A, B), weight, sums, from_upper_triangle(last, n + q), time, doublings, steps
    )
    gain = ca.diag(moves) @ step.gain
    feedback = gain[:, :n] / ca.repmat(sizes.T, m)
    integral = gain[:, n:] / ca.repmat((errors * horizons).T, m)
    found = source.feedback.named(feedback) | source.integral_gain.named(integral)
    found |= zip(names, upper_triangle(step.cost), strict=True)
    return found, [step.definite, *(step.cost[k, k] >= 0 for k in range(n + q))]


def cost_names(equations: ProcessEquations) -> list[str]:
    """Return the names of the cost to go of states and errors, on and above its diagonal."""
    pairs = combinations_with_replacement((*equations.states, *equations.outputs), 2)
    return [effect(x, "cost", other) for x, other in pairs]
