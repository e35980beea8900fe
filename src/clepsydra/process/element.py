"""An element: one part of a plant, with its equation.

Each kind of element is one file with one subclass of `Element`, and is listed in
`clepsydra.process.kinds`. The subclass says which keys a process file gives it, which signals
it brings, whom it is connected to, and what it contributes to the equations.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
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
        The kind that the other element must have; "receiver" for any that a flow can end in.
    carries_flow : bool
        Liquid runs along this connection.

    Examples
    --------
    >>> Connection(("destination",), "tank_1", "receiver").carries_flow
    True
    """

    key: tuple[str, ...]
    name: str
    wanted: str
    carries_flow: bool = True


@dataclass(frozen=True)
class Flow:
    """A volumetric flow, coefficient · driver [m³/s].

    The two factors are kept apart so that everything that depends on parameters only is
    computed once a run and not once a step.

    Parameters
    ----------
    source, destination : str
        Elements; the source is empty where the liquid comes from outside the plant.
    coefficient : casadi.SX
        Depends on parameters only.
    driver : casadi.SX
        Depends on states, inputs or disturbances.

    Examples
    --------
    The flow of a pump, gain · voltage:

    >>> gain, voltage = ca.SX.sym("gain"), ca.SX.sym("voltage")
    >>> flow = Flow("basin", "tank_1", gain, voltage)
    >>> str(flow.coefficient * flow.driver)
    '(gain*voltage)'
    """

    source: str
    destination: str
    coefficient: ca.SX
    driver: ca.SX


@dataclass(frozen=True)
class Element(ABC):
    """What all elements have in common; a subclass overrides what it contributes.

    Its equations take `symbols`: every state, input, disturbance and parameter of the plant.

    Parameters
    ----------
    name : str
        Unique in the process, an identifier.
    display_units : mapping
        Key of the process file to the unit that the user wrote there.

    Examples
    --------
    A subclass overrides what it has; a reservoir has no equation at all:

    >>> from clepsydra.process.reservoir import Reservoir
    >>> basin = Reservoir("basin")
    >>> basin.kind, basin.receives, basin.states(), basin.connections()
    ('reservoir', True, (), ())
    """

    #: What the reader calls it: "tank".
    kind: ClassVar[str]
    #: The table of a process file that lists elements of this kind: "tanks".
    table: ClassVar[str]
    #: The keys that a process file may give.
    keys: ClassVar[tuple[str, ...]]
    #: A flow can end here.
    receives: ClassVar[bool] = False
    #: What it receives leaves again at once, so its flows follow from those of others.
    passes_on: ClassVar[bool] = False

    name: str
    display_units: Mapping[str, str] = field(default_factory=dict, compare=False, kw_only=True)

    @classmethod
    @abstractmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the element from its table of a process file."""

    def connections(self) -> tuple[Connection, ...]:
        """Return the elements that this one names."""
        return ()

    def states(self) -> tuple[Signal, ...]:
        """Return the states that it brings."""
        return ()

    def inputs(self) -> tuple[Signal, ...]:
        """Return the manipulated variables that it brings."""
        return ()

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the disturbances that it brings."""
        return ()

    def measurements(self) -> tuple[Signal, ...]:
        """Return the measurements that it brings."""
        return ()

    def measured_states(self) -> dict[str, str]:
        """Return the state that each of its measurements shows."""
        return {}

    def parameters(self) -> tuple[Signal, ...]:
        """Return the parameters that it brings, with their values."""
        return ()

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
        """Return the flows that it causes; `received` is complete where it passes on."""
        return ()

    def derivatives(
        self, symbols: Symbols, received: Sequence[Flow], given: Sequence[Flow]
    ) -> dict[str, ca.SX]:
        """Return the time derivative of each of its states, from the flows in and out."""
        return {}

    def readings(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the value of each of its measurements."""
        return {}

    def _parameter(
        self, key: str, unit: str, value: float, description: str, high: float = float("inf")
    ) -> Signal:
        """Return the parameter "name.key" in the unit that the user wrote it in."""
        return Signal(
            f"{self.name}.{key}",
            unit,
            display_unit=self.display_units.get(key, ""),
            low=0.0,
            high=high,
            initial=value,
            description=f"{description} {self.name}",
        )
