"""A flow splitter: a valve that divides one flow in fixed proportion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.declared import part
from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols

_REMEDY = "write as in fractions = { tank_1 = 0.7, tank_4 = 0.3 }"


@dataclass(frozen=True)
class FlowSplitter(Element):
    """Divides what it receives: q_i = γ_i q for all but the last, which takes the rest.

    With two destinations it is the three-way valve of K. H. Johansson, The quadruple-tank
    process, IEEE Transactions on Control Systems Technology 8(3), 2000, section II,
    doi 10.1109/87.845876. Only the first fractions are parameters, "splitter_1.tank_1": however
    they are varied, no liquid appears or is lost.

    Parameters
    ----------
    destinations : mapping
        Element to its fraction [1]; they sum to 1.

    Examples
    --------
    >>> splitter = FlowSplitter("splitter_1", {"tank_1": 0.7, "tank_4": 0.3})
    >>> pump = Flow("basin", "splitter_1", 3.33e-6, 3.0)
    >>> parts = splitter.flows({"splitter_1.tank_1": 0.7}, [pump])
    >>> {part.destination: round(float(part.coefficient * part.driver) * 1e6, 3) for part in parts}
    {'tank_1': 6.993, 'tank_4': 2.997}
    """

    kind, table, symbol, place = "flow splitter", "splitters", "splitter", 7
    receives = passes_on = True

    destinations: Mapping[str, float] = part(
        lambda table, key, known: _read_fractions(table),
        {"fractions": told.by_name("the fraction of each destination, 1 in all")},
        required=("fractions",),
    )

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the splitter from its table of a process file."""
        splitter = super().read(name, table)
        units = _fractions(table).display_units(*splitter.destinations)
        return replace(splitter, display_units=units)

    def connections(self) -> tuple[Connection, ...]:
        """Return the elements that it feeds."""
        return tuple(
            Connection(("fractions", destination), destination, "receiver")
            for destination in self.destinations
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return all fractions but the last."""
        first = list(self.destinations.items())[:-1]
        return tuple(
            self._parameter(destination, "1", fraction, f"fraction to {destination} at", high=1.0)
            for destination, fraction in first
        )

    def as_built(self) -> tuple[str, ...]:
        """Return its fractions: how the valve stands."""
        return tuple(parameter.name for parameter in self.parameters())

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return each received flow in parts."""
        *first, last = self.destinations
        fractions = {name: ca.SX(symbols[f"{self.name}.{name}"]) for name in first}
        fractions[last] = 1 - sum(fractions.values(), start=ca.SX(0))
        return tuple(
            Flow(
                self.name,
                destination,
                fraction * flow.coefficient,
                flow.driver,
                fluxes={name: fraction * flux for name, flux in (flow.fluxes or {}).items()},
            )
            for flow in received
            for destination, fraction in fractions.items()
        )


def _fractions(table: TableReader) -> TableReader:
    return table.table("fractions", "a fraction for each destination", _REMEDY)


def _read_fractions(table: TableReader) -> dict[str, float]:
    """Return the fraction of each destination."""
    inner = _fractions(table)
    fractions = {
        destination: inner.quantity(
            destination, "1", "a fraction", "give a part of 1", at_least=0.0, at_most=1.0
        )
        for destination in inner.present
    }
    if len(fractions) < 2:
        raise table.wrong("fractions", "at least two destinations", _REMEDY)
    total = math.fsum(fractions.values())
    if abs(total - 1.0) > 1e-9:
        raise table.refused(
            "fractions", f"a sum of {total:.6g}", "a sum of 1", "correct the fractions"
        )
    return fractions
