"""Where instruments, controllers and relays stand, and which of them signals join."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.report.drawing.bodies import (
    TANK_ROWS,
    Body,
    controller_body,
    instrument_body,
    relay_body,
)
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.frame import Frame, Gap, Gaps

#: From a transmitter up to its controller, in lines of the grid.
_ABOVE = 4


class ControlPlacement:
    """The instruments of a plant and the functions of its controller.

    A controller of one measurement stands above its transmitter, one of several between those
    that it reads, and a relay by the actuator that it moves.

    Attributes
    ----------
    signals : list of (from, to)
        Of instruments, functions and actuators.
    """

    def __init__(self, frame: Frame, gaps: Gaps, functions: Sequence[ControlFunction]) -> None:
        self.frame, self.gaps, self.functions = frame, gaps, functions
        graph = frame.graph
        self.signals = [
            pair
            for function in functions
            for pair in (
                *((graph.owner(name), function.name) for name in function.reads),
                *((function.name, graph.owner(name)) for name in function.gives),
            )
        ]

    def put_instruments(self) -> None:
        """Put transmitters beside their tanks, and flow meters beside what they measure."""
        frame, instruments = self.frame, self.frame.graph.instruments
        seats = [instrument.seat for instrument in instruments]
        for number, instrument in enumerate(instruments):
            seat, distance = instrument.seat, 2
            item = self.gaps.item_of(seat)
            if seat in frame.seats:
                out = frame.inner(seat) * (-1) ** seats[:number].count(seat)
                gap, side, distance = frame.beside(seat, out), -out, 1
                y = frame.top(seat) + (1 if frame.low(seat) else 4)
            elif item is not None:
                body = self.gaps.bodies[seat]
                gap, side, y = item.gap, item.side, body.y - 4 * body.across
            else:
                gap, side, y = self._at_tank(seat)
            name = instrument.name
            bodies = [instrument_body(name, y, frame.label(name))]
            own = next((f for f in self.functions if frame.graph.owner(f.at) == name), None)
            if own is not None:
                bodies.append(self._controller(own, y - _ABOVE))
            self.gaps.add(gap, side, *bodies, distance=distance)

    def _at_tank(self, name: str) -> tuple[Gap, int, int]:
        """Return gap, side and row for what belongs to a link below a tank, or over its rim."""
        frame = self.frame
        link = next((link for link in frame.graph.links if link.name == name), None)
        tank = frame.graph.vessels[0] if link is None else (*link.sources, *link.targets)[0]
        out, y = -frame.inner(tank), frame.top(tank) + TANK_ROWS + 2
        if link is not None and not link.sources:
            out, y = -out, frame.top(tank) - 6
        return frame.beside(tank, out), -out, y

    def _controller(self, function: ControlFunction, y: int) -> Body:
        label = "".join(self.frame.labels.get(function.name, ()))
        return controller_body(function.name, y, label, len(function.reads) + len(function.gives))

    def put_functions(self) -> None:
        """Put what stands above no transmitter: what comes last in a scheme first."""
        for function in reversed(self.functions):
            if function.name in self.gaps.bodies:
                continue
            if not function.sign:
                gap = self._between(function)
                body = self._controller(function, self.frame.pump_rows[gap[0]])
                self.gaps.add(gap, -1, body, distance=2)
                continue
            after = [self.gaps.item_of(to) for of, to in self.signals if of == function.name]
            item = next((item for item in after if item), None)
            if item is not None:
                gap, side, y = item.gap, item.side, item.bodies[0].y - _ABOVE
            else:
                gap, side, y = self._at_tank(next(iter(function.gives), ""))
            self.gaps.add(gap, side, relay_body(function.name, y), distance=2)

    def _between(self, function: ControlFunction) -> Gap:
        """Return the gap in the middle of the transmitters that a controller reads."""
        items = (self.gaps.item_of(self.frame.graph.owner(name)) for name in function.reads)
        gaps = sorted(item.gap for item in items if item is not None)
        return gaps[len(gaps) // 2] if gaps else (0, 0)
