"""An element: one part of a plant, with its equation.

Each kind of element is one file with one subclass of `Element`; `clepsydra.process.kinds` finds it
in the folder `elements`. The subclass says which keys a process file gives it, which signals
it brings, whom it is connected to, and what it contributes to the equations.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.quantity import declared, quantities
from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.process.component import Component
from clepsydra.process.declared import DeclaredKeys, Part, read_fields
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.hybrid import Delay, Event, Switch
from clepsydra.process.reporting import Reporting
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class Connection:
    """That one element names another.

    Parameters
    ----------
    key : tuple of str
        Where the process file says so, below the element: ("destination",).
    name : str
        The other element.
    wanted : str
        The kind that the other element must have; "receiver" for any that a flow can end in,
        "source" for any that it can be drawn from.
    carries_flow : bool
        Liquid runs along this connection.
    """

    key: tuple[str, ...]
    name: str
    wanted: str
    carries_flow: bool = True


@dataclass(frozen=True)
class Element(ABC):
    """What all elements have in common; a subclass overrides what it contributes.

    Its equations take `symbols`: every state, input, disturbance, memory, parameter and delayed
    quantity of the plant by name, and in `rates`, `events` and `updates` also the flow that each
    element causes, "pump_1.flow" [m³/s].

    Parameters
    ----------
    name : str
        Unique in the process, an identifier.
    components : tuple of Component
        What is dissolved in the liquid of the plant.
    display_units : mapping
        Key of the process file to the unit that the user wrote there.

    Examples
    --------
    A subclass overrides what it has; a reservoir has no equation at all:

    >>> from clepsydra.process.elements.reservoir import Reservoir
    >>> basin = Reservoir("basin")
    >>> basin.kind, basin.receives, basin.states(), basin.connections()
    ('reservoir', True, (), ())
    """

    #: What the reader calls it: "tank".
    kind: ClassVar[str]
    #: Its place in the list of a process's elements; own ones come last.
    place: ClassVar[int] = 100
    #: The table of a process file that lists elements of this kind: "tanks".
    table: ClassVar[str]
    #: The keys that a process file may give: those that its fields declare, if nothing is said.
    keys: ClassVar[tuple[str, ...]] = DeclaredKeys()  # type: ignore[assignment]
    #: What to write in the place of a key that others use for one of these.
    other_keys: ClassVar[Mapping[str, str]] = {}
    #: How the process drawing shows it: "tank", "reservoir", "orifice", "pump", "valve", "flow",
    #: "splitter", "delay" or "sensor"; anything else is a plain box with its name.
    symbol: ClassVar[str] = "box"
    #: A process file may give its tag.
    tagged: ClassVar[bool] = False
    #: A flow can end here.
    receives: ClassVar[bool] = False
    #: A flow can be drawn from here.
    gives: ClassVar[bool] = False
    #: It holds any amount and is no part of a balance.
    endless: ClassVar[bool] = False
    #: What it receives leaves again at once, so its flows follow from those of others.
    passes_on: ClassVar[bool] = False

    name: str
    components: tuple[Component, ...] = field(default=(), compare=False, kw_only=True)
    display_units: Mapping[str, str] = field(default_factory=dict, compare=False, kw_only=True)

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the element from its table of a process file: its fields say what they hold."""
        return cls(
            name,
            **read_fields(cls, table),
            components=table.components,
            display_units=table.display_units(*cls.keys),
        )

    def connections(self) -> tuple[Connection, ...]:
        """Return the elements that this one names; what is submerged joins two tanks."""
        found = []
        for key, each in declared(type(self)).items():
            if isinstance(each, Part) and each.wanted:
                name = getattr(self, key)
                wanted = "tank" if getattr(self, "submerged", False) else each.wanted
                if name or each.required:  # else it may be outside the plant
                    found.append(Connection((key,), name, wanted, each.carries_flow))
        return tuple(found)

    def states(self) -> tuple[Signal, ...]:
        """Return the states that it brings, as an engineer speaks of them."""
        return ()

    def contents(self) -> tuple[Signal, ...]:
        """Return what is integrated, one for each state; a level may stand for a volume."""
        return self.states()

    def to_contents(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return each integrated content from the states."""
        return {signal.name: symbols[signal.name] for signal in self.states()}

    def to_states(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return each state from the integrated contents."""
        return {signal.name: symbols[signal.name] for signal in self.states()}

    @property
    def spilt(self) -> str:
        """The total of what it spills; empty where it spills nothing."""
        return ""

    def totals(self) -> tuple[Signal, ...]:
        """Return integrals that nothing depends on, such as a volume spilt."""
        return ()

    def memories(self) -> tuple[Signal, ...]:
        """Return what stays as it is until an event or a step changes it."""
        return tuple(switch.memory(self.name) for switch in self._switches())

    def inputs(self) -> tuple[Signal, ...]:
        """Return the manipulated variables that it brings."""
        return ()

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the disturbances that it brings."""
        return ()

    def signals(self) -> tuple[Signal, ...]:
        """Return all that it brings: states, what is integrated for them, and the others."""
        states = self.states()
        return (
            *states,
            *self.inputs(),
            *self.disturbances(),
            *self.memories(),
            *self.totals(),
            *self.measurements(),
            *self.parameters(),
            *(signal for signal in self.contents() if signal not in states),
        )

    def load_steps(self) -> dict[str, tuple[float, ...]]:
        """Return the sizes of typical load steps, one after the other, of its disturbances."""
        return {}

    def largest_rates(self) -> dict[str, float]:
        """Return how fast what acts follows those of its inputs that it limits [input unit/s]."""
        return {}

    def measurements(self) -> tuple[Signal, ...]:
        """Return the measurements that it brings."""
        return ()

    def measured_states(self) -> dict[str, str]:
        """Return the state that each of its measurements shows."""
        return {}

    def parameters(self) -> tuple[Signal, ...]:
        """Return the parameters that it brings, with their values."""
        found = (
            each.parameter(self, self.display_units.get(each.name, ""))
            for each in quantities(type(self))
        )
        return tuple(signal for signal in found if signal is not None)

    def as_built(self) -> tuple[str, ...]:
        """Return those of its parameters that differ from one plant of a kind to the next."""
        return ()

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return the flows that it causes; `received` is complete where it passes on."""
        return ()

    def rates(self, symbols: Symbols, received: Flows, given: Flows) -> dict[str, ca.SX]:
        """Return what it adds to the time derivatives of contents and totals, by name.

        They may be those of others: what a tank's level or a component's amount gains or loses
        without a flow. What so crosses the boundary of the plant is added to the totals
        "balance.entered.liquid" and "balance.left.liquid", or of the component, as well.
        """
        return {}

    def stored(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the liquid that it holds [m³] and the amount of each component."""
        return {}

    @property
    def holds_liquid(self) -> bool:
        """Whether it says what it stores: at the low ends of its states it is then empty."""
        return type(self).stored is not Element.stored

    def brings(self) -> tuple[str, ...]:
        """Return the components that it brings from outside."""
        return ()

    def concentrations(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the concentration of each component in what is drawn from it."""
        return {}

    def events(self, symbols: Symbols) -> tuple[Event, ...]:
        """Return the switches that are located inside an integration step."""
        return tuple(
            event for switch in self._switches() for event in switch.events(self.name, symbols)
        )

    def _switches(self) -> tuple[Switch, ...]:
        """Return what of it has two positions, such as a level switch of a pump."""
        return ()

    @property
    def may_refuse(self) -> bool:
        """Whether there are times at which nothing can flow into it, see `refuses`."""
        return False

    def refuses(self, symbols: Symbols) -> ca.SX | None:
        """Return the truth that nothing can flow into it; None where it never refuses."""
        return None

    def ended(self, symbols: Symbols) -> ca.SX | None:
        """Return the truth that one of its events has ended the run; None where none does."""
        return None

    def delays(self) -> tuple[Delay, ...]:
        """Return the quantities that it keeps for a while."""
        return ()

    def sent(self, symbols: Symbols, received: Flows) -> dict[str, ca.SX]:
        """Return what enters each of its delays."""
        return {}

    def updates(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return those memories that take a new value at the end of every integration step."""
        return {}

    def readings(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the value of each of its measurements."""
        return {}

    @property
    def driven(self) -> bool:
        """Whether a pump that is no element of its own stands before it."""
        return False

    def remarks(self, symbols: Mapping[str, float]) -> tuple[Remark, ...]:
        """Return what is unusual about it at rest with these values of every signal [SI]."""
        return ()

    def reporting(self) -> dict[str, Reporting]:
        """Return how late and how seldom those measurements are told that are not at once."""
        return {}

    def noises(self) -> dict[str, float]:
        """Return the standard deviation of those of its noises where it is known, by signal."""
        return {}

    def displayed(self, readings: Symbols) -> dict[str, ca.SX]:
        """Return what each of its measurements shows of its reading with noise."""
        return {signal.name: readings[signal.name] for signal in self.measurements()}

    def _signal(
        self, name: str, unit: str, ends: tuple[float, float, float | None], description: str
    ) -> Signal:
        """Return a signal by low, high and initial value, shown in the unit of the key "range".

        Without an initial value it begins in the middle of its range.
        """
        low, high, initial = ends
        initial = (low + high) / 2 if initial is None else initial
        shown = self.display_units.get("range", "")
        return Signal(name, unit, shown, low, high, initial, description=description)

    def _parameter(
        self, key: str, unit: str, value: float, description: str, high: float = float("inf")
    ) -> Signal:
        """Return the parameter "name.key" in the unit that the user wrote it in."""
        shown, words = self.display_units.get(key, ""), f"{description} {self.name}"
        return Signal(f"{self.name}.{key}", unit, shown, 0.0, high, value, description=words)
