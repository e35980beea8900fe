"""Units of a model description: dimension in SI base units, and the units that a reader sees."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si

#: Dimensions as Pint calls them, to the base units of the standard.
_BASE = {
    "[mass]": "kg", "[length]": "m", "[time]": "s", "[current]": "A", "[temperature]": "K",
    "[substance]": "mol", "[luminosity]": "cd",
}  # fmt: skip
#: Kinds of quantity by unit, in the names that Modelica gives them.
QUANTITIES = {
    "m": "Length", "m^2": "Area", "m^3": "Volume", "m^3/s": "VolumeFlowRate", "s": "Time",
    "V": "ElectricPotential", "A": "ElectricCurrent", "m/s": "Velocity", "Hz": "Frequency",
    "m/s^2": "Acceleration", "kg/m^3": "Density", "mol/m^3": "Concentration",
    "kg/s": "MassFlowRate",
}  # fmt: skip


@dataclass(frozen=True)
class UnitDefinition:
    """A unit of the model description.

    Parameters
    ----------
    name : str
    exponents : dict or None
        Base unit to its exponent, without zeros; None where it has no dimension in whole powers.
    factor : float
        value in base units = factor × value in this unit.
    shown : tuple of (str, float)
        Units to display, each with display value = factor × value.

    Examples
    --------
    >>> unit_definitions([Signal("inflow_1", "m^3/s", display_unit="l/s")])[0].shown
    (('l/s', 1000.0),)
    """

    name: str
    exponents: dict[str, int] | None
    factor: float
    shown: tuple[tuple[str, float], ...]


def unit_definitions(signals: Iterable[Signal]) -> list[UnitDefinition]:
    """Return the definitions of all units of some signals, sorted by name.

    Examples
    --------
    >>> (volt,) = unit_definitions([Signal("pump_1", "V")])
    >>> volt.exponents
    {'kg': 1, 'm': 2, 's': -3, 'A': -1}
    """
    shown: dict[str, set[str]] = {}
    for signal in signals:
        if signal.kind == "real":
            others = shown.setdefault(signal.unit, set())
            if signal.shown_unit != signal.unit:
                others.add(signal.shown_unit)
    return [
        UnitDefinition(
            unit,
            *_dimension(unit),
            tuple((other, from_si(1.0, unit, other)) for other in sorted(others)),
        )
        for unit, others in sorted(shown.items())
    ]


@cache
def _dimension(unit: str) -> tuple[dict[str, int] | None, float]:
    """Return exponents and factor of a unit; no exponents where Pint does not know it."""
    import pint

    if unit == "1":
        return {}, 1.0
    registry = _registry()
    try:
        base = registry.Quantity(1.0, unit).to_base_units()
    except (pint.UndefinedUnitError, pint.OffsetUnitCalculusError):
        return None, 1.0
    powers = {_BASE.get(name, name): power for name, power in base.dimensionality.items()}
    if any(name not in _BASE.values() or power != int(power) for name, power in powers.items()):
        return None, 1.0
    exponents = {base: int(powers[base]) for base in _BASE.values() if base in powers}
    return exponents, float(base.magnitude)


@cache
def _registry():  # type: ignore[no-untyped-def]
    import pint

    return pint.UnitRegistry()
