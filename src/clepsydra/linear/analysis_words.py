"""What poles, zeros, gains and relative gains mean for control, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import origin_radius

# Relative gains in this range need no more than independent single loops.
_EASY = (0.67, 1.5)
# Above this a decoupler or an inverse follows small errors of the model.
_ILL_CONDITIONED = 10.0
# A part of a root below this share of its magnitude is not shown.
_ROUNDING = 1e-9


def words_on_poles(model: LinearModel, poles: np.ndarray, constants: np.ndarray) -> list[str]:
    """Return sentences on stability, integrators, undamped oscillations and speed.

    Parameters
    ----------
    model : LinearModel
    poles : ndarray [n], complex
        [rad/s]
    constants : ndarray [n]
        Time constants [s], in the order of the poles.

    Examples
    --------
    >>> one = np.eye(1)
    >>> model = LinearModel(-0.02 * one, one, one[:, :0], one, 0.0 * one,
    ...                     ("tank.level",), ("pump",), (), ("level",))
    >>> words_on_poles(model, np.array([-0.02 + 0j]), np.array([50.0]))
    ['The process is stable: left alone, every level settles.', 'Its time constant is 50 s.']
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
        words.append(
            f"Its slowest time constant is {decaying.max():.3g} s and its fastest "
            f"{decaying.min():.3g} s."
            if decaying.size > 1
            else f"Its time constant is {decaying[0]:.3g} s."
        )
    return words


def words_on_zeros(model: LinearModel, zeros: np.ndarray, minimum_phase: bool) -> list[str]:
    """Return sentences on the zeros that limit control.

    The figure is the bandwidth limit z/2 of a real zero, |z|/4 of a complex pair nearer to the
    real than to the imaginary axis, and |z|/2.8 of one nearer to the imaginary axis (Skogestad
    and Postlethwaite, Multivariable Feedback Control, 2nd ed., chapter 5; the last is cautious).

    Parameters
    ----------
    model : LinearModel
    zeros : ndarray, complex
        [rad/s], rightmost first.
    minimum_phase : bool

    Examples
    --------
    >>> one = np.eye(1)
    >>> model = LinearModel(-0.02 * one, one, one[:, :0], one, 0.0 * one,
    ...                     ("tank.level",), ("pump",), (), ("level",))
    >>> words_on_zeros(model, np.array([]), minimum_phase=True)
    ['There are no finite transmission zeros.']
    """
    radius = origin_radius(model.A)
    words = []
    for zero in zeros:
        if zero.real > radius and zero.imag >= 0.0:
            limit = _bandwidth_limit(zero)
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


def words_on_gain(model: LinearModel, gain: np.ndarray) -> list[str]:
    """Return sentences on outputs that integrate and on inputs that do nothing.

    Parameters
    ----------
    model : LinearModel
    gain : ndarray [q, m]
        Static gain.

    Examples
    --------
    >>> one = np.eye(1)
    >>> model = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                     ("tank.level",), ("pump",), (), ("level",))
    >>> words_on_gain(model, np.array([[np.inf]]))
    ['level integrates pump: its static gain is infinite.']
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
    pairing: Sequence[tuple[str, str]],
    index: float | None,
) -> list[str]:
    """Return sentences on the suggested pairing and how the loops disturb each other.

    Parameters
    ----------
    model : LinearModel
    relative_gain : ndarray [q, m] or None
    pairing : sequence of (output, input)
    index : float or None
        Niederlinski index of the pairing.

    Examples
    --------
    >>> one = np.eye(1)
    >>> model = LinearModel(-0.02 * one, one, one[:, :0], one, 0.0 * one,
    ...                     ("tank.level",), ("pump",), (), ("level",))
    >>> words_on_interaction(model, np.array([[1.0]]), [("level", "pump")], 1.0)
    ['Pair level with pump (relative gain 1.00).']
    """
    if relative_gain is None:
        return [
            f"The static gain is singular: {', '.join(model.outputs)} cannot be set independently "
            f"by {', '.join(model.inputs)}."
        ]
    gains = [
        float(relative_gain[model.outputs.index(output), model.inputs.index(name)].real)
        for output, name in pairing
    ]
    pairs = ", ".join(
        f"{output} with {name} (relative gain {gain:.2f})"
        for (output, name), gain in zip(pairing, gains, strict=True)
    )
    words = [f"Pair {pairs}."]
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


def _bandwidth_limit(zero: complex) -> float:
    if zero.imag == 0.0:
        return zero.real / 2.0
    return float(abs(zero)) / (4.0 if zero.real > abs(zero.imag) else 2.8)
