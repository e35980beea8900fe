"""Which input is to control which output: by relative gains where the loops will act."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.expected_crossover import expected_crossovers
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.relative_gain_array import (
    relative_gain_response,
    relative_gains,
    suggest_pairing,
)
from clepsydra.linear.roots import roots_of
from clepsydra.linear.zeros import bandwidth_limit

# A relative gain at rest below this is negative; nearer to zero it is rounding.
_NEGATIVE = -1e-6
# A pair whose relative gain at rest is below this share of that around crossover is another one
# with the other loops closed.
_BY_THE_OTHERS = 0.5


class PairedGains(NamedTuple):
    """A pair, with its relative gain at rest and where its loop is expected to act.

    Parameters
    ----------
    output, input : str
    at_rest : float
        [1], the limit for a process that integrates.
    crossover : float
        [rad/s], how fast the loop of the output can be expected to act by its best input; zero
        where that is not known.
    at_crossover : float
        [1], the real part at that frequency; that at rest where it is zero.
    """

    output: str
    input: str
    at_rest: float
    crossover: float
    at_crossover: float

    @property
    def changed_by_others(self) -> bool:
        """Whether at rest its output answers far more to its input once the others are closed."""
        return abs(self.at_rest) < _BY_THE_OTHERS * self.at_crossover


def paired_gains(
    model: LinearModel, pairing: Sequence[tuple[str, str]] | None = None
) -> list[PairedGains]:
    """Return the pairs of a pairing with their relative gains; of the one suggested for None.

    The suggested one has relative gains near to one around the frequencies at which its loops
    are expected to act: there a loop meets what the others do, and at rest integral action sees
    to it. A pair whose relative gain at rest is negative is taken only where no pairing avoids
    it, since its loop is unstable, or makes the others so, once others open or saturate. Zeros in
    the right half-plane limit how fast the loops can act, to half of the zero. Without ranges,
    or for a single loop, gains at rest decide.

    Parameters
    ----------
    pairing : sequence of (output, input), optional
        Of some outputs and inputs of the model; the others stay as they are.

    Raises
    ------
    InputError
        The static gain is singular.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    10.6.

    Examples
    --------
    >>> import clepsydra as cl
    >>> pair = paired_gains(cl.load("quadruple-tank").analysis.model)[0]
    >>> pair.output, pair.input, round(pair.at_rest, 2), round(pair.at_crossover, 2)
    ('level_1', 'pump_1', 1.4, 0.98)
    """
    if pairing is not None:
        outputs, inputs = zip(*pairing, strict=True)
        model = model.select(outputs, inputs)
    shares = compared(model)
    at_rest = relative_gains(shares).real
    crossovers = _crossovers(model) if min(at_rest.shape) > 1 else None
    if crossovers is None:
        crossovers = np.zeros(len(at_rest))
    around = _around(shares, crossovers, at_rest)
    if pairing is None:
        pairing = suggest_pairing(around, model.outputs, model.inputs, at_rest < _NEGATIVE)
    found = []
    for output, name in pairing:
        row, column = model.outputs.index(output), model.inputs.index(name)
        gains = float(at_rest[row, column]), float(crossovers[row]), float(around[row, column])
        found.append(PairedGains(output, name, *gains))
    return found


def compared(model: LinearModel) -> LinearModel:
    """Return what relative gains are taken of: only those of a square process need no ranges."""
    if len(model.inputs) == len(model.outputs):
        return model
    return in_known_ranges(model) or model


def _crossovers(model: LinearModel) -> np.ndarray | None:
    """Return how fast the loop of each output may act by its best input [q, rad/s]."""
    each = expected_crossovers(model)
    if each is None:
        return None
    roots = roots_of(model)
    rising = roots.zeros[roots.zeros.real > origin_radius(roots.zeros_of.A)]
    limit = min((bandwidth_limit(zero) for zero in rising), default=np.inf)
    return np.minimum(each.max(axis=1), limit)


def _around(model: LinearModel, crossovers: np.ndarray, at_rest: np.ndarray) -> np.ndarray:
    """Return the relative gains of each output where its loop acts, at rest where it cannot."""
    found = at_rest.copy()
    for row in np.flatnonzero(crossovers > 0.0):
        with suppress(InputError):  # a zero at just that frequency
            found[row] = relative_gain_response(model, crossovers[row])[0, row].real
    return found
