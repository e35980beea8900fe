"""Detuning: all loops slowed down together until they bear each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.pid_settings import PidSettings

#: The largest peak of the sensitivity that is let pass.
SENSITIVITY_LIMIT = 2.0
#: The most that loops are slowed down by.
LARGEST_FACTOR = 1000.0
_STEP = 2.0**0.25
#: The search for the factor ends this near below the limit, a share of it.
_ACCURACY = 1e-5
_ITERATIONS = 60

#: Settings of all loops to the peak of their sensitivity, infinite where they are unstable.
Peak = Callable[[Sequence[PidSettings]], float]


class Detuned(NamedTuple):
    """Settings after detuning, the factor used and the peak of the sensitivity reached.

    Examples
    --------
    >>> Detuned((PidSettings(3.0, 30.0),), 1.0, 1.6).peak
    1.6
    """

    settings: tuple[PidSettings, ...]
    factor: float
    peak: float


def detune(
    settings_at: Callable[[float], Sequence[PidSettings]], peak: Peak, method: str
) -> Detuned:
    """Return the fastest settings whose loops, all closed, have a sensitivity peak of 2.

    One factor F ≥ 1 slows all loops down. F grows by a quarter of an octave until the largest
    singular value of S(e^jωT) stays at or below 2 at every frequency, and is then brought back
    to where it is 2. It is Luyben's way of detuning, with the peak of the multiloop sensitivity
    in the place of his log modulus.

    Parameters
    ----------
    settings_at : callable
        Takes F and returns the settings of all loops.
    peak : callable
        Takes settings and returns the peak of the sensitivity, infinite where the loops are
        unstable.
    method : str
        For the message.

    Raises
    ------
    NotApplicable
        No factor up to 1000 is enough.

    References
    ----------
    W. L. Luyben, Simple method for tuning SISO controllers in multivariable systems,
    Industrial & Engineering Chemistry Process Design and Development 25(3), 1986, 654-660.

    Examples
    --------
    Where the peak is 1 + K, a gain of 3 has to be divided by 3:

    >>> found = detune(lambda factor: [PidSettings(3.0 / factor, 30.0)],
    ...                lambda settings: 1.0 + settings[0].gain, "by hand")
    >>> round(found.factor, 3), round(found.peak, 3)
    (3.0, 2.0)
    """
    factors, peaks = [1.0], [peak(settings_at(1.0))]
    while peaks[-1] > SENSITIVITY_LIMIT:
        if factors[-1] >= LARGEST_FACTOR:
            raise NotApplicable(method, _hopeless(min(peaks)))
        factors.append(min(factors[-1] * _STEP, LARGEST_FACTOR))
        peaks.append(peak(settings_at(factors[-1])))
    factor, value = factors[-1], peaks[-1]
    if factor > 1.0:
        factor, value = _brought_back(factors[-2:], peaks[-2:], lambda F: peak(settings_at(F)))
    return Detuned(tuple(settings_at(factor)), factor, value)


def as_given(settings: Sequence[PidSettings], peak: Peak, method: str, choice: str) -> Detuned:
    """Return settings that the user chose, undetuned, with the peak that they have.

    Parameters
    ----------
    settings : sequence of PidSettings
    peak : callable
        As for `detune`.
    method, choice : str
        For the message: what was chosen.

    Raises
    ------
    NotApplicable
        The loops together are unstable.

    Examples
    --------
    >>> as_given([PidSettings(9.0, 1.0)], lambda settings: math.inf, "SIMC", "a time of 1 s")
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: SIMC is not applicable: the loops together \
are unstable at a time of 1 s.
    """
    found = Detuned(tuple(settings), 1.0, peak(settings))
    if math.isinf(found.peak):
        raise NotApplicable(method, f"the loops together are unstable at {choice}")
    return found


def _brought_back(
    factors: Sequence[float], peaks: Sequence[float], peak_at: Callable[[float], float]
) -> tuple[float, float]:
    """Return where between two factors the peak is just below the limit, and that peak.

    Regula falsi in the logarithm of the factor on 1/peak, which is continuous through the limit
    of stability; an end that stays twice is weighted down (the Illinois rule).
    """
    # Aimed half the accuracy inside, so that the search ends on the allowed side.
    aim = (1.0 + 0.5 * _ACCURACY) / SENSITIVITY_LIMIT
    low, high = map(math.log, factors)
    below, above = (1.0 / peak - aim for peak in peaks)
    value, moved = peaks[-1], ""
    for _ in range(_ITERATIONS):
        if value >= SENSITIVITY_LIMIT * (1.0 - _ACCURACY):
            break
        middle = high - above * (high - low) / (above - below)
        found = peak_at(math.exp(middle))
        if found <= SENSITIVITY_LIMIT:
            below *= 0.5 if moved == "high" else 1.0
            high, above, value, moved = middle, 1.0 / found - aim, found, "high"
        else:
            above *= 0.5 if moved == "low" else 1.0
            low, below, moved = middle, 1.0 / found - aim, "low"
    return math.exp(high), value


def _hopeless(smallest: float) -> str:
    reached = (
        "every one of them is unstable"
        if math.isinf(smallest)
        else f"the best sensitivity peak is {smallest:.2f}"
    )
    return (
        f"no common slowing down of the loops by up to {LARGEST_FACTOR:.0f} times brings the "
        f"sensitivity peak to {SENSITIVITY_LIMIT:g}: {reached}; another pairing or a "
        "multivariable controller is needed"
    )
