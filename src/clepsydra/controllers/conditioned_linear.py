"""A linear controller that is told what was applied: the observer form of any order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, effect, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.output_stage import output_stage, stage_equations
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step, value_or_zero
from clepsydra.controllers.state_feedback import fading_time
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "loop shaping"
#: More states than this make a law that nobody can read or check on a plant.
MOST_STATES = 60

#: Name of a matrix, and what its numbers are called among the parameters of the law.
_MATRICES = {
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
    >>> ConditionedMatrices(*numbers).values(["level"], ["pump"])["pump.memory_gain.memory.1"]
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

    def values(
        self, measured: Sequence[Signal | str], manipulated: Sequence[Signal | str]
    ) -> dict[str, float]:
        """Return the numbers that are not zero as parameters of the law for these signals."""
        law = _Law.of(self, measured, manipulated)
        return {effect(to, matrix, by): value for matrix, to, by, value in law.numbers()}


def conditioned_linear_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    matrices: ConditionedMatrices,
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
    measured, manipulated : sequence of Signal or str
        The process signals: they lend their names, units and ranges. Each measured signal is
        controlled.
    matrices : ConditionedMatrices
        Which numbers differ from zero; the values are parameters of the law.

    Returns
    -------
    StepLaw
        Inputs sp, pv and good of each measurement, mode, manual and tracking of each output,
        and time_step [s]; parameters transition, error_effect and output_effect of each memory,
        memory_gain, error_gain, bias, fading_time [s], low_limit and high_limit of each output;
        state integral (b) and last_output of each output and memory.1, memory.2, … (z); outputs
        out and status of each output.

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
    >>> law = conditioned_linear_law(["level"], ["pump"], matrices)
    >>> given = dict(sp=5, pv=4, good=1, mode=1, time_step=1)
    >>> values = matrices.values(["level"], ["pump"]) | {
    ...     "pump.bias": 3, "pump.fading_time": 10, "pump.low_limit": 0, "pump.high_limit": 10}
    >>> state, outputs, _ = law.function(
    ...     [0] * len(law.state),
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[2])
    (5.0, 0.2)
    """
    law = _Law.of(matrices, measured, manipulated)
    return step_law(
        "conditioned_linear",
        inputs=[
            *signals.setpoint_inputs(law.measured),
            *signals.measurement_inputs(law.measured),
            *signals.output_inputs(law.manipulated),
        ],
        parameters=law.parameters(),
        state=[
            *(state for u in law.manipulated for state in signals.output_state(u)),
            *(Signal(z.name, description=f"{z.name} of the controller") for z in law.memory),
        ],
        outputs=[result for u in law.manipulated for result in signals.output_signals(u)],
        equations=law.equations,
        description=(
            "u = u° + C z + D e + b within the limits, e = y − r, then z⁺ = A z + B e + "
            "M (u − u°) with the u that was applied; b makes a change to automatic bumpless and "
            "fades in the fading time.",
            "Anti-windup: conditioning, z follows what was applied.",
        ),
    )


@dataclass(frozen=True)
class _Law:
    """The matrices with the signals that they join; those of z have no unit."""

    matrices: ConditionedMatrices
    measured: tuple[Signal, ...]
    manipulated: tuple[Signal, ...]
    memory: tuple[Signal, ...]

    @classmethod
    def of(
        cls,
        matrices: ConditionedMatrices,
        measured: Sequence[Signal | str],
        manipulated: Sequence[Signal | str],
    ) -> Self:
        place = "conditioned linear law"
        shown = signals.process_signals(measured, f"{place}, measured")
        moved = signals.process_signals(manipulated, f"{place}, manipulated")
        if (len(shown), len(moved)) != (matrices.errors, matrices.outputs):
            raise InputError(
                f"{place}, signals",
                f"{len(shown)} measured, {len(moved)} manipulated",
                f"{matrices.errors} measured and {matrices.outputs} manipulated, as the matrices",
                "correct the signals",
            )
        return cls(matrices, shown, moved, tuple(map(Signal, elements("memory", matrices.states))))

    def numbers(self) -> list[tuple[str, Signal, Signal, float]]:
        """Return for each number its matrix, what it acts on, what acts, and its value."""
        z, y, u = self.memory, self.measured, self.manipulated
        ends = {"transition": (z, z), "entered": (z, y), "told": (z, u)}
        ends |= {"shown": (u, z), "direct": (u, y)}
        return [
            (_MATRICES[name], rows[j], columns[k], float(value))
            for name, (rows, columns) in ends.items()
            for (j, k), value in np.ndenumerate(getattr(self.matrices, name))
            if value != 0.0
        ]

    def parameters(self) -> list[Signal]:
        found = [
            signals.number_of(matrix, to, by, f"effect of {by.name} on {to.name}", digits=9)
            for matrix, to, by, _ in self.numbers()
        ]
        for u in self.manipulated:
            found += [signals.at_rest(u, "bias"), fading_time(u), *signals.limit_parameters(u)]
        return found

    def equations(self, symbols: Symbols) -> Equations:
        names = [signal.name for signal in self.measured]
        p = len(names)
        raw = [symbols[path(y, part)] for part in ("pv", "sp") for y in names]
        valid = [is_number(value) for value in raw]
        numbers = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
        errors = [y - r for y, r in zip(numbers[:p], numbers[p:], strict=True)]
        memory = [symbols[z.name] for z in self.memory]
        are_numbers = all_of(valid)
        are_good = all_of([symbols[path(y, "good")] for y in names])
        goes_on = is_time_step(symbols["time_step"])
        time_step = ca.if_else(goes_on, symbols["time_step"], 1)

        def product(
            to: Signal, matrix: str, by: Sequence[Signal], values: Sequence[ca.SX]
        ) -> ca.SX:
            total = ca.SX(0)
            for each, value in zip(by, values, strict=True):
                name = effect(to, matrix, each)
                if name in symbols:
                    total = total + symbols[name] * value
            return total

        named = {path(y, "error"): value for y, value in zip(names, errors, strict=True)}
        stages = []
        for u in self.manipulated:
            asked = product(u, "memory_gain", self.memory, memory)
            asked = asked + product(u, "error_gain", self.measured, errors)
            named[path(u, "asked")] = asked
            share = tracking_share(time_step, symbols[path(u, "fading_time")])
            stages.append(
                output_stage(
                    symbols,
                    u,
                    proportional=symbols[path(u, "bias")] + asked,
                    increment=-share * symbols[path(u, "integral")],
                    signals_are_numbers=are_numbers,
                    sensors_are_good=are_good,
                    anti_windup="conditional_integration",
                )
            )
        ended = stage_equations(stages, named)
        moves = [stage.manipulated - symbols[path(stage.moved, "bias")] for stage in stages]
        known = all_of([are_numbers, are_good, goes_on])
        following = {}
        for z, before in zip(self.memory, memory, strict=True):
            value = product(z, "transition", self.memory, memory)
            value = value + product(z, "error_effect", self.measured, errors)
            value = value + product(z, "output_effect", self.manipulated, moves)
            usable = ca.logic_and(known, is_number(value))
            following[z.name] = ca.if_else(usable, value, before)
        return Equations({**ended.next_state, **following}, ended.outputs, ended.intermediates)
