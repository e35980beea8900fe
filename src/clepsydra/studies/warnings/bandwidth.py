"""Warnings of a bandwidth that a zero in the right half-plane or a dead time forbids."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.words import listed, time_text
from clepsydra.linear.dead_time import dead_times
from clepsydra.linear.directions import ZeroDirection
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.response import frequency_response
from clepsydra.studies.warnings.loop_response import LoopResponse

#: Where the sensitivity in a direction reaches this from below, the bandwidth ends.
_BANDWIDTH = math.sqrt(0.5)
#: An output with at least this share of a direction is named.
_NAMED = 0.3


def largest_bandwidth(zero: complex) -> float:
    """Return the largest bandwidth that a zero in the right half-plane leaves [rad/s].

    That is z/2 for a real zero, where (z - s)/(z + s) has taken 53° of phase. Of a conjugate
    pair x ± jy the all-pass takes as much at sqrt(4 x² + |z|²) - 2 x, which is |z|/4.2 for a
    pair near the real axis and |z| for one near the imaginary axis.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    5.7, whose limits are |z|/4, |z|/2.8 and |z|.

    Examples
    --------
    >>> largest_bandwidth(0.02 + 0j), round(largest_bandwidth(0.0 + 0.02j), 6)
    (0.01, 0.02)
    """
    if zero.imag == 0.0:
        return zero.real / 2.0
    return math.hypot(2.0 * zero.real, abs(zero)) - 2.0 * zero.real


def bandwidth_in(response: LoopResponse, direction: np.ndarray) -> float | None:
    """Return the frequency up to which a direction of the outputs is controlled [rad/s].

    That is where |direction^H S(jω)| first reaches 0.707 from below.

    Parameters
    ----------
    direction : ndarray [q], complex
        Of length one, in shares of the ranges.

    Returns
    -------
    float or None
        None where the loop does not control it at any frequency.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.warnings.loop_response import loop_response
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> round(bandwidth_in(loop_response(controller, plant.linear), np.array([1.0, 0.0])), 2)
    0.1
    """
    sizes = np.linalg.norm(np.einsum("i,kij->kj", direction.conj(), response.at_output), axis=1)
    above = np.flatnonzero(sizes >= _BANDWIDTH)
    if not above.size:
        return float(response.frequencies[-1])
    first = int(above[0])
    if first == 0:
        return None
    around = slice(first - 1, first + 1)
    low, high = np.log(sizes[around] / _BANDWIDTH)
    share = low / (low - high)
    slower, faster = np.log(response.frequencies[around])
    return float(np.exp(slower + share * (faster - slower)))


def bandwidth_warnings(
    model: LinearModel, response: LoopResponse, zeros: list[ZeroDirection]
) -> Iterator[Remark]:
    """Return warnings of a bandwidth above what zeros and dead times allow.

    The bandwidth is taken in the output direction of each zero, and compared with
    `largest_bandwidth`. The crossover frequency of each output, the other loops closed, is
    compared with 1/θ, θ the smallest dead time on a way to it; where ways of different dead
    times lead from one input to it, it is not.

    Parameters
    ----------
    model : LinearModel
        From the manipulated variables of the controller to its controlled measurements.
    zeros : list of ZeroDirection
        Of `blocking_zeros(model)`.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, sections
    5.6 and 5.7.
    """
    for found in zeros:
        limit, asked = largest_bandwidth(found.zero), bandwidth_in(response, found.output_direction)
        if asked is not None and asked > limit:
            sizes = np.abs(found.output_direction)
            named = [
                name
                for size, name in sorted(zip(sizes, model.outputs, strict=True), reverse=True)
                if size >= _NAMED
            ]
            yield Remark(
                f"The controller asks for a bandwidth of {asked:.3g} rad/s in {listed(named)}, "
                f"but the zero at {_zero(found.zero)} rad/s in the right half-plane allows "
                f"about {limit:.3g} rad/s",
                "what moves faster first goes the wrong way",
                f"make the loop {_at_least(asked / limit)} times slower, or control something else",
            )
    late = dead_times(model)
    ways = frequency_response(model, response.frequencies[:1])[0] != 0.0
    for row, name in enumerate(model.outputs):
        times = late[row][ways[row]]
        # No number: ways of different dead times lead there, and the shortest is not known.
        dead_time = float(np.min(times)) if times.size and np.all(times > 0.0) else 0.0
        crossover = response.channels[name].bandwidth
        if crossover * dead_time > 1.0:
            yield Remark(
                f"The loop of {name} crosses over at {crossover:.3g} rad/s, but its dead time "
                f"of {time_text(dead_time)} allows about {1.0 / dead_time:.3g} rad/s",
                "within the dead time nothing can be corrected",
                f"make the loop {_at_least(crossover * dead_time)} times slower",
            )


def _zero(zero: complex) -> str:
    return f"{zero.real:.3g}" + (f" ± {zero.imag:.3g}j" if zero.imag else "")


def _at_least(factor: float) -> str:
    """Return by how much to slow down, rounded up."""
    return f"{math.ceil(10.0 * factor) / 10.0:.1f}"
