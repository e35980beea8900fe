"""Polynomial control of two degrees of freedom, in increments: P ∇u = r0 w − Q y."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.increments import IncrementalLoop, PolynomialShape
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.control_law import control_law
from clepsydra.program.step_law import StepLaw

FAMILY = "2DOF polynomial"
Shape = TypeVar("Shape")


def polynomial_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    shapes: Sequence[PolynomialShape],
) -> StepLaw:
    """Write the step law of polynomial controllers, one from each measurement to an output.

    With Q y = Q(1) y + g1 ∇y + g2 ∇y(k−1) + …, R likewise, Q(1) = R(1) = r0 and ∇ the difference
    from one sample to the next, each sample in automatic::

        v  = u(k−1) + r0 (w − y) − Σ g_j ∇y(k−j+1) + Σ s_j ∇w(k−j+1) − Σ p_j ∇u(k−j)
        u  = min(high limit, max(low limit, v))

    So rounding leaves no offset however small r0 is, and the output leaves a limit as soon as
    the law asks for less. ∇u is what was really applied, in manual and at a limit too, so that
    automatic goes on from there without a bump. In a sample without a usable measurement or
    setpoint the output is held, and the law then goes on as if that sample had not been.

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        The process signals of each loop: they lend their names, units and ranges.
    shapes : sequence of PolynomialShape
        One for each loop.

    Returns
    -------
    StepLaw
        Inputs sp, pv and good of each measurement, mode, manual and tracking of each output, and
        time_step; parameters reference_gain, measurement_gain.J, setpoint_gain.J and
        increment_gain.J of each measurement, which hold for one sampling period, low_limit and
        high_limit of each output; outputs out and status of each output.

    Raises InputError: there is no loop, or the signals or shapes are not one for each loop.

    References
    ----------
    V. Bobál, J. Böhm, J. Fessl, J. Macháček, Digital Self-tuning Controllers: Algorithms,
    Implementation and Applications, Springer 2005.

    Examples
    --------
    One sample with r0 = 0.5 and g1 = 2 at an error of 1, after a rise of 0.25:

    >>> law = polynomial_law(["level"], ["pump"], [PolynomialShape(1)])
    >>> given = dict(sp=6, pv=5, good=1, mode=1, time_step=1)
    >>> values = {"level.reference_gain": 0.5, "level.measurement_gain.1": 2,
    ...           "pump.low_limit": 0, "pump.high_limit": 10}
    >>> before = {"pump.last_output": 3, "level.past_value.1": 4.75}
    >>> state, outputs, _ = law.function(
    ...     [before[entry.name] for entry in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0])
    3.0
    """
    loops = one_for_each(shapes, measured, manipulated, "polynomial law")
    return law_of_loops(
        "polynomial_control",
        [IncrementalLoop(*loop) for loop in loops],
        "u = u(k−1) + r0 (w − y) − Σ g_j ∇y(k−j+1) − Σ p_j ∇u(k−j) within the limits, ∇ being "
        "the difference between two samples: r0 is reference_gain, g_j measurement_gain, p_j "
        "increment_gain.",
    )


def one_for_each(
    shapes: Sequence[Shape],
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    place: str,
) -> list[tuple[Shape, Signal, Signal]]:
    """Return the shape of each loop with what it measures and what it moves.

    Raises InputError: there is no loop, or the signals or shapes are not one for each loop.
    """
    pairs = signals.paired(measured, manipulated, place)
    if len(shapes) != len(pairs):
        raise InputError(
            f"{place}, shapes", len(shapes), f"{len(pairs)}, one for each loop", "give one for each"
        )
    return [(shape, *pair) for shape, pair in zip(shapes, pairs, strict=True)]


def law_of_loops(name: str, loops: Sequence[IncrementalLoop], *description: str) -> StepLaw:
    """Write the step law of loops, each from a measurement to an output."""

    def equations(sample: Sample) -> None:
        for loop in loops:
            loop.step(sample)

    measured = [loop.measured for loop in loops]
    return control_law(
        name,
        equations,
        measured=measured,
        controlled=measured,
        manipulated=[loop.moved for loop in loops],
        parameters=[parameter for loop in loops for parameter in loop.parameters()],
        state=[state for loop in loops for state in loop.states()],
        description=description,
    )
