"""A pump curve: head over flow at full speed, and the flow where it meets its pipe."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Self

import casadi as ca

from clepsydra.process.root_law import falling_root
from clepsydra.process.table_reader import TableReader

#: Flow below which it grows smoothly from zero, as a share of the last flow of the curve.
_SMALL_FLOW = 0.01
#: Head to spare below which the flow through a throttle is laminar [m].
LAMINAR = 1e-3


@dataclass(frozen=True)
class PumpCurve:
    """Head over flow at full speed, H = f(q), and by the affinity laws at speed n: n² f(q/n).

    J. F. Gülich, Centrifugal Pumps, 3rd edition, 2014, chapters 3 and 11, doi
    10.1007/978-3-642-40114-5. Between two points the head is a_i - b_i q², so that the flow
    through a pipe with the head H_s + r q² has a closed form,

        q² = (n² a_i - H_s) / (b_i + r),

    with the segment i in which it lies; beyond the last point the last segment goes on. A check
    valve holds the flow at zero where the pump does not reach the static head. There the square
    root has an infinite slope; below one per cent of the last flow it is replaced by the smooth
    law of `clepsydra.process.root_law`.

    Where the source stands higher than the end of the pipe (H_s < 0), liquid also runs through a
    pump that stands still.

    Parameters
    ----------
    points : tuple of (float, float)
        Flow [m³/s], rising from at least 0, and head [m], strictly falling.

    Examples
    --------
    5 l/s at 27 m and full speed; at 80 % of it 4 l/s at 17.28 m:

    >>> curve = PumpCurve(((0.0, 30.0), (5e-3, 27.0), (10e-3, 18.0)))
    >>> flows = (curve.flow(ca.SX(1.0), 27.0, 0.0), curve.flow(ca.SX(0.8), 17.28, 0.0))
    >>> [round(float(flow), 9) for flow in flows]
    [0.005, 0.004]
    """

    points: tuple[tuple[float, float], ...]

    @classmethod
    def read(cls, table: TableReader) -> Self:
        """Read the key "curve" of a pump."""
        expected = "a list of flows and heads"
        remedy = 'write as in curve = [["0 l/s", "30 m"], ["5 l/s", "27 m"], ["10 l/s", "18 m"]]'
        points = table.pairs("curve", "m^3/s", "m", expected, remedy)
        if len(points) < 2:
            raise table.wrong("curve", "at least two points", remedy)
        flows, heads = zip(*points, strict=True)
        if flows[0] < 0.0 or any(b <= a for a, b in pairwise(flows)):
            remedy = "put the points in the order of their flow, each flow once"
            raise table.wrong("curve", "flows that rise from zero or more", remedy)
        if any(b >= a for a, b in pairwise(heads)):
            raise table.wrong(
                "curve",
                "a head that falls from point to point, since a pump curve that rises has two "
                "flows at one head",
                "correct the heads, or begin the curve at its highest point",
            )
        return cls(points)

    @property
    def segments(self) -> list[tuple[float, float]]:
        """a_i [m] and b_i [s²/m⁵] between two points each."""
        found = []
        for (q1, h1), (q2, h2) in pairwise(self.points):
            slope = (h1 - h2) / (q2**2 - q1**2)
            found.append((h1 + slope * q1**2, slope))
        return found

    def head(self, flow: float) -> float:
        """Return the head at a flow and full speed [m]."""
        ends = zip(self.points[1:], self.segments, strict=True)
        a, b = next((each for end, each in ends if flow <= end[0]), self.segments[-1])
        return a - b * flow**2

    def flow_at(self, head: float) -> float:
        """Return the largest flow at a head and full speed [m³/s], 0 above the highest one."""
        falling = [
            (end, a, b)
            for (_, end), (a, b) in zip(self.points[1:], self.segments, strict=True)
            if b > 0.0
        ]
        _, a, b = next((each for each in falling if head >= each[0]), falling[-1])
        return float(max((a - head) / b, 0.0) ** 0.5)

    @property
    def highest(self) -> float:
        """The head at no flow [m]."""
        return self.segments[0][0]

    @property
    def is_flat(self) -> bool:
        """Whether it begins with one head up to a flow."""
        return self.segments[0][1] == 0.0

    def throttled(self, conductance: Any, lift: Any, pumps: Any) -> ca.SX:
        """Return the flow of pumps at full speed through a throttle [m³/s].

        Parameters
        ----------
        conductance : casadi.SX
            G of pipe and throttle [m³/s per root of a metre].
        lift : casadi.SX
            H_s, from the liquid at the source up to the end of the pipe [m].
        pumps : casadi.SX
            N, how many run.
        """
        shut_off, slope = (ca.SX(each) for each in self.segments[0])
        squared = conductance * conductance
        per_pump = 1 / (pumps * pumps)
        for (flow, head), (a, b) in zip(self.points[1:], self.segments[1:], strict=False):
            # The throttle takes more where the segments meet: the flow is larger.
            beyond = squared * (head - lift) * per_pump > flow * flow
            shut_off, slope = ca.if_else(beyond, a, shut_off), ca.if_else(beyond, b, slope)
        root = falling_root(shut_off - lift, LAMINAR)
        return conductance * root / ca.sqrt(1 + slope * per_pump * squared)

    def flow(self, speed: ca.SX, static_head: ca.SX | float, loss: ca.SX | float) -> ca.SX:
        """Return the flow [m³/s].

        Parameters
        ----------
        speed : casadi.SX
            n, 1 at full speed.
        static_head : casadi.SX or float
            H_s, from the liquid at the source up to the end of the pipe [m].
        loss : casadi.SX or float
            r, head lost in the pipe per flow squared [s²/m⁵].
        """
        squared = ca.fmax(speed, 0) ** 2
        segments = []
        for shut_off, slope in self.segments:
            share = 1 / (slope + ca.SX(loss))
            segments.append((squared * shut_off - static_head) * share)
        flow_squared = segments[0]
        for (flow, head), segment in zip(self.points[1:], segments[1:], strict=False):
            # The pump has head to spare where the segments meet: the flow is larger.
            spare = squared * (head - ca.SX(loss) * flow**2) - static_head
            flow_squared = ca.if_else(spare > 0, segment, flow_squared)
        return falling_root(flow_squared, (_SMALL_FLOW * self.points[-1][0]) ** 2)
