"""Concentrations that an element brings from outside: constant, or signals of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.declared import Part
from clepsydra.process.element import Element
from clepsydra.process.outside_signal import DisturbanceRange, read_disturbance_range
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols

#: The concentration of one component in liquid from outside [the component's unit]: constant, or
#: the range of a signal that may be manipulated or disturb.
GivenConcentration = float | DisturbanceRange


def read_concentrations(table: TableReader) -> dict[str, GivenConcentration]:
    """Return what liquid from outside carries; nothing of a component that is not named.

    Written as ``concentration = { salt = "5 kg/m^3" }`` for a constant, or as a table
    ``concentration.salt = { range = ["0 kg/m^3", "25 kg/m^3"], nominal = "5 kg/m^3" }`` for a
    signal "feed.salt".
    """
    if not table.has("concentration"):
        return {}
    remedy = 'write as in concentration = { salt = "5 kg/m^3" }'
    inner = table.table("concentration", "a concentration for each component", remedy)
    given: dict[str, GivenConcentration] = {}
    for name in inner.present:
        component = next((c for c in table.components if c.name == name), None)
        if component is None:
            known = ", ".join(c.name for c in table.components)
            raise inner.refused(
                name,
                name,
                f"a component: {known}" if known else "no component, since the file has none",
                f"correct the name, or add a table [components.{name}]",
            )
        what, unit = "a concentration", component.unit
        if not isinstance(inner.raw(name), dict):
            given[name] = inner.quantity(name, unit, what, "give a concentration", at_least=0.0)
            continue
        signal = inner.table(name, what, remedy, keys=("range", "nominal", "step"))
        given[name] = read_disturbance_range(signal, unit, "concentration")
    return given


def brought() -> Any:
    """Return the field of what brings liquid from outside: component to concentration."""
    each = {"type": ["string", "object"]}
    declared = Part(
        lambda table, key, known: read_concentrations(table),
        {"concentration": told.by_name("concentration of each component that it brings", each)},
    )
    return field(default_factory=dict, metadata={"declared": declared})


class BringsFromOutside(Element):
    """An element whose liquid comes from outside, with its concentrations in a field `given`."""

    given: Mapping[str, GivenConcentration]

    def brings(self) -> tuple[str, ...]:
        """Return the components with a concentration of their own."""
        return tuple(self.given)

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the concentrations that vary, "feed.salt"."""
        by_name = {component.name: component for component in self.components}
        return tuple(
            by_name[name].in_element(self.name, value.low, value.high, value.nominal)
            for name, value in self.given.items()
            if isinstance(value, DisturbanceRange)
        )

    def load_steps(self) -> dict[str, tuple[float, ...]]:
        """Return the sizes of the load steps of its concentrations by signal."""
        ranges = {k: v for k, v in self.given.items() if isinstance(v, DisturbanceRange)}
        return {f"{self.name}.{name}": v.steps for name, v in ranges.items() if v.steps}

    def concentrations(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return what its liquid carries, zero of a component of which nothing is given."""
        found = {component.name: ca.SX(0.0) for component in self.components}
        for name, value in self.given.items():
            if isinstance(value, DisturbanceRange):
                found[name] = symbols[f"{self.name}.{name}"]
            else:
                found[name] = ca.SX(value)
        return found
