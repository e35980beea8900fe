"""What poles, zeros, gains and relative gains mean for control, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.base.words import listed, time_text
from clepsydra.linear.directions import ZeroDirection
from clepsydra.linear.fast_states import REACH, settled_lags
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.pairing import PairedGains
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.zeros import bandwidth_limit

# Relative gains in this range need no more than independent single loops.
_EASY = (0.67, 1.5)
# Above this a decoupler or an inverse follows small errors of the model.
_ILL_CONDITIONED = 10.0
# An output with more than this of a direction of length one has it alone.
_ALONE = 0.99
# A part of a root below this share of its magnitude is not shown.
_ROUNDING = 1e-9
# What is faster than the sampling period by so much makes simulations long.
_FAST = 50.0


def words_on_poles(model: LinearModel, poles: np.ndarray, constants: np.ndarray) -> list[str]:
    """Return sentences on stability, integrators, undamped oscillations and speed.

    Parameters
    ----------
    poles : ndarray [n], complex
        [rad/s]
    constants : ndarray [n]
        Time constants [s], in the order of the poles.
    """
    radius = origin_radius(model.A)
    unstable = [pole for pole in poles if pole.real > radius]
    at_origin = int(np.sum(np.abs(poles) <= radius))
    undamped = [pole for pole in poles if abs(pole.real) <= radius < pole.imag]
    decaying = constants[np.isfinite(constants) & (constants > 0.0)]
    words = []
    if unstable:
        words.append(
            f"The process is unstable: the pole at {root_text(unstable[0])} rad/s asks for a "
            f"closed loop faster than {2.0 * abs(unstable[0]):.3g} rad/s."
        )
    if at_origin:
        words.append(
            f"The process integrates ({at_origin} pole{'s' if at_origin > 1 else ''} at the "
            "origin): without control the level drifts with any imbalance of flows."
        )
    for pole in undamped:
        words.append(
            f"The process oscillates without damping at {pole.imag:.3g} rad/s (a period of "
            f"{2.0 * np.pi / pole.imag:.3g} s): what sets it swinging never dies out by itself."
        )
    if not unstable and not at_origin and not undamped and len(poles):
        words.append("The process is stable: left alone, every level settles.")
    if decaying.size:
        slowest, fastest = time_text(decaying.max()), time_text(decaying.min())
        words.append(
            f"Its slowest time constant is {slowest} and its fastest {fastest}."
            if slowest != fastest
            else f"Its time constant is {slowest}."
            if decaying.size == 1
            else f"Its {decaying.size} time constants are {slowest}."
        )
    return words


def words_on_speed(model: LinearModel, poles: np.ndarray, period: float) -> list[str]:
    """Return a sentence on what settles so far within a sample that a simulation takes long.

    It names the state that takes part most in the fastest mode, by the products of the entries of
    its right and left eigenvectors. Lags of instruments that have settled by the next sample ask
    for no such steps.

    Parameters
    ----------
    poles : ndarray [n], complex
        [rad/s]
    period : float
        The sampling period [s].
    """
    from scipy.linalg import eig

    if np.max(np.abs(poles), initial=0.0) * period < _FAST:
        return []
    others = np.delete(np.arange(len(model.states)), settled_lags(model, period))
    values, left, right = eig(model.A[np.ix_(others, others)], left=True)
    times = float(np.max(np.abs(values), initial=0.0)) * period
    if times < _FAST:
        return []
    fastest = int(np.argmax(np.abs(values)))
    constant = f"{period / times:.3g} s"
    state = model.states[others[int(np.argmax(np.abs(left[:, fastest] * right[:, fastest])))]]
    return [
        f"The fastest time constant, {constant} of {state}, goes {times:.0f} times into the "
        f"sampling period of {time_text(period)}: a simulation takes {times / REACH:,.0f} steps a "
        "sample, and so a study takes long."
    ]


def words_on_zeros(model: LinearModel, zeros: np.ndarray, minimum_phase: bool) -> list[str]:
    """Return sentences on the zeros that limit control.

    The figure is that of `bandwidth_limit`.

    Parameters
    ----------
    zeros : ndarray, complex
        [rad/s], rightmost first.
    """
    radius = origin_radius(model.A)
    words = []
    for zero in zeros:
        if zero.real > radius and zero.imag >= 0.0:
            limit = bandwidth_limit(zero)
            words.append(
                f"The zero at {root_text(zero)} rad/s in the right half-plane limits the closed "
                f"loop to a bandwidth of about {limit:.2g} rad/s (a time constant of at least "
                f"about {1.0 / limit:.3g} s): at first some combination of the outputs moves the "
                "wrong way."
            )
        elif abs(zero.real) <= radius and zero.imag > radius:
            words.append(
                f"The zeros at {root_text(zero)} rad/s stand on the imaginary axis: the process "
                "cannot be moved at that frequency in some direction, and its inverse rings."
            )
        elif abs(zero) <= radius:
            words.append(
                "A zero stands at the origin: no constant input holds some combination of the "
                "outputs at a new value, so integral action on all of them cannot be stable."
            )
    if words:
        words.append(
            "A controller that inverts the process (feedback linearisation, perfect decoupling) is "
            "internally unstable here, whatever its gains."
        )
    elif not minimum_phase:
        words.append("At every frequency some combination of the outputs answers to no input.")
    elif len(zeros):
        words.append(
            f"Every transmission zero is in the left half-plane (the rightmost at "
            f"{root_text(zeros[0])} rad/s): the process is minimum phase."
        )
    else:
        words.append("There are no finite transmission zeros.")
    return words


def words_on_dead_time(model: LinearModel, dead_times: np.ndarray, note: str) -> list[str]:
    """Return sentences on the dead time of each pair and what it allows.

    The figure is the bandwidth limit 1/θ (Skogestad and Postlethwaite, Multivariable Feedback
    Control, 2nd ed., chapter 5).

    Parameters
    ----------
    dead_times : ndarray [q, m]
        [s]
    note : str
        In which sense there are poles and zeros.
    """
    words = []
    for output, row in zip(model.outputs, dead_times, strict=True):
        for name, time in zip(model.inputs, row, strict=True):
            if np.isnan(time):
                words.append(
                    f"{output} answers to {name} by ways of different dead time, or by a loop "
                    "with dead time in it: no single dead time describes it."
                )
            elif time > 0.0:
                words.append(
                    f"{output} answers to {name} after a dead time of {time:.4g} s, which limits "
                    f"a loop between them to a bandwidth of about {1.0 / time:.2g} rad/s."
                )
    return [*words, note] if note else words


def words_on_zero_directions(model: LinearModel, zeros: Sequence[ZeroDirection]) -> list[str]:
    """Return which outputs a zero in the right half-plane hurts.

    Parameters
    ----------
    zeros : sequence of ZeroDirection
        In the right half-plane, their directions in ranges.

    Examples
    --------
    >>> one = np.eye(2)
    >>> model = LinearModel(-0.02 * one, one, one[:, :0], one, 0.0 * one,
    ...                     ("a", "b"), ("u", "v"), (), ("y", "z"))
    >>> words_on_zero_directions(model, [ZeroDirection(0.01 + 0j, np.array([1.0, 0.0]),
    ...                                                np.array([0.8, -0.6]))])
    ['The zero at +0.0100 rad/s acts on y (share 0.80) and z (−0.60): they cannot all move the \
right way at once, but which of them suffers can be chosen.']
    """
    words = []
    for found in zeros:
        if len(model.outputs) < 2:
            continue
        sizes = np.abs(found.output_direction)
        if sizes.max() > _ALONE:
            name = model.outputs[int(np.argmax(sizes))]
            words.append(
                f"The zero at {root_text(found.zero)} rad/s acts on {name} alone: the other "
                "outputs do not feel it."
            )
            continue
        shares = [
            f"{name} ({'share ' if not place else ''}{_share(value)})"
            for place, (name, value) in enumerate(
                zip(model.outputs, found.output_direction, strict=True)
            )
            if abs(value) > 1.0 - _ALONE
        ]
        words.append(
            f"The zero at {root_text(found.zero)} rad/s acts on {' and '.join(shares)}: they "
            "cannot all move the right way at once, but which of them suffers can be chosen."
        )
    return words


def _share(value: complex) -> str:
    size = value.real if abs(value.imag) <= _ROUNDING * abs(value) else abs(value)
    return f"{size:.2f}".replace("-", "−")


def words_on_gain(model: LinearModel, gain: np.ndarray) -> list[str]:
    """Return sentences on outputs that integrate and on inputs that do nothing.

    Parameters
    ----------
    gain : ndarray [q, m]
        Static gain.
    """
    words = []
    for output, row in zip(model.outputs, gain, strict=True):
        names = [name for name, value in zip(model.inputs, row, strict=True) if np.isinf(value)]
        if names:
            words.append(f"{output} integrates {' and '.join(names)}: its static gain is infinite.")
        elif not row.any():
            words.append(f"{output} does not answer to any input at steady state.")
    for name, column in zip(model.inputs, gain.T, strict=True):
        if not column.any():
            words.append(f"{name} moves no controlled output at steady state.")
    return words


def words_on_interaction(
    model: LinearModel,
    relative_gain: np.ndarray | None,
    pairing: Sequence[PairedGains],
    index: float | None,
) -> list[str]:
    """Return sentences on the suggested pairing and how the loops disturb each other.

    Parameters
    ----------
    relative_gain : ndarray [q, m] or None
    index : float or None
        Niederlinski index of the pairing.
    """
    if relative_gain is None:
        return [
            f"The static gain is singular: {', '.join(model.outputs)} cannot be set independently "
            f"by {', '.join(model.inputs)}."
        ]
    gains = [pair.at_crossover if pair.changed_by_others else pair.at_rest for pair in pairing]
    pairs = ", ".join(
        f"{pair.output} with {pair.input} (relative gain {relative_gain_text(pair)})"
        for pair in pairing
    )
    words = [f"Pair {pairs}."]
    late = [pair for pair in pairing if pair.changed_by_others]
    if late:
        first = max(late, key=lambda pair: pair.crossover)
        words.append(
            f"Each of {listed([pair.output for pair in late])} answers quite otherwise once "
            f"the others are controlled: close {first.output}, the fastest, first, and keep them "
            "closed together."
        )
    if min(gains) <= 0.0:
        words.append(
            "No pairing has only positive relative gains: a loop would change the sign of its gain "
            "when another is opened or saturates; use a multivariable controller."
        )
    elif len(gains) > 1 and (min(gains) < _EASY[0] or max(gains) > _EASY[1]):
        words.append("The loops disturb each other strongly: tune them together, or slow one down.")
    elif len(gains) > 1:
        words.append("The loops disturb each other little enough for single-loop controllers.")
    if np.abs(relative_gain).max() > _ILL_CONDITIONED:
        words.append(
            "Relative gains this large make decoupling follow every small error of the model: "
            "avoid controllers built on its inverse."
        )
    if index is not None and index < 0.0:
        words.append(
            f"The Niederlinski index is {index:.2f}, below zero: with integral action in every "
            "loop this pairing is unstable, however it is tuned."
        )
    return words


def relative_gain_text(pair: PairedGains) -> str:
    """Return the relative gain of a pair, where the others change it, both.

    Examples
    --------
    >>> relative_gain_text(PairedGains("flow", "valve", 0.0, 0.004, 0.99))
    '0.99 at 0.0040 rad/s, 0.00 at rest'
    """
    # Rounded first, so that of two that are 0.625 both are told alike; and no zero is negative.
    at_rest = f"{round(pair.at_rest, 9) + 0.0:.2f}"
    if not pair.changed_by_others:
        return at_rest
    return f"{pair.at_crossover:.2f} at {pair.crossover:#.2g} rad/s, {at_rest} at rest"


def root_text(root: complex) -> str:
    """Return a pole or zero with its sign, a conjugate pair as one.

    A real or imaginary part that is only rounding is left out.

    Parameters
    ----------
    root : complex
        [rad/s]

    Examples
    --------
    >>> root_text(0.01276), root_text(-0.5 + 0.25j), root_text(2j), root_text(0)
    ('+0.0128', '−0.500 ± 0.250j', '±2.00j', '0')
    """
    root = complex(root)
    rounding = _ROUNDING * abs(root)
    real = _three_digits(root.real, "+") if abs(root.real) > rounding else ""
    imaginary = f"{_three_digits(abs(root.imag))}j" if abs(root.imag) > rounding else ""
    if real and imaginary:
        return f"{real} ± {imaginary}"
    return f"±{imaginary}" if imaginary else real or "0"


def _three_digits(value: float, sign: str = "") -> str:
    return f"{value:{sign}#.3g}".rstrip(".").replace("-", "−")
