"""Detuning: all loops slowed down together until they bear each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from clepsydra.design.applicability import NotApplicable
from clepsydra.design.loop_transfer import PiSettings, loop_transfer
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.sensitivity import maximum_sensitivity

#: The largest peak of the sensitivity that is let pass.
SENSITIVITY_LIMIT = 2.0
_LARGEST_FACTOR = 1000.0
_STEP = 2.0**0.25
_BISECTIONS = 20


class Detuned(NamedTuple):
    """Settings after detuning, the factor used and the peak of the sensitivity reached."""

    settings: tuple[PiSettings, ...]
    factor: float
    peak: float


def slowed_down(settings: Sequence[PiSettings], factor: float) -> tuple[PiSettings, ...]:
    """Return the settings with K/F and F·Ti, Luyben's detuning.

    Examples
    --------
    >>> slowed_down([PiSettings(3.0, 30.0)], 2.0)
    (PiSettings(gain=1.5, integral_time=60.0),)
    """
    return tuple(PiSettings(each.gain / factor, each.integral_time * factor) for each in settings)


def detune(
    settings_at: Callable[[float], Sequence[PiSettings]],
    model: LinearModel,
    sampling_period: float,
    output_sizes: Sequence[float],
    method: str,
) -> Detuned:
    """Return the fastest settings whose loops, all closed, have a sensitivity peak of 2.

    One factor F ≥ 1 slows all loops down. The smallest F is taken at which the largest
    singular value of S(jω) stays at or below 2 at every frequency, with the interaction of the
    loops and the delay of sample and hold counted in. It is Luyben's way of detuning, with the
    peak of the multiloop sensitivity in the place of his log modulus.

    Parameters
    ----------
    settings_at : callable
        Takes F and returns the settings of all loops.
    model : LinearModel
        Its i-th input is moved by loop i.
    sampling_period : float
        [s]
    output_sizes : sequence of float
        The range of each output.
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
    A single tank with mild control needs none:

    >>> import numpy as np
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> mild = [PiSettings(1.0, 25.0)]
    >>> detune(lambda factor: slowed_down(mild, factor), tank, 1.0, [1.0], "by hand").factor
    1.0
    """

    def peak(factor: float) -> float:
        loop = loop_transfer(model, settings_at(factor), sampling_period, output_sizes)
        return maximum_sensitivity(*loop).peak

    factor, smallest = 1.0, math.inf
    while (value := peak(factor)) > SENSITIVITY_LIMIT:
        smallest = min(smallest, value)
        factor *= _STEP
        if factor > _LARGEST_FACTOR:
            reached = (
                "every one of them is unstable"
                if math.isinf(smallest)
                else f"the best sensitivity peak is {smallest:.2f}"
            )
            raise NotApplicable(
                method,
                f"no common slowing down of the loops by up to {_LARGEST_FACTOR:.0f} times "
                f"brings the sensitivity peak to {SENSITIVITY_LIMIT:g}: {reached}; another "
                "pairing or a multivariable controller is needed",
            )
    low, high = factor / _STEP, factor
    if factor > 1.0:
        for _ in range(_BISECTIONS):
            middle = math.sqrt(low * high)
            low, high = (low, middle) if peak(middle) <= SENSITIVITY_LIMIT else (middle, high)
    return Detuned(tuple(settings_at(high)), high, peak(high))
