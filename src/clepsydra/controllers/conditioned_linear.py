"""A linear controller that is told what was applied: the observer form of any order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.output_stage import output_stage, stage_equations
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step, value_or_zero
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "loop shaping"
#: More states than this make a law that nobody can read or check on a plant.
MOST_STATES = 60

#: Name of a matrix, and the prefix of its numbers among the parameters of the law.
_PREFIXES = {
    "transition": "transition",
    "entered": "error_effect",
    "told": "output_effect",
    "shown": "memory_gain",
    "direct": "error_gain",
}


@dataclass(frozen=True, eq=False)
class ConditionedMatrices:
    """z⁺ = A z + B e + M (u − u°),  u = u° + C z + D e, of which only the zeros count here.

    A number that is zero is no parameter of the law.

    Parameters
    ----------
    transition : ndarray [n, n]
        A
    entered : ndarray [n, p]
        B
    told : ndarray [n, m]
        M
    shown : ndarray [m, n]
        C
    direct : ndarray [m, p]
        D

    Raises
    ------
    InputError
        There are no or more than 60 states, no inputs or outputs, or a shape does not fit.

    Examples
    --------
    PI control with K = 2 and Ti = 10 s each second: u = z + 2 e, and z follows u − u°.

    >>> numbers = [np.array([[value]]) for value in (0.9, 0.0, 0.1, 1.0, -2.0)]
    >>> ConditionedMatrices(*numbers).values()["memory_gain_1_1"]
    1.0
    """

    transition: np.ndarray
    entered: np.ndarray
    told: np.ndarray
    shown: np.ndarray
    direct: np.ndarray

    def __post_init__(self) -> None:
        for entry in fields(self):
            matrix = np.atleast_2d(np.asarray(getattr(self, entry.name), float))
            object.__setattr__(self, entry.name, matrix)
        n, m, p = self.states, self.outputs, self.errors
        if not 1 <= n <= MOST_STATES or m < 1 or p < 1:
            raise InputError(
                "conditioned linear law, shapes",
                f"{n} states, {m} outputs, {p} errors",
                f"1 to {MOST_STATES} states, and at least one output and one error",
                "reduce the order",
            )
        shapes = {"transition": (n, n), "entered": (n, p), "told": (n, m), "shown": (m, n)}
        for name, shape in shapes.items():
            found = getattr(self, name).shape
            if found != shape:
                raise InputError(
                    f"conditioned linear law, {name}",
                    found,
                    f"the shape {shape}",
                    "give every matrix in the same numbers of states, outputs and errors",
                )

    @property
    def states(self) -> int:
        """Number n of states."""
        return len(self.transition)

    @property
    def outputs(self) -> int:
        """Number m of manipulated variables."""
        return len(self.direct)

    @property
    def errors(self) -> int:
        """Number p of control errors."""
        return self.direct.shape[1]

    def unconditioned(self) -> ConditionedMatrices:
        """Return the same controller that is told nothing: it winds up in saturation."""
        return ConditionedMatrices(
            self.transition + self.told @ self.shown,
            self.entered + self.told @ self.direct,
            np.zeros_like(self.told),
            self.shown,
            self.direct,
        )

    def values(self) -> dict[str, float]:
        """Return the numbers that are not zero as parameters of the law."""
        return {
            f"{prefix}_{row + 1}_{column + 1}": float(value)
            for name, prefix in _PREFIXES.items()
            for (row, column), value in np.ndenumerate(getattr(self, name))
            if value != 0.0
        }


def conditioned_linear_law(
    matrices: ConditionedMatrices,
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of a linear controller that is told what was applied.

    In automatic, with the errors e = y − r::

        u  = min(high limit, max(low limit, u° + C z + D e + b))
        z⁺ = A z + B e + M (u − u°)

    z hears of the output that was applied, after mode, limits and hold, and not of the one that
    was asked for. A controller x⁺ = a x + b e, u = c x + d e without limits is the same for any
    M as one with A = a − M c, B = b − M d, C = c and D = d; with an M that makes A stable z
    neither winds up in saturation nor runs away in manual. For an observer of the process with
    feedback of its estimate, M is the effect of the input on the estimate.

    b takes the place of the integral in the output stage and makes a change to automatic
    bumpless: it is then what the operator's output was above the law's, and fades,
    b⁺ = b − min(Δt/Tf, 1) b. What it does to the output z is told too.

    A fault of any sensor holds all outputs that are in automatic, and z with them, since each
    needs every error.

    Parameters
    ----------
    matrices : ConditionedMatrices
        Which numbers differ from zero; the values are parameters of the law.
    measured, manipulated : sequence of Signal, optional
        The process signals: they lend their units and ranges. Each measured signal is
        controlled.

    Returns
    -------
    StepLaw
        Inputs setpoint_j, measurement_j, sensor_j, mode_i, manual_i, tracking_i and
        time_step [s]; parameters transition_j_k, error_effect_j_k, output_effect_j_i,
        memory_gain_i_j, error_gain_i_j, bias_i, fading_time_i [s], low_limit_i and
        high_limit_i; state integral_i (b), last_output_i, memory_j (z); outputs manipulated_i,
        status_i.

    Raises
    ------
    InputError
        The signals do not match the matrices.

    References
    ----------
    R. Hanus, M. Kinnaert and J.-L. Henrotte, Conditioning technique, a general anti-windup and
    bumpless transfer method, Automatica 23(6), 1987, 729-739,
    doi 10.1016/0005-1098(87)90029-X; S. Walgama and J. Sternby, Inherent observer property in a
    class of anti-windup compensators, International Journal of Control 52(3), 1990, 705-724.

    Examples
    --------
    PI control with K = 2 and Ti = 10 s at an error of 1 below the setpoint, u° = 3:

    >>> one = np.eye(1)
    >>> matrices = ConditionedMatrices(0.9 * one, 0.0 * one, 0.1 * one, one, -2.0 * one)
    >>> law = conditioned_linear_law(matrices)
    >>> given = dict(setpoint_1=5, measurement_1=4, sensor_1=1, mode_1=1, time_step=1)
    >>> values = matrices.values() | dict(bias_1=3, fading_time_1=10, low_limit_1=0,
    ...                                   high_limit_1=10)
    >>> state, outputs, _ = law.function(
    ...     [0] * len(law.state),
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[2])
    (5.0, 0.2)
    """
    place = "conditioned linear law"
    measured = signals.wired_signals("measurement", matrices.errors, measured, f"{place}, measured")
    manipulated = signals.wired_signals(
        "output", matrices.outputs, manipulated, f"{place}, manipulated"
    )
    written = matrices.values()
    return step_law(
        "conditioned_linear",
        inputs=[
            *signals.setpoint_inputs(measured),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(manipulated),
        ],
        parameters=[
            *_numbers(matrices, measured, manipulated),
            *_output_parameters(manipulated),
        ],
        state=[
            *(s for i, u in enumerate(manipulated, 1) for s in signals.output_state(i, u)),
            *(
                Signal(f"memory_{j}", description=f"state {j} of the controller")
                for j in range(1, matrices.states + 1)
            ),
        ],
        outputs=[s for i, u in enumerate(manipulated, 1) for s in signals.output_signals(i, u)],
        equations=lambda symbols: _equations(symbols, matrices, written, manipulated),
        description=(
            "u = u° + C z + D e + b within the limits, e = y − r, then z⁺ = A z + B e + "
            "M (u − u°) with the u that was applied; b makes a change to automatic bumpless and "
            "fades in the fading time.",
            "Anti-windup: conditioning, z follows what was applied.",
        ),
    )


