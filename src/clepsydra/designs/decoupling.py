"""Inverted decoupling: lead-lags between the inputs, so that each loop sees its own element."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.decoupling import Decoupling
from clepsydra.designs.applicability import NotApplicable, reasons_about
from clepsydra.designs.loops.pairing import PairedLoop
from clepsydra.designs.models.transfer_element import TransferElement, transfer_element

#: A lead that no lag of the process goes with gets a lag this much shorter.
LEAD_OVER_LAG = 10.0


class LeadLag(NamedTuple):
    """gain (lead s + 1)/(lag s + 1), and whether it is what it stands for exactly.

    Parameters
    ----------
    gain : float
        [unit of the own input / unit of the other]
    lead, lag : float
        [s], zero where it is a gain.
    exact : bool
        Whether it is −g_ij/g_ii itself and no approximation of it.
    """

    gain: float
    lead: float
    lag: float
    exact: bool


_NOTHING = LeadLag(0.0, 0.0, 0.0, True)


def inverted_decoupler(
    loops: Sequence[PairedLoop], kind: Decoupling = "dynamic"
) -> list[list[LeadLag]]:
    """Return the elements d_ij = −g_ij/g_ii of inverted decoupling for some pairs.

    u_i = c_i + Σ_{j≠i} d_ij u_j, with the output c_i of controller i and what is applied of the
    other inputs, each as a deviation from its operating point. Each controller then moves its
    own output by g_ii alone, as if the others were in manual.

    Parameters
    ----------
    loops : sequence of PairedLoop
        At least two.
    kind : {"dynamic", "static"}
        Lead-lags of first order, or gains that hold at rest only.

    Raises
    ------
    NotApplicable
        There are fewer than two pairs; an input does not move its output; an element cannot be
        realised (g_ii has more dead time, more excess of poles or a zero in the right
        half-plane, or g_ij integrates and g_ii does not); or the inputs that feed each other
        would run away: the matrix of the d_ij at rest, or at once, has a spectral radius of
        one or more.

    References
    ----------
    H. L. Wade, Inverted decoupling: a neglected technique, ISA Transactions 36(1), 1997, 3-10;
    J. Garrido, F. Vázquez and F. Morilla, An extended approach of inverted decoupling, Journal
    of Process Control, 2011.

    Examples
    --------
    The quadruple tank: pump 2 reaches tank 1 through tank 3, so d_12 lags as tank 3 does.

    >>> import clepsydra as cl
    >>> from clepsydra.designs.loops.pairing import paired_loops
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> found = inverted_decoupler(paired_loops(analysis.model, analysis.pairing))
    >>> round(found[0][1].lag, 2), found[0][1].exact
    (22.76, True)
    """
    if len(loops) < 2:
        raise NotApplicable("there is one loop only")
    found = [
        [_NOTHING if own is other else _of(own, other, kind) for other in loops] for own in loops
    ]
    _check_inner_loop(found)
    return found


def _of(own: PairedLoop, other: PairedLoop, kind: Decoupling) -> LeadLag:
    with reasons_about(f"{own.pair} and {other.input.name}"):
        cross = transfer_element(own.model, own.output.name, other.input.name)
        return _NOTHING if cross is None else decoupling_element(own.alone, cross, kind)


def decoupling_element(own: TransferElement, cross: TransferElement, kind: Decoupling) -> LeadLag:
    """Return d = −g_ij/g_ii as a gain or a lead-lag of first order.

    Where the quotient has more than one lead and one lag, or a dead time, the lead-lag has its
    gain and the first two derivatives at s = 0 (the Padé approximation [1/1]). Where that has
    no positive times it is a lag or a lead that has the first derivative alone.

    Parameters
    ----------
    own : TransferElement
        g_ii
    cross : TransferElement
        g_ij

    Raises
    ------
    NotApplicable
        The quotient cannot be realised.

    Examples
    --------
    g_ii = 2/(10 s + 1) and g_ij = 1/(4 s + 1):

    >>> decoupling_element(TransferElement(2.0, (-0.1,), (), 0),
    ...                    TransferElement(1.0, (-0.25,), (), 0), "dynamic")
    LeadLag(gain=-0.5, lead=10.0, lag=4.0, exact=True)
    """
    if cross.integrators > own.integrators:
        raise NotApplicable("the other input integrates and its own does not")
    gain = -cross.gain / own.gain if cross.integrators == own.integrators else 0.0
    if kind == "static" or gain == 0.0:
        return LeadLag(gain, 0.0, 0.0, False)
    _check_realisable(own, cross)
    above = [-1.0 / complex(root) for root in (*own.poles, *cross.zeros)]
    below = [-1.0 / complex(root) for root in (*cross.poles, *own.zeros)]
    above, below = _without_common(above, below)
    late = cross.dead_time - own.dead_time
    if len(above) <= 1 and len(below) <= 1 and late == 0.0:
        lead = above[0].real if above else 0.0
        return LeadLag(gain, lead, below[0].real if below else 0.0, True)
    first = sum(t.real for t in above) - sum(t.real for t in below) - late
    curved = 0.5 * sum((t * t).real for t in below) - 0.5 * sum((t * t).real for t in above)
    second = 0.5 * first * first + curved
    if first == 0.0:
        return LeadLag(gain, 0.0, 0.0, False)
    lag = -second / first
    lead = lag + first
    if lag > 0.0 and 0.0 <= lead <= LEAD_OVER_LAG * lag:
        return LeadLag(gain, lead, lag, False)
    if first < 0.0:
        return LeadLag(gain, 0.0, -first, False)
    lag = first / (LEAD_OVER_LAG - 1.0)
    return LeadLag(gain, LEAD_OVER_LAG * lag, lag, False)


def _check_realisable(own: TransferElement, cross: TransferElement) -> None:
    otherwise = "a static one, or another pairing, is needed"
    if own.dead_time > cross.dead_time:
        later = own.dead_time - cross.dead_time
        raise NotApplicable(f"its own input acts {later:.3g} s later than the other; {otherwise}")
    lags, others = (len(each.poles) + each.integrators - len(each.zeros) for each in (own, cross))
    if lags > others:
        raise NotApplicable(
            f"its own input acts through {lags} lags in series and the other through {others}, so "
            f"that the other cannot be met in time; {otherwise}"
        )
    if any(complex(root).real >= 0.0 for root in (*own.zeros, *cross.poles)):
        raise NotApplicable(
            "what its own input does at first goes the wrong way, or the other is unstable"
        )


def _without_common(
    above: list[complex], below: list[complex]
) -> tuple[list[complex], list[complex]]:
    """Return two lists of time constants without those that stand in both."""
    left, rest = [], list(below)
    for time in above:
        same = next((t for t in rest if abs(t - time) <= 1e-6 * abs(time)), None)
        if same is None:
            left.append(time)
        else:
            rest.remove(same)
    return left, rest


def _check_inner_loop(elements: list[list[LeadLag]]) -> None:
    """Refuse inputs that feed each other with a gain of one or more, at rest or at once."""
    gain, lead, lag, _ = np.moveaxis(np.array(elements), 2, 0)
    at_once = gain * np.divide(lead, lag, out=np.ones_like(lag), where=lag > 0.0)
    for matrix, when in ((gain, "at rest"), (at_once, "from one sample to the next")):
        radius = float(np.max(np.abs(np.linalg.eigvals(matrix))))
        if not math.isfinite(radius) or radius >= 1.0:
            raise NotApplicable(
                f"the inputs would feed each other with a gain of {radius:.3g} {when}, which must "
                "be below 1; another pairing is needed"
            )
