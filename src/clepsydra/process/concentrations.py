"""Concentrations that an element brings from outside: constant, or signals of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.component import Component
from clepsydra.process.declared import Part
from clepsydra.process.disturbance_range import read_disturbance_range
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class GivenConcentration:
    """The concentration of one component in liquid from outside.

    Parameters
    ----------
    value : float
        Constant or nominal value [the component's unit].
    low, high : float or None
        Range where it is a signal that may be manipulated or disturb; None where it is constant.
    steps : tuple of float
        Sizes of the load steps of the default scenario, for a signal.

    Examples
    --------
    >>> GivenConcentration(5e3, 0.0, 25e3).varies
    True
    """

    value: float
    low: float | None = None
    high: float | None = None
    steps: tuple[float, ...] = ()

    @property
    def varies(self) -> bool:
        """Whether it is a signal."""
        return self.low is not None


def read_concentrations(table: TableReader) -> dict[str, GivenConcentration]:
    """Return what liquid from outside carries; nothing of a component that is not named.

    Written as ``concentration = { salt = "5 kg/m^3" }`` for a constant, or as a table
    ``concentration.salt = { range = ["0 kg/m^3", "25 kg/m^3"], nominal = "5 kg/m^3" }`` for a
    signal "feed.salt".

    Parameters
    ----------
    table : TableReader
        Of an element that may have the key ``concentration``.

    Raises
    ------
    InputError
        A component is unknown, a value is negative, or it or a step is out of range.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
    >>> read_concentrations(TableReader(parse(b"[flows.feed]", "a.toml"), ("flows", "feed"), None))
    {}
    """
    if not table.has("concentration"):
        return {}
    remedy = 'write as in concentration = { salt = "5 kg/m^3" }'
    inner = table.table("concentration", "a concentration for each component", remedy)
    given = {}
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
            value = inner.quantity(name, unit, what, "give a concentration", at_least=0.0)
            given[name] = GivenConcentration(value)
            continue
        signal = inner.table(name, what, remedy, keys=("range", "nominal", "step"))
        low, high, nominal, steps = read_disturbance_range(signal, unit, "concentration")
        given[name] = GivenConcentration(nominal, low, high, steps)
    return given


def brought() -> Any:
    """Return the field of what brings liquid from outside: component to concentration."""
    each = {"type": ["string", "object"]}
    declared = Part(
        lambda table, key, known: read_concentrations(table),
        {"concentration": told.by_name("concentration of each component that it brings", each)},
    )
    return field(default_factory=dict, metadata={"declared": declared})


def concentration_signals(
    element: str, given: Mapping[str, GivenConcentration], components: tuple[Component, ...]
) -> tuple[Signal, ...]:
    """Return the signals among given concentrations, "feed.salt".

    Examples
    --------
    >>> concentration_signals("feed", {"salt": GivenConcentration(5.0)}, ())
    ()
    """
    by_name = {component.name: component for component in components}
    return tuple(
        Signal(
            f"{element}.{name}",
            by_name[name].unit,
            display_unit=by_name[name].display_unit,
            low=value.low,
            high=value.high,
            initial=value.value,
            description=f"concentration of {name} in {element}",
        )
        for name, value in given.items()
        if value.low is not None and value.high is not None
    )


def concentration_steps(
    element: str, given: Mapping[str, GivenConcentration]
) -> dict[str, tuple[float, ...]]:
    """Return the sizes of the load steps of each given concentration that has one, by signal.

    Examples
    --------
    >>> concentration_steps("feed", {"salt": GivenConcentration(5.0, 0.0, 10.0, (2.0,))})
    {'feed.salt': (2.0,)}
    """
    return {f"{element}.{name}": value.steps for name, value in given.items() if value.steps}


def concentration_values(
    element: str,
    given: Mapping[str, GivenConcentration],
    components: tuple[Component, ...],
    symbols: Symbols,
) -> dict[str, ca.SX]:
    """Return the concentration of every component, zero where nothing is given.

    Examples
    --------
    >>> from clepsydra.process.component import Component
    >>> salt = Component("salt", "kg/m^3", "", 0.0, 10.0)
    >>> concentration_values("feed", {"salt": GivenConcentration(5.0)}, (salt,), {})["salt"]
    SX(5)
    """
    none = GivenConcentration(0.0)
    return {
        component.name: symbols[f"{element}.{component.name}"]
        if given.get(component.name, none).varies
        else ca.SX(given.get(component.name, none).value)
        for component in components
    }
