"""One element g(s) of a linear model, by its poles, zeros, gain and dead time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.dead_time import at_rest, lags_of
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.minimal_realisation import minimal_realisation
from clepsydra.linear.poles import origin_radius, rightmost_first
from clepsydra.linear.response import evaluate_transfer
from clepsydra.linear.zeros import zeros


@dataclass(frozen=True)
class TransferElement:
    """g(s) = e^(−sθ) · gain / s^integrators · Π(1 − s/z) / Π(1 − s/p).

    Parameters
    ----------
    gain : float
        Static gain, [output unit / input unit]; per second for each integrator.
    poles, zeros : tuple of complex
        Those away from the origin [rad/s].
    integrators : int
        Poles at the origin; negative for zeros there.
    dead_time : float
        θ [s]

    Examples
    --------
    >>> tank = TransferElement(2.0, (-0.02,), (), 0)
    >>> tank.magnitude(0.02) * math.sqrt(2.0), math.degrees(tank.phase(0.02))
    (2.0, -45.0)
    """

    gain: float
    poles: tuple[complex, ...]
    zeros: tuple[complex, ...]
    integrators: int
    dead_time: float = 0.0

    @property
    def sign(self) -> float:
        """The direction in which the output finally moves: 1 or −1."""
        return math.copysign(1.0, self.gain)

    def check(self, integrators: float = 1) -> None:
        """Refuse what no rule for single loops is for.

        Raises
        ------
        NotApplicable
            It is unstable, holds no output, or integrates more often than this.
        """
        if any(root.real >= 0.0 for root in self.poles):
            raise NotApplicable("the element is unstable without control")
        if self.integrators < 0:
            raise NotApplicable("the input cannot hold the output: its static gain is zero")
        if self.integrators > integrators:
            raise NotApplicable(f"the element integrates {self.integrators} times")

    def frequencies(self, delay: float, beyond: float, a_decade: int) -> list[float]:
        """Return frequencies [rad/s] from below its slowest root and delay to above its fastest."""
        total = delay + self.dead_time
        rates = [abs(root) for root in (*self.poles, *self.zeros)]
        rates += [1.0 / total] if total > 0.0 else []
        slowest, fastest = min(rates, default=1.0) / beyond, max(rates, default=1.0) * beyond
        count = int(a_decade * math.log10(fastest / slowest)) + 2
        return [slowest * (fastest / slowest) ** (k / (count - 1)) for k in range(count)]

    def magnitude(self, omega: float) -> float:
        """Return |g(jω)| at ω [rad/s]."""
        size = abs(self.gain) / omega**self.integrators
        for zero in self.zeros:
            size *= abs(1.0 - 1j * omega / zero)
        for pole in self.poles:
            size /= abs(1.0 - 1j * omega / pole)
        return float(size)

    def phase(self, omega: float) -> float:
        """Return the phase of sign·g(jω) [rad], continuous in ω > 0, for a stable g.

        Each root turns by atan((ω − b)/a) with the root at −a + jb, so no multiple of 2π is
        lost.
        """
        angle = -0.5 * math.pi * self.integrators - omega * self.dead_time
        angle += sum(math.atan((omega - z.imag) / -z.real) for z in map(complex, self.zeros))
        angle -= sum(math.atan((omega - p.imag) / -p.real) for p in map(complex, self.poles))
        return angle


def transfer_element(model: LinearModel, output: str, input_name: str) -> TransferElement | None:
    """Return the element from an input to an output; None where the input does not move it.

    Dead time is exact where all ways from the input to the output take the same.

    Raises
    ------
    InputError
        A name is unknown.
    NotApplicable
        Ways of different dead time lead from the input to the output, or one stands in a loop.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> round(transfer_element(tank, "level", "pump").gain, 9)
    2.0
    """
    chosen = model.select(outputs=[output], inputs=[input_name])
    lags = lags_of(chosen)
    if lags is None:
        raise NotApplicable(
            f"{input_name} acts on {output} by ways of different dead time, or by a loop with "
            "dead time in it, so that one dead time and a rational function do not describe it"
        )
    return _element(model, output, input_name, float(lags.outputs[0] - lags.inputs[0]))


def moving_element(model: LinearModel, output: str, input_name: str) -> TransferElement:
    """Return the transfer function of a pair whose input moves its output.

    Raises
    ------
    NotApplicable
        It does not, or as for `transfer_element`.
    """
    found = transfer_element(model, output, input_name)
    if found is None:
        raise NotApplicable(f"{input_name} does not move {output}")
    return found


@lru_cache(maxsize=64)
def _element(
    model: LinearModel, output: str, input_name: str, dead_time: float
) -> TransferElement | None:
    """Return the element; every design of a study asks for the same ones."""
    chosen = at_rest(model.select(outputs=[output], inputs=[input_name]))
    A, B, C, D = minimal_realisation(chosen.A, chosen.B, chosen.C, chosen.D)
    if not len(A) and D[0, 0] == 0.0:
        return None
    poles = np.linalg.eigvals(A) if len(A) else np.zeros(0)

    def value_at(point: float) -> complex:
        return complex(evaluate_transfer(A, B, C, D, np.array([point]))[0, 0, 0])

    return element_of_roots(poles, zeros(chosen), origin_radius(model.A), value_at, dead_time)


def element_of_roots(
    poles: np.ndarray,
    zeros: np.ndarray,
    radius: float,
    value_at: Callable[[float], complex],
    dead_time: float,
) -> TransferElement:
    """Return the element with these poles and zeros and the gain that it has at some point.

    Parameters
    ----------
    poles, zeros : ndarray, complex
        [rad/s]
    radius : float
        Those no farther than this from the origin stand there [rad/s].
    value_at : callable
        g, but for its dead time, at a real s [rad/s].
    dead_time : float
        [s]

    Examples
    --------
    >>> none = np.zeros(0)
    >>> element_of_roots(np.array([-0.5]), none, 1e-9, lambda s: 3.0 / (s + 0.5), 0.0).gain
    6.0
    """
    moving_poles = _away_from_origin(rightmost_first(poles), radius)
    moving_zeros = _away_from_origin(rightmost_first(zeros), radius)
    integrators = (len(poles) - len(moving_poles)) - (len(zeros) - len(moving_zeros))
    # The gain is read off where g is neither near a root nor far from all of them.
    rates = [abs(root) for root in (*moving_poles, *moving_zeros)]
    point = 2.0 * max(rates, default=1.0)
    value = value_at(point)
    shape = math.prod((1.0 - point / zero for zero in moving_zeros), start=1.0 + 0.0j)
    shape /= point**integrators
    shape /= math.prod((1.0 - point / pole for pole in moving_poles), start=1.0 + 0.0j)
    return TransferElement(
        float((value / shape).real), moving_poles, moving_zeros, integrators, dead_time
    )


def _away_from_origin(roots: np.ndarray, radius: float) -> tuple[complex, ...]:
    return tuple(complex(root) for root in roots if abs(root) > radius)
