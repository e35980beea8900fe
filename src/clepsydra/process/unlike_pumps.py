"""The flow of two unlike pumps on one header, where the summed curves meet what takes it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import casadi as ca

from clepsydra.process.pump_curve import LAMINAR, PumpCurve
from clepsydra.process.root_law import falling_root
from clepsydra.process.two_roots import NOTHING, balanced_head


class LikePumps(NamedTuple):
    """Pumps of one kind on a header: their curve as it sees one of them, and how many run."""

    curve: PumpCurve
    pumps: Any


def flow_of_unlike_pumps(
    first: LikePumps, second: LikePumps, conductance: ca.SX, lift: Any
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return what goes through the throttle, and what each pump of the two kinds gives [m³/s].

    Between two points of both curves Hᵢ = aᵢ - bᵢ x², and one head H is on the header:

        P₁ √(a₁ - H) + P₂ √(a₂ - H) = G √(H - H_s),    Pᵢ = Nᵢ/√bᵢ.

    Squared, this is the balance of `clepsydra.process.two_roots` for y = a₂ - H, with
    e = G² (a₂ - H_s) - P₁² (a₁ - a₂), c = G² + P₁² + P₂², m = P₁ P₂ and d = a₁ - a₂. Above the
    highest head of the weaker kind its check valves are shut, and the stronger gives all. A curve
    that begins flat, as with an automatic recirculation valve, gives at that head whatever is
    missing, up to its minimum flow.

    Parameters
    ----------
    conductance : casadi.SX
        G, of pipe and throttle [m³/s per root of a metre].
    lift : casadi.SX
        H_s [m]

    Examples
    --------
    At 16 m one gives 4 l/s and the other 3 l/s, against 7 m:

    >>> curves = PumpCurve(((0.0, 32.0), (4e-3, 16.0))), PumpCurve(((0.0, 25.0), (3e-3, 16.0)))
    >>> one, other = (LikePumps(curve, 1.0) for curve in curves)
    >>> found = flow_of_unlike_pumps(one, other, ca.SX(7e-3 / 3), 7.0)
    >>> [round(float(flow) * 1e3, 9) for flow in found]
    [7.0, 4.0, 3.0]
    """
    swapped = second.curve.highest > first.curve.highest
    strong, weak = (second, first) if swapped else (first, second)
    top = weak.curve.highest
    squared = conductance * conductance

    def below(head: float) -> ca.SX:
        """Return whether the throttle takes more than all pumps give at a head."""
        given = sum(each.pumps * each.curve.flow_at(head) for each in (strong, weak))
        return given * given < squared * ca.fmax(head - lift, 0)

    (a, p), (b, q) = (_segment(each, top, below) for each in (strong, weak))
    product, apart = p * q, a - b
    excess = squared * (b - lift) - p * p * apart
    e, divisor = balanced_head(excess, squared + (p * p + q * q), product, apart)
    of_weak = q * (e / ca.sqrt(divisor))
    of_strong = p * ca.sqrt(ca.fmax(e * e / divisor + apart, NOTHING))
    alone = strong.curve.throttled(conductance, lift, strong.pumps)
    if weak.curve.is_flat:
        # What is missing at the head at which it begins comes from the weaker kind.
        alone = ca.fmax(alone, conductance * falling_root(top - lift, LAMINAR))
    most = strong.pumps * strong.curve.flow_at(top)
    both = below(top)
    into = ca.if_else(both, of_strong + of_weak, alone)
    of_strong = ca.if_else(both, of_strong, ca.fmin(alone, most))
    each = of_strong / strong.pumps, (into - of_strong) / weak.pumps
    return (into, *(reversed(each) if swapped else each))


def _segment(kind: LikePumps, top: float, below: Callable[[float], ca.SX]) -> tuple[ca.SX, ca.SX]:
    """Return a [m] and N/√b of the segment in which a kind works where it is below a head."""
    falling = [
        (end[1], a, b**-0.5)
        for (_, end), (a, b) in zip(pairwise(kind.curve.points), kind.curve.segments, strict=True)
        if b > 0.0
    ]
    within = [each for each in falling if each[0] < top] or falling[-1:]
    shut_off, slope = ca.SX(within[0][1]), ca.SX(within[0][2])
    for (corner, *_), (_, a, per_root) in pairwise(within):
        beyond = below(corner)
        shut_off, slope = ca.if_else(beyond, a, shut_off), ca.if_else(beyond, per_root, slope)
    return shut_off, kind.pumps * slope