def _numbers(
    matrices: ConditionedMatrices, measured: Sequence[Signal], manipulated: Sequence[Signal]
) -> list[Signal]:
    """Return the parameters of the matrices; those of a state have no unit."""
    memory = [Signal(f"memory {j}") for j in range(1, matrices.states + 1)]
    effects = {
        "transition": (memory, memory),
        "error_effect": (memory, measured),
        "output_effect": (memory, manipulated),
        "memory_gain": (manipulated, memory),
        "error_gain": (manipulated, measured),
    }
    found = []
    for name in matrices.values():
        prefix, row, column = name.rsplit("_", 2)
        rows, columns = effects[prefix]
        to, by = rows[int(row) - 1], columns[int(column) - 1]
        unit = signals.ratio_of_units(to.unit, by.unit)
        found.append(signals.coefficient(name, unit, f"effect of {by.name} on {to.name}"))
    return found


def _output_parameters(manipulated: Sequence[Signal]) -> list[Signal]:
    return [
        parameter
        for i, output in enumerate(manipulated, start=1)
        for parameter in (
            signals.gain(f"bias_{i}", output.unit, 0.0, f"{output.name} at the operating point"),
            signals.duration(
                f"fading_time_{i}", f"time in which a bumpless start of {output.name} fades"
            ),
            *signals.limit_parameters(i, output),
        )
    ]


def _equations(
    symbols: Symbols,
    matrices: ConditionedMatrices,
    written: dict[str, float],
    manipulated: Sequence[Signal],
) -> Equations:
    p, n = matrices.errors, matrices.states
    raw = [symbols[f"measurement_{j}"] for j in range(1, p + 1)]
    raw += [symbols[f"setpoint_{j}"] for j in range(1, p + 1)]
    valid = [is_number(value) for value in raw]
    numbers = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
    errors = [y - r for y, r in zip(numbers[:p], numbers[p:], strict=True)]
    memory = [symbols[f"memory_{j}"] for j in range(1, n + 1)]
    are_numbers = all_of(valid)
    are_good = all_of([symbols[f"sensor_{j}"] for j in range(1, p + 1)])
    goes_on = is_time_step(symbols["time_step"])
    time_step = ca.if_else(goes_on, symbols["time_step"], 1)

    def product(prefix: str, row: int, values: Sequence[ca.SX]) -> ca.SX:
        total = ca.SX(0)
        for column, value in enumerate(values, start=1):
            name = f"{prefix}_{row}_{column}"
            if name in written:
                total = total + symbols[name] * value
        return total

    named = {f"error_{j}": value for j, value in enumerate(errors, start=1)}
    stages = []
    for i, output in enumerate(manipulated, start=1):
        asked = product("memory_gain", i, memory) + product("error_gain", i, errors)
        named[f"asked_{i}"] = asked
        share = tracking_share(time_step, symbols[f"fading_time_{i}"])
        stages.append(
            output_stage(
                symbols,
                i,
                output,
                proportional=symbols[f"bias_{i}"] + asked,
                increment=-share * symbols[f"integral_{i}"],
                signals_are_numbers=are_numbers,
                sensors_are_good=are_good,
                anti_windup="conditional_integration",
            )
        )
    ended = stage_equations(stages, named)
    moves = [stage.manipulated - symbols[f"bias_{stage.number}"] for stage in stages]
    known = all_of([are_numbers, are_good, goes_on])
    following = {}
    for j in range(1, n + 1):
        value = product("transition", j, memory) + product("error_effect", j, errors)
        value = value + product("output_effect", j, moves)
        usable = ca.logic_and(known, is_number(value))
        following[f"memory_{j}"] = ca.if_else(usable, value, symbols[f"memory_{j}"])
    return Equations({**ended.next_state, **following}, ended.outputs, ended.intermediates)
