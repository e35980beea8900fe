"""What is known of a process that is to be drawn: its parts, their places and their values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text
from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.element import Element
from clepsydra.process.process import Process
from clepsydra.report.drawing.bodies import NAME, SMALL
from clepsydra.report.drawing.control_functions import ControlFunction, control_functions
from clepsydra.report.drawing.flow_graph import FlowGraph, flow_graph
from clepsydra.report.drawing.outline import TANK_WIDTH, Outline, outline_of
from clepsydra.report.drawing.routing import Routes, route
from clepsydra.report.drawing.shapes import TINTS, shortened, wrapped
from clepsydra.report.quantities import (
    flow_unit,
    percent_text,
    quantity_text,
    short_text,
)

#: Room for a line beside a pump, a flow or a splitter, at an instrument, and in a tank [px].
_BESIDE, _AT, INSIDE = 170.0, 104.0, TANK_WIDTH - 6.0
#: Less than this share of the greatest flow is none.
_STILL = 1e-9
#: As long as what a page writes: a flow, and what is abnormal about an actuator.
LONG_FLOW, LONG_STATE = "000.00", "at its highest"


@dataclass(frozen=True)
class Scene:
    """A process, and where it is to be drawn.

    Parameters
    ----------
    process : Process
    point : OperatingPoint or None
        None where nothing is known of its values.
    controller : Controller or None
        None where nothing controls it.
    alive : str
        Its name in a page that moves it, empty in others: there every reading has its place, and
        nothing stands still.
    hides : frozenset of str
        Numbers of the process that are not told: "pipe.time", "splitter_1.tank_1".
    """

    process: Process
    point: OperatingPoint | None
    controller: Controller | None
    alive: str = ""
    hides: frozenset[str] = frozenset()

    @cached_property
    def elements(self) -> dict[str, Element]:
        """The elements by name."""
        return {element.name: element for element in self.process.elements}

    @cached_property
    def graph(self) -> FlowGraph:
        """What flows where."""
        return flow_graph(self.process)

    @cached_property
    def functions(self) -> dict[str, ControlFunction]:
        """The functions of the controller by name."""
        found = () if self.controller is None else control_functions(self.controller)
        return {function.name: function for function in found}

    @cached_property
    def routes(self) -> Routes:
        """Where everything stands, and the ways of pipes and signals."""
        return route(self.graph, self.labels, tuple(self.functions.values()))

    @cached_property
    def outlines(self) -> dict[str, Outline]:
        """The profile of every vessel."""
        return {name: outline_of(self.elements[name]) for name in self.graph.vessels}

    @cached_property
    def values(self) -> dict[str, float]:
        """Signals to their values [SI], where they are known."""
        if self.point is None:
            return {}
        fixed = {signal.name: signal.initial for signal in self.process.parameters}
        return fixed | self.point.as_dict()

    @cached_property
    def still(self) -> set[str]:
        """The elements through which nothing flows."""
        if self.alive or self.point is None or not self.process.motion.flow_paths:
            return set()
        motion, point, p = self.process.motion, self.point, self.process.parameter_values
        rates = motion.flows(*motion.at_rest(point.state, point.inputs, point.disturbances, p))
        flows = dict.fromkeys((path.element for path in motion.flow_paths), 0.0)
        for path, rate in zip(motion.flow_paths, np.array(rates).ravel(), strict=True):
            flows[path.element] += abs(float(rate))
        least = _STILL * max(flows.values())
        return {name for name, flow in flows.items() if flow <= least}

    def value(self, name: str) -> str:
        """Return the value of a signal; empty where it is not known."""
        known = name in self.values
        return quantity_text(self.process.signal(name), self.values[name]) if known else ""

    def shown(self, name: str) -> str:
        """Return what an element is called: its tag, if the file gives one."""
        return self.process.tags.get(name, name)

    def warning(self, name: str) -> str:
        """Return what is abnormal about a signal: it has reached an end of its range."""
        moving = [*self.process.inputs, *self.process.measurements]
        signal = next((signal for signal in moving if signal.name == name), None)
        flow = getattr(self.elements.get(name), "flow", "")  # what a meter measures
        if self.alive or signal is None or name not in self.values or self.still & {name, flow}:
            return ""
        if signal.low < self.values[name] < signal.high:
            return ""
        return f"at its {'highest' if self.values[name] >= signal.high else 'lowest'}"

    @cached_property
    def labels(self) -> dict[str, tuple[str, ...]]:
        """The lines written beside each element and each controller."""
        found = {name: self._label(element) for name, element in self.elements.items()}
        for function in self.functions.values():
            if setpoint := self.setpoint(function):
                found[function.name] = (f"SP {setpoint}",)
        return found

    def setpoint(self, function: ControlFunction) -> str:
        """Return the setpoint that an operator gives a controller; empty where none does."""
        given = {} if self.controller is None else self.controller.free_inputs
        if function.setpoint in given:
            return quantity_text(self.process.signal(function.at), given[function.setpoint])
        return self.value(function.at) if function.setpoint else ""

    def _label(self, element: Element) -> tuple[str, ...]:
        name, symbol = element.name, element.symbol
        room, size, bold = _AT, SMALL, False
        shown = self.shown(name)
        if element.measurements():
            # A tag such as LIC101 is told in the balloon.
            seats = self.graph.instruments
            if any(i.name == name and shown.endswith(i.number) for i in seats):
                shown = name
        elif symbol not in ("delay", "orifice"):
            room, size, bold = _BESIDE, NAME, True
        if symbol == "delay":
            return (shortened(shown, room, size), self.delay_time(name))
        late = (words for each in element.reporting().values() for words in each.words.split(", "))
        return (*wrapped(shown, room, size, bold), *late, *self.readings(name))

    def readings(self, name: str) -> list[str]:
        """Return what is known of an element at the operating point, a line each."""
        if self.alive:
            return list(self.moving(name).values())
        value, symbol = self.value(name), self.elements[name].symbol
        if name in self.still and symbol in ("pump", "valve"):
            asked = self.values.get(name, 0.0) > self.process.signal(name).low
            return ["stopped" if symbol == "pump" else "no flow", *[f"set to {value}"] * asked]
        found = [value, self.warning(name)]
        signals = [signal for signal in self.process.inputs if signal.name == name]
        if value and signals and signals[0].shown_unit != "%":
            found.insert(1, percent_text(self.process, name, self.values[name], 2))
        return [words for words in found if words]

    def moving(self, name: str) -> dict[str, str]:
        """Return the lines beside an element that a page moves: what each tells, and its words.

        The state of an actuator is its percent where nothing is abnormal about it. What is not
        known here, a state and a flow, has the longest words that it may have.
        """
        found = {"value": self.value(name)}
        if any(signal.name == name for signal in self.process.inputs):
            found["state"] = LONG_STATE
        elif self.elements[name].symbol in ("orifice", "valve"):
            found["flow"] = f"{LONG_FLOW} {unit_text(flow_unit(self.process))}"
        return {what: words for what, words in found.items() if words}

    def title(self, name: str) -> str:
        """Return what an element is in words, with its values."""
        element = self.elements[name]
        tag = f" ({self.shown(name)})" if self.shown(name) != name else ""
        known = [self.delay_time(name)] if element.symbol == "delay" else self.readings(name)
        known = [] if self.alive else known
        return ", ".join((f"{element.kind} {name}{tag}", *known))

    def states(self, vessel: str) -> list[Signal]:
        """Return the states of a vessel."""
        return [s for s in self.process.state if s.name.startswith(f"{vessel}.")]

    def tint(self, name: str) -> str:
        """Return the colour of what is in a tank or reservoir: of its strongest component."""
        if self.point is None:
            return TINTS[0]
        symbols = {known: ca.SX(value) for known, value in self.values.items()}
        found = self.elements[name].concentrations(symbols)
        components = self.process.components
        shares = [0.0, *(float(found.get(each.name, 0.0)) / each.high for each in components)]
        return TINTS[shares.index(max(shares)) % len(TINTS)]

    def delay_time(self, name: str) -> str:
        """Return how long a delay is."""
        element = self.elements[name]
        time, unit = getattr(element, "time", None), element.display_units.get("time", "s")
        if time is None:
            return ""
        if f"{name}.time" in self.hides:
            return "τ"
        return f"τ = {short_text(from_si(time, 's', unit))} {unit_text(unit)}"
