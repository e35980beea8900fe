"""A linear controller that is told what was applied: the observer form of any order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, effect, elements
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.output_stage import output_stage
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step
from clepsydra.controllers.control_law import control_law
from clepsydra.controllers.state_feedback import fading_time
from clepsydra.program.step_law import StepLaw

FAMILY = "loop shaping"
#: More states than this make a law that nobody can read or check on a plant.
MOST_STATES = 60

_Ends = dict[str, tuple[Signal, ...]]
#: What the numbers of each matrix are called among the parameters of the law; the matrix, and
#: which of memory z, error e and output u it acts on and comes from.
_MATRICES = {
    "transition": ("transition", "z", "z"),
    "error_effect": ("entered", "z", "e"),
    "output_effect": ("told", "z", "u"),
    "memory_gain": ("shown", "u", "z"),
    "error_gain": ("direct", "u", "e"),
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
        for name, _, _ in _MATRICES.values():
            matrix = np.atleast_2d(np.asarray(getattr(self, name), float))
            object.__setattr__(self, name, matrix)
        place, counts = "conditioned linear law", self.counts
        if not 1 <= counts["z"] <= MOST_STATES or counts["u"] < 1 or counts["e"] < 1:
            raise InputError(
                f"{place}, shapes",
                "{z} states, {u} outputs, {e} errors".format(**counts),
                f"1 to {MOST_STATES} states, and at least one output and one error",
                "reduce the order",
            )
        remedy = "give every matrix in the same numbers of states, outputs and errors"
        for name, to, by in _MATRICES.values():
            found, shape = getattr(self, name).shape, (counts[to], counts[by])
            if found != shape:
                raise InputError(f"{place}, {name}", found, f"the shape {shape}", remedy)

    @property
    def counts(self) -> dict[str, int]:
        """How many states (z), control errors (e) and manipulated variables (u) there are."""
        return {"z": len(self.transition), "e": self.direct.shape[1], "u": len(self.direct)}

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
        _, numbers = _joined(self, measured, manipulated)
        return {effect(to, matrix, by): value for to, matrix, by, value in numbers}


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
    ends, numbers = _joined(matrices, measured, manipulated)
    parameters = [
        signals.number_of(matrix, to, by, f"effect of {by.name} on {to.name}", digits=9)
        for to, matrix, by, _ in numbers
    ]
    for u in ends["u"]:
        parameters += [signals.at_rest(u, "bias"), fading_time(u), *signals.limit_parameters(u)]
    return control_law(
        "conditioned_linear",
        lambda sample: _equations(sample, ends),
        measured=ends["e"],
        controlled=ends["e"],
        manipulated=ends["u"],
        parameters=parameters,
        state=[
            *(state for u in ends["u"] for state in signals.output_state(u)),
            *(replace(z, description=f"{z.name} of the controller") for z in ends["z"]),
        ],
        description=(
            "u = u° + C z + D e + b within the limits, e = y − r, then z⁺ = A z + B e + "
            "M (u − u°) with the u that was applied; b makes a change to automatic bumpless and "
            "fades in the fading time.",
            "Anti-windup: conditioning, z follows what was applied.",
        ),
    )


def _joined(
    matrices: ConditionedMatrices,
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
) -> tuple[_Ends, list[tuple[Signal, str, Signal, float]]]:
    """Return the signals that the matrices join, and what each number is of which and its value.

    Those of z have no unit.
    """
    place = "conditioned linear law"
    shown = signals.process_signals(measured, f"{place}, measured")
    moved = signals.process_signals(manipulated, f"{place}, manipulated")
    counts = matrices.counts
    if (len(shown), len(moved)) != (counts["e"], counts["u"]):
        raise InputError(
            f"{place}, signals",
            f"{len(shown)} measured, {len(moved)} manipulated",
            "{e} measured and {u} manipulated, as the matrices".format(**counts),
            "correct the signals",
        )
    memory = tuple(map(Signal, elements("memory", counts["z"])))
    ends = {"z": memory, "e": shown, "u": moved}
    return ends, [
        (ends[to][j], called, ends[by][k], float(value))
        for called, (name, to, by) in _MATRICES.items()
        for (j, k), value in np.ndenumerate(getattr(matrices, name))
        if value != 0.0
    ]


def _equations(sample: Sample, ends: _Ends) -> None:
    names = [y.name for y in ends["e"]]
    reading = Reading.of(sample, names, names)
    errors = {y: reading.measurements[y] - reading.setpoints[y] for y in names}
    values = {"z": [sample[z.name] for z in ends["z"]], "e": [*errors.values()], "u": []}
    goes_on = is_time_step(sample["time_step"])
    time_step = ca.if_else(goes_on, sample["time_step"], 1)

    def product(called: str, to: Signal) -> ca.SX:
        total, (_, _, by) = ca.SX(0), _MATRICES[called]
        for each, value in zip(ends[by], values[by], strict=True):
            if (name := effect(to, called, each)) in sample.symbols:
                total = total + sample[name] * value
        return total

    for y, error in errors.items():
        sample.name(y, {"error": error})
    for u in ends["u"]:
        bias, fading, integral = sample.of(u, "bias", "fading_time", "integral")
        asked = product("memory_gain", u) + product("error_gain", u)
        sample.name(u, {"asked": asked})
        output = output_stage(
            sample,
            u,
            reading,
            proportional=bias + asked,
            increment=-tracking_share(time_step, fading) * integral,
            anti_windup="conditional_integration",
        )
        values["u"].append(output - bias)
    known = all_of([reading.numbers, reading.sensors, goes_on])
    for z in ends["z"]:
        value = product("transition", z) + product("error_effect", z) + product("output_effect", z)
        usable = ca.logic_and(known, is_number(value))
        sample.next_state[z.name] = ca.if_else(usable, value, sample[z.name])
