"""A tag of a rig: one value on its wires, who writes it, and within which range."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from clepsydra.base.conversion import Conversion, conversion
from clepsydra.base.signal import Signal

#: What cards show beyond the ends of a range, as a share of it: code 32511 where 27648 is the end.
OVER_RANGE = (32511 - 27648) / 27648
#: What the controller last asked an input for, and how it judged itself; what they are called in
#: the process image.
COMMAND, COMMAND_STATUS = "command", "command_status"
#: Counters of 16 bits: each sample of the plant, and each scan of the controller.
PLANT_WATCHDOG, HEARTBEAT = "plant.watchdog", "controller.heartbeat"
#: Whether what is on the wires moves the plant; else its own controller does, by the operator.
REMOTE, ACKNOWLEDGE = "operator.remote", "operator.acknowledge"
#: What an instructor does to the wires: answers later by a time [s], a share of requests that are
#: lost, and whether the cable is pulled.
WIRE_DELAY, WIRE_LOSS = "instructor.wire_delay", "instructor.wire_loss"
WIRE_CUT = "instructor.wire_cut"
#: No answer is sent later than this [s]: a master has given up long before.
LATEST_ANSWER = 60.0
#: What an instructor does to a measurement: how fast it drifts [its unit/s]; and to all: noise.
DRIFT, NOISE = "drift", "instructor.noise"
#: Whether the controller on the wires is heard; by how much the plant missed the beginning of the
#: sample [s]; and how many periods it left out since it was started, as while the machine slept.
HEARD, LATENESS, MISSED = "controller.heard", "plant.lateness", "plant.missed"


class Writer(Enum):
    """Who gives a tag its value."""

    PLANT = "plant"
    CONTROLLER = "controller"
    OPERATOR = "operator"


@dataclass(frozen=True)
class Tag:
    """One value on the wires.

    Parameters
    ----------
    name : str
        Its path, as exported blocks call their ports: "level_1.pv", "pump_1.out".
    label : str
        What the control system calls it: "LIC101_pv", with the tag of the process file.
    signal : Signal
        Unit, range, kind and value at rest, all in the unit that is shown, which is that of the
        ports of exported blocks.
    writer : Writer
    cell : str
        What holds it in the process image, in SI.
    unit : str
        Of the cell [SI].
    judged_by : str
        The boolean tag that says whether it can be believed; empty for none.
    """

    name: str
    label: str
    signal: Signal
    writer: Writer
    cell: str
    unit: str
    judged_by: str = ""

    def on_wire(self, value: float) -> float:
        """Return a value [SI] in the unit of its signal."""
        way = self._ways[0]
        return value if way is None else float(way(value))

    def in_cell(self, value: float) -> float:
        """Return a value in the unit of its signal [SI]."""
        way = self._ways[1]
        return value if way is None else float(way(value))

    @cached_property
    def _ways(self) -> tuple[Conversion | None, Conversion | None]:
        shown = self.signal.unit
        return conversion(self.unit, shown), conversion(shown, self.unit)

    @property
    def lowest(self) -> float:
        """The least value that the wires take: below the range by what cards still show."""
        return self._beyond(self.signal.low, -1.0)

    @property
    def highest(self) -> float:
        """The largest value that the wires take.

        >>> level = Signal("level", "m", low=0.0, high=27648.0)
        >>> Tag("level.pv", "level_pv", level, Writer.PLANT, "level", "m").highest
        32511.0
        """
        return self._beyond(self.signal.high, 1.0)

    def _beyond(self, end: float, sign: float) -> float:
        beyond = self.signal.kind == "real" and self.signal.has_range
        return end + sign * OVER_RANGE * self.signal.span if beyond else end
