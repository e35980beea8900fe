"""The flow of pumps of whose discharge part runs back through an open line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca

from clepsydra.process.two_roots import NOTHING, balanced_head


def flow_beside_a_line(
    segments: Sequence[tuple[float, float]],
    corners: Sequence[float],
    conductance: ca.SX,
    lift: Any,
    pumps: Any,
    line: Any,
) -> tuple[ca.SX, ca.SX]:
    """Return what goes through the throttle, and what each pump gives [m³/s].

    What N pumps of the curve H = a - b x² give goes through throttle and line:

        √(p (a - H)) = G √(H - H_s) + G_r √H,    p = N²/b.

    Squared, this is the balance of `clepsydra.process.two_roots` for the head y = H - H_s at the
    throttle, with e = p (a - H_s) - G_r² H_s, c = p + G² + G_r² and m = G G_r.
    Below e = 0 the line takes all before the head reaches the lift, and the throttle gets nothing;
    where p a + G² H_s < 0 the source stands so high that no head is left for the line.

    Parameters
    ----------
    segments : sequence of (float, float)
        a [m] and b [s²/m⁵] between two points of the curve each.
    corners : sequence of float
        The flows at which they meet [m³/s].
    conductance : casadi.SX
        G, of pipe and throttle [m³/s per root of a metre].
    lift : casadi.SX
        H_s [m]
    pumps : casadi.SX
        N
    line : casadi.SX
        G_r, of the line back [m³/s per root of a metre].

    Examples
    --------
    A pump that gives 4 l/s, a quarter of it back, at 16 m against 7 m:

    >>> into, flow = flow_beside_a_line(
    ...     [(32.0, 1e6)], [], ca.SX(1e-3), 7.0, 1.0, 0.25e-3)
    >>> round(float(into) * 1e3, 6), round(float(flow) * 1e3, 6)
    (3.0, 4.0)
    """
    squared, back, product = conductance * conductance, line * line, conductance * line
    shut_off, per_slope = (ca.SX(each) for each in _inverted(segments[0]))
    for corner, segment, following in zip(corners, segments, segments[1:], strict=False):
        # Throttle and line take more where the segments meet: the flow is larger.
        head = segment[0] - segment[1] * corner**2
        spare, above = ca.fmax(head - lift, 0), max(head, 0.0)
        left = (pumps * corner) ** 2 - (squared * spare + back * above)
        more = ca.logic_or(left < 0, left * left < 4 * (product * product) * (spare * above))
        a, per_b = _inverted(following)
        shut_off, per_slope = ca.if_else(more, a, shut_off), ca.if_else(more, per_b, per_slope)
    p = pumps * pumps * per_slope
    runs_back = p * shut_off + squared * lift > 0
    line, back, product = (ca.if_else(runs_back, each, 0) for each in (line, back, product))
    excess = p * (shut_off - lift) - back * lift
    e, divisor = balanced_head(excess, p + (squared + back), product, lift)
    into = ca.if_else(excess > 0, conductance * (e / ca.sqrt(divisor)), 0)
    head = ca.if_else(excess > 0, lift + e * e / divisor, p * shut_off / (p + back))
    return into, (into + line * ca.sqrt(ca.fmax(head, NOTHING))) / pumps


def _inverted(segment: tuple[float, float]) -> tuple[float, float]:
    """Return a and 1/b."""
    return segment[0], 1 / segment[1]
