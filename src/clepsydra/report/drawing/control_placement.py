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
from clepsydra.report.drawing.flow_graph import Instrument
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

    def seat_instruments(self) -> None:
        """Put transmitters of tanks beside them."""
        for number, instrument in enumerate(self.frame.graph.instruments):
            tank = instrument.seat
            if tank not in self.frame.seats:
                continue
            earlier = [i for i in self.frame.graph.instruments[:number] if i.seat == tank]
            side = self.frame.inner(tank) * (1 if len(earlier) % 2 == 0 else -1)
            y = self.frame.top(tank) + (1 if self.frame.low(tank) else 4)
            self._add(instrument, self.frame.beside(tank, side), -side, y, 1)

    def put_meters(self) -> None:
        """Put a flow meter beside what it measures."""
        for instrument in self.frame.graph.instruments:
            if instrument.seat in self.frame.seats:
                continue
            item = self.gaps.item_of(instrument.seat)
            if item is not None:
                body = next(b for b in item.bodies if b.name == instrument.seat)
                y = body.y - 4 if body.across else body.y
                self._add(instrument, item.gap, item.side, y, 2)
                continue
            tank, side = self._above(instrument.seat)
            y = self.frame.top(tank) + TANK_ROWS + 2
            for link in (link for link in self.frame.graph.links if link.name == instrument.seat):
                if not link.sources:
                    # It runs in over the rim.
                    side, y = self.frame.inner(link.targets[0]), self.frame.top(link.targets[0]) - 6
                    tank = link.targets[0]
            self._add(instrument, self.frame.beside(tank, side), -side, y, 2)

    def _above(self, name: str) -> tuple[str, int]:
        """Return the tank from which something hangs, and the side where its words are not."""
        tanks = [tank for tank, links in self.frame.below.items() for k in links if k.name == name]
        tank = tanks[0] if tanks else self.frame.graph.vessels[0]
        return tank, -self.frame.inner(tank)

    def _add(self, instrument: Instrument, gap: Gap, side: int, y: int, distance: int) -> None:
        name = instrument.name
        bodies = [instrument_body(name, y, self.frame.label(name))]
        own = next((f for f in self.functions if self.frame.graph.owner(f.at) == name), None)
        if own is not None:
            bodies.append(self._controller(own, y - _ABOVE))
        self.gaps.add(gap, side, *bodies, distance=distance)

    def _controller(self, function: ControlFunction, y: int) -> Body:
        label = "".join(self.frame.labels.get(function.name, ()))
        return controller_body(function.name, y, label, len(function.reads) + len(function.gives))

    def put_functions(self) -> None:
        """Put what stands above no transmitter: what comes last in a scheme first."""
        for function in reversed(self.functions):
            if function.name in self.gaps.bodies:
                continue
            after = [self.gaps.item_of(to) for of, to in self.signals if of == function.name]
            item = next((item for item in after if item), None)
            if function.sign:
                if item is not None:
                    gap, side, y = item.gap, item.side, item.bodies[0].y - _ABOVE
                else:
                    tank, side = self._above(next(iter(function.gives), ""))
                    gap, side = self.frame.beside(tank, side), -side
                    y = self.frame.top(tank) + TANK_ROWS
                self.gaps.add(gap, side, relay_body(function.name, y), distance=2)
                continue
            gap = self._between(function)
            y = self.frame.pump_rows[gap[0]]
            self.gaps.add(gap, -1, self._controller(function, y), distance=2)

    def _between(self, function: ControlFunction) -> Gap:
        """Return the gap in the middle of the transmitters that a controller reads."""
        gaps = [
            item.gap
            for name in function.reads
            if (item := self.gaps.item_of(self.frame.graph.owner(name)))
        ]
        gaps.sort()
        return gaps[len(gaps) // 2] if gaps else (0, 0)
