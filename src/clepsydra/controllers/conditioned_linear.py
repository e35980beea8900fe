"""A linear controller that is told what was applied: the observer form of any order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step
from clepsydra.controllers.state_feedback import fading_output
from clepsydra.program.step_law import StepLaw

FAMILY = "loop shaping"
#: More states than this make a law that nobody can read or check on a plant.
MOST_STATES = 60

_WORDS = "effect of {by} on {to}"
_Ends = dict[str, Sequence[Signal]]
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
        _, joined = self.joined(measured, manipulated)
        return {
            name: float(value)
            for called, array in self._arrays().items()
            for name, value in joined[called].named(array).items()
        }

    def numbers(self) -> dict[str, np.ndarray]:
        """Return the numbers that are not zero by what they are called in the law."""
        return {called: array[array != 0.0] for called, array in self._arrays().items()}

    def joined(
        self, measured: Sequence[Signal | str], manipulated: Sequence[Signal | str]
    ) -> tuple[_Ends, dict[str, Matrix]]:
        """Return the signals that the matrices join, z without units, and the matrices."""
        ends: _Ends = {
            "z": [*map(Signal, elements("memory", len(self.transition)))],
            "e": signals.process_signals(measured),
            "u": signals.process_signals(manipulated),
        }
        used = {called: array != 0.0 for called, array in self._arrays().items()}
        return ends, {
            called: Matrix(called, ends[to], ends[by], _WORDS, used=used[called], digits=9)
            for called, (_, to, by) in _MATRICES.items()
        }

    def _arrays(self) -> dict[str, np.ndarray]:
        return {called: getattr(self, name) for called, (name, _, _) in _MATRICES.items()}


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

    `measured`, `manipulated`: the process signals: they lend their names, units and ranges. Each
    measured signal is controlled; `matrices`: which numbers differ from zero; the values are
    parameters of the law.

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
    >>> float(outputs[0]), float(state[0])
    (5.0, 0.2)
    """
    ends, joined = matrices.joined(measured, manipulated)
    return control_law(
        "conditioned_linear",
        lambda sample: _equations(sample, ends, joined),
        measured=ends["e"],
        controlled=ends["e"],
        manipulated=ends["u"],
        description=(
            "u = u° + C z + D e + b within the limits, e = y − r, then z⁺ = A z + B e + "
            "M (u − u°) with the u that was applied; b makes a change to automatic bumpless and "
            "fades in the fading time.",
            "Anti-windup: conditioning, z follows what was applied.",
        ),
    )


def _equations(sample: Sample, ends: _Ends, joined: dict[str, Matrix]) -> None:
    names = [y.name for y in ends["e"]]
    reading = Reading.of(sample, names, names)
    errors = {path(y, "error"): reading.measurements[y] - reading.setpoints[y] for y in names}
    sample.named |= errors
    kept = (replace(z, description=f"{z.name} of the controller") for z in ends["z"])
    values = {"z": sample.memory(*kept), "e": [*errors.values()], "u": []}

    def product(called: str) -> list[ca.SX]:
        _, _, by = _MATRICES[called]
        sample.parameters(*joined[called].signals())
        return joined[called].times(sample.symbols, values[by])

    shares = zip(ends["u"], product("memory_gain"), product("error_gain"), strict=True)
    for u, of_memory, of_error in shares:
        asked, (bias,) = of_memory + of_error, sample.parameters(signals.at_rest(u, "bias"))
        sample.name(u, {"asked": asked})
        values["u"].append(fading_output(sample, u, reading, bias + asked) - bias)
    known = all_of([reading.numbers, reading.sensors, is_time_step(sample["time_step"])])
    products = map(product, ("transition", "error_effect", "output_effect"))
    for z, kept, entered, told in zip(ends["z"], *products, strict=True):
        value = kept + entered + told
        usable = ca.logic_and(known, is_number(value))
        sample.next_state[z.name] = ca.if_else(usable, value, sample[z.name])
