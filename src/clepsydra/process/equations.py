"""The equations of a process: its elements joined to one set."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, TypeVar

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.process.balance import DELAYED, balance_totals, conserved, crossing
from clepsydra.process.component import Component
from clepsydra.process.element import Element
from clepsydra.process.flow import Flow
from clepsydra.process.hybrid import Delay, Event
from clepsydra.process.motion import FlowPath, Motion, MotionEvent
from clepsydra.process.reporting import Reporting
from clepsydra.process.wiring import flow_order

_Said = TypeVar("_Said")


@dataclass(frozen=True, kw_only=True)
class Equations:
    """Signals and functions of a plant.

    Parameters
    ----------
    state : tuple of Signal
        Levels "tank_1.level" [m], ranges from the floor to the rim.
    inputs : tuple of Signal
        Manipulated variables "pump_1" with their range; `initial` is the nominal value.
    disturbances : tuple of Signal
        Inputs that nobody manipulates, "inflow_1" [m³/s].
    measurements : tuple of Signal
        Sensors "level_1" with their range, in the order of the file.
    parameters : tuple of Signal
        Element parameters "tank_1.area" with their value in `initial`.
    measured_state : mapping
        Measurement name to the state that it shows, "level_1" → "tank_1.level".
    dynamics : casadi.Function
        SX function (x [n], u [m], d [k], p [l]) → dx/dt [n], SI, for slow changes: transport
        delays pass at once, and switches stand as they do at first.
    measure : casadi.Function
        SX function (x [n], p [l]) → y [q], in the unit of each measurement.
    display : casadi.Function
        SX function y [q] → y [q]: what a controller gets of the readings with their noise.
    noise : mapping
        Measurement or disturbance to the standard deviation of its noise [its unit], where the
        file gives it.
    motion : Motion
        The same equations for an integrator, with delays, memories and switches.
    reporting : mapping
        Measurement that controllers do not see at once to how late and how seldom they do.
    """

    state: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    measurements: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    measured_state: dict[str, str]
    dynamics: ca.Function
    measure: ca.Function
    display: ca.Function
    noise: dict[str, float]
    motion: Motion
    reporting: dict[str, Reporting] = field(default_factory=dict)


def join(
    elements: Sequence[Element],
    gravity: Signal,
    *,
    components: Sequence[Component] = (),
    manipulated: Sequence[str] | None = None,
) -> Equations:
    """Join elements to one set of equations in which every parameter is symbolic.

    Parameters
    ----------
    elements : sequence of Element
        Properly connected, see `clepsydra.process.wiring.check_wiring`.
    gravity : Signal
        Acceleration of gravity [m/s²], the last parameter.
    components : sequence of Component
        What is dissolved in the liquid.
    manipulated : sequence of str, optional
        The inputs, in this order; all other signals from outside are disturbances. Pumps and
        valves where left out.

    Examples
    --------
    A tank of 100 cm² that empties through 1 cm² falls from 20 cm at once by 1.98 cm/s.

    >>> from clepsydra.process.elements.orifice import Orifice
    >>> from clepsydra.process.elements.reservoir import Reservoir
    >>> from clepsydra.process.elements.tank import Tank
    >>> from clepsydra.process.vessels.prism import Prism
    >>> joined = join(
    ...     [Reservoir("basin"), Tank("tank", vessel=Prism(0.3, area=0.01)),
    ...      Orifice("outlet", "tank", "basin", 1e-4)],
    ...     Signal("gravity", "m/s^2", initial=9.81),
    ... )
    >>> values = [signal.initial for signal in joined.parameters]
    >>> round(float(joined.dynamics([0.2], [], [], values)), 6)
    -0.019809
    """
    return _Join(elements, gravity, components, manipulated).result()


class _Join:
    def __init__(
        self,
        elements: Sequence[Element],
        gravity: Signal,
        components: Sequence[Component],
        manipulated: Sequence[str] | None,
    ) -> None:
        self.elements = tuple(elements)
        self.order = flow_order(elements)
        self.components = tuple(components)
        self.by_name = {element.name: element for element in elements}
        self.state = _listed(e.states() for e in elements)
        self.contents = _listed(e.contents() for e in elements)
        self.memories = _listed(e.memories() for e in elements)
        self.measurements = _listed(e.measurements() for e in elements)
        self.delays: tuple[Delay, ...] = tuple(d for e in elements for d in e.delays())
        self.parameters = (*_listed(e.parameters() for e in elements), gravity)
        self.inputs = _listed(e.inputs() for e in elements)
        self.disturbances = _listed(e.disturbances() for e in elements)
        if manipulated is not None:
            outside = {signal.name: signal for signal in (*self.inputs, *self.disturbances)}
            self.inputs = tuple(outside.pop(name) for name in manipulated)
            self.disturbances = tuple(outside.values())
        self.conserved = conserved(components)
        self.balances = balance_totals(self.conserved, delayed=bool(self.delays))
        self.totals = (*_listed(e.totals() for e in elements), *self.balances)
        self.known_rates = {signal.name: None for signal in (*self.contents, *self.totals)}

    def result(self) -> Equations:
        x, c, u, d, p, z, m = (
            ca.SX.sym(name, len(group))
            for name, group in (
                ("x", self.state),
                ("c", self.contents),
                ("u", self.inputs),
                ("d", self.disturbances),
                ("p", self.parameters),
                ("z", self.delays),
                ("m", self.memories),
            )
        )
        held = {
            **_named(self.inputs, u),
            **_named(self.disturbances, d),
            **_named(self.parameters, p),
        }
        states = _named(self.state, x)
        in_states = held | states
        to_contents = _stacked(
            self.contents, _merged(e.to_contents(in_states) for e in self.elements)
        )
        in_contents = held | _named(self.contents, c)
        shown = _merged(e.to_states(in_contents) for e in self.elements)
        to_state = _stacked(self.state, shown)
        rates, sent, totals, symbols, flows = self._evaluate(
            in_contents | shown | _named(self.memories, m), _named(self.delays, z)
        )
        at_first = {s.name: ca.SX(s.initial) for s in self.memories}
        dynamics, *_ = self._evaluate(held | states | at_first, None)
        events = [event for e in self.elements for event in e.events(symbols)]
        updates = _named(self.memories, m)
        updates |= _merged(e.updates(symbols) for e in self.elements)
        arguments, names = [c, z, m, u, d, p], ["c", "z", "m", "u", "d", "p"]
        fired = ca.SX.sym("fired", len(events))
        stored = self._stored(in_contents | shown)
        motion = Motion(
            contents=self.contents,
            totals=self.totals,
            memories=self.memories,
            delays=self.delays,
            events=tuple(MotionEvent(e.name, e.words, e.harm, e.ends) for e in events),
            to_contents=ca.Function("to_contents", [x, p], [to_contents], ["x", "p"], ["c"]),
            to_state=ca.Function("to_state", [c, p], [to_state], ["c", "p"], ["x"]),
            rates=ca.Function("rates", arguments, [rates, sent, totals],
                              names, ["dc", "w", "dt"]),
            guards=ca.Function(
                "guards", arguments, [ca.vertcat(*(ca.SX(e.guard) for e in events))], names, ["g"]
            ),
            resets=ca.Function("resets", [fired, *arguments], [self._reset(events, fired, m)]),
            updates=ca.Function("updates", arguments, [_stacked(self.memories, updates)]),
            stored=ca.Function("stored", [c, p], [stored], ["c", "p"], ["stored"]),
            stored_names=tuple(name for name, _ in self.conserved),
            flows=ca.Function(
                "flows", arguments, [ca.vertcat(*(f.rate for f in flows))], names, ["q"]
            ),
            flow_paths=tuple(
                FlowPath(flow.element, flow.source, flow.destination) for flow in flows
            ),
        )  # fmt: skip
        # dc/dt = ∂c/∂x dx/dt; a content depends on its own state and on states before it, as V C on
        # h and C.
        if [s.name for s in self.state] != [s.name for s in self.contents]:
            dynamics = ca.solve(ca.jacobian(to_contents, x), dynamics)
        readings = _merged(e.readings(in_states) for e in self.elements)
        reading = _stacked(self.measurements, readings)
        dx, y = ca.cse(dynamics), ca.SX.sym("y", len(self.measurements))
        read = _named(self.measurements, y)
        displayed = _merged(e.displayed(read) for e in self.elements)
        display = _stacked(self.measurements, displayed)
        return Equations(
            state=self.state,
            inputs=self.inputs,
            disturbances=self.disturbances,
            measurements=self.measurements,
            parameters=self.parameters,
            measured_state=_merged(e.measured_states() for e in self.elements),
            dynamics=ca.Function("dynamics", [x, u, d, p], [dx], ["x", "u", "d", "p"], ["dx"]),
            measure=ca.Function("measure", [x, p], [reading], ["x", "p"], ["y"]),
            display=ca.Function("display", [y], [display], ["y"], ["shown"]),
            noise=_merged(e.noises() for e in self.elements),
            motion=motion,
            reporting=_merged(e.reporting() for e in self.elements),
        )

    def _evaluate(
        self, given: Mapping[str, ca.SX], delayed: Mapping[str, ca.SX] | None
    ) -> tuple[ca.SX, ca.SX, ca.SX, dict[str, ca.SX], list[Flow]]:
        """Return rates of contents, what enters the delays, rates of totals, symbols and flows.

        What enters a delay leaves it at once where none are given.
        """
        symbols = {**given, **(delayed or {})}
        flows, sent = self._flows(symbols, pass_at_once=delayed is None)
        received: dict[str, list[Flow]] = {element.name: [] for element in self.elements}
        drawn: dict[str, list[Flow]] = {element.name: [] for element in self.elements}
        for flow in flows:
            if flow.destination:
                received[flow.destination].append(flow)
            if flow.source:
                drawn[flow.source].append(flow)
            name = f"{flow.element}.flow"
            symbols[name] = symbols[name] + flow.rate if name in symbols else flow.rate
        rates = crossing(flows, self.balances, self._outside)
        for element in self.elements:
            added = element.rates(symbols, received[element.name], drawn[element.name])
            for name, rate in added.items():
                self._check_rate(element, name)
                rates[name] = rates[name] + rate if name in rates else rate
        for delay in self.delays:
            if delay.conserves:
                name = f"{DELAYED}.{delay.conserves}"
                rates[name] += sent[delay.name] - symbols[delay.name]
        for element in self.elements:
            ended = element.ended(symbols)
            if ended is not None:
                rates = {name: ca.if_else(ended, 0, rate) for name, rate in rates.items()}
        return (
            ca.cse(_stacked(self.contents, rates)),
            _stacked(self.delays, sent),
            _stacked(self.totals, rates),
            symbols,
            flows,
        )

    def _check_rate(self, element: Element, name: str) -> None:
        if name not in self.known_rates:
            known = list(self.known_rates)
            where = f"{element.table}.{element.name}"
            expected = "rates of contents and totals of the plant"
            remedy = suggestion(name, known, f"choose from {', '.join(known)}")
            raise InputError(where, f"a rate of {name}"[:60], expected, remedy)

    def _flows(
        self, symbols: dict[str, ca.SX], *, pass_at_once: bool
    ) -> tuple[list[Flow], dict[str, ca.SX]]:
        """Return every flow with what it carries, and what enters the delays."""
        x = ca.vertcat(*ca.symvar(_stacked(self.state, symbols)))
        arriving: dict[str, list[Flow]] = {}
        refusing = self._refusing(symbols)
        flows: list[Flow] = []
        sent: dict[str, ca.SX] = {}
        for element in self.order:
            received = arriving.get(element.name, [])
            entering = element.sent(symbols, received)
            sent |= entering
            if pass_at_once:
                symbols |= entering
            for caused in element.flows(symbols, received):
                flow = replace(caused, element=caused.element or element.name)
                if flow.destination in refusing:
                    flow = flow.held_back(refusing[flow.destination])
                if flow.reversible and flow.source in refusing:
                    flow = flow.held_back(refusing[flow.source], back=True)
                if flow.fluxes is None:
                    flow = flow.carrying(
                        self._held_by(flow.source, symbols),
                        self._held_by(flow.destination, symbols) if flow.reversible else {},
                    )
                flows.append(flow)
                arriving.setdefault(flow.destination, []).append(flow)
        # Flows that are constant during a sample come first in every sum, so that their part of
        # the sum is computed once a sample and not in every stage of an integration step.
        flows.sort(key=lambda flow: bool(ca.depends_on(ca.SX(flow.driver), x)))
        return flows, sent

    def _refusing(self, symbols: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
        """Return the truth that nothing can flow into an element, for those that may refuse.

        What passes on refuses where any of those that it feeds does.
        """
        refusing = {
            element.name: truth
            for element in self.elements
            if (truth := element.refuses(symbols)) is not None
        }
        for element in reversed(self.order):
            if element.passes_on:
                for fed in (c.name for c in element.connections() if c.name in refusing):
                    before = refusing.get(element.name, ca.SX(0))
                    refusing[element.name] = ca.logic_or(before, refusing[fed])
        return refusing

    def _held_by(self, name: str, symbols: Mapping[str, ca.SX]) -> Mapping[str, ca.SX]:
        if not self.components:
            return {}
        return self.by_name[name].concentrations(symbols)

    def _outside(self, name: str) -> bool:
        """Whether liquid there is not counted: beyond the plant, or in a reservoir."""
        return not name or self.by_name[name].endless

    def _reset(self, events: Sequence[Event], fired: ca.SX, m: ca.SX) -> ca.SX:
        values = _named(self.memories, m)
        for number, event in enumerate(events):
            for name, value in event.resets.items():
                values[name] = ca.if_else(fired[number], value, values[name])
        return _stacked(self.memories, values)

    def _stored(self, symbols: Mapping[str, ca.SX]) -> ca.SX:
        names = [name for name, _ in self.conserved]
        held = [element.stored(symbols) for element in self.elements]
        return ca.vertcat(*(sum((h[n] for h in held if n in h), start=ca.SX(0)) for n in names))


def _listed(said: Iterable[Iterable[Signal]]) -> tuple[Signal, ...]:
    return tuple(chain.from_iterable(said))


def _merged(said: Iterable[Mapping[str, _Said]]) -> dict[str, _Said]:
    """Return what every element says by name, in one dictionary."""
    return {name: value for each in said for name, value in each.items()}


def _named(signals: Iterable[Signal | Delay], vector: ca.SX) -> dict[str, ca.SX]:
    return {signal.name: vector[index] for index, signal in enumerate(signals)}


def _stacked(signals: Iterable[Signal | Delay], values: Mapping[str, Any]) -> ca.SX:
    return ca.vertcat(*(values[signal.name] for signal in signals))
