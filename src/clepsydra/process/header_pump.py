"""A pump on a header: what a file says of one, and what it does not bear for long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from clepsydra.base.quantity import quantity
from clepsydra.base.remark import Remark
from clepsydra.base.units import from_si, unit_text
from clepsydra.process import told
from clepsydra.process.declared import keys_of, part, read_fields
from clepsydra.process.pump_curve import PumpCurve
from clepsydra.process.table_reader import TableReader

_ROUNDING = 1e-9
#: What an editor is told of the curve of one pump.
CURVE_TOLD = told.pairs("points of flow and head of one pump", "m^3/s", "m")


def read_curve(table: TableReader, key: str, known: Mapping[str, Any]) -> PumpCurve:
    """Read the curve of one pump."""
    return PumpCurve.read(table)


def so_many() -> Any:
    """Return the field of how many of them run."""
    return quantity(
        "1",
        "a number of pumps",
        "pumps that run at",
        at_least=1.0,
        default=1.0,
        remedy="leave it out for one",
    )


def least_flow() -> Any:
    """Return the field of the minimum flow of one pump [m³/s]."""
    return quantity(
        "m^3/s",
        "a flow",
        at_least=0.0,
        default=0.0,
        remedy="give the smallest flow that one pump bears for long",
    )


def npsh_at_the_end() -> Any:
    """Return the field of the NPSH that one pump needs at the last flow of its curve [m]."""
    return quantity(
        "m",
        "a head",
        at_least=0.0,
        default=0.0,
        remedy="give the NPSH that the pump needs at the last flow of its curve",
    )


class HeaderPump(Protocol):
    """What every pump on a header has; all as in `PumpBeside`."""

    @property
    def curve(self) -> PumpCurve: ...  # noqa: D102
    @property
    def minimum_flow(self) -> float: ...  # noqa: D102
    @property
    def npsh_required(self) -> float: ...  # noqa: D102
    @property
    def display_units(self) -> Mapping[str, str]: ...  # noqa: D102


@dataclass(frozen=True)
class PumpBeside:
    """An unlike pump on the header of another one, or several like it, with a check valve each.

    Parameters
    ----------
    curve : PumpCurve
        Of one pump.
    pumps : float
        How many run.
    minimum_flow : float
        Of one pump [m³/s].
    npsh_required : float
        Of one pump at the last flow of its curve [m].
    name : str
        Of what its parameters belong to.
    """

    curve: PumpCurve = part(read_curve, required=("",), **CURVE_TOLD)
    pumps: float = so_many()
    minimum_flow: float = least_flow()
    npsh_required: float = npsh_at_the_end()
    name: str = field(default="", kw_only=True)
    display_units: Mapping[str, str] = field(default_factory=dict, compare=False, kw_only=True)


def read_beside(table: TableReader, key: str, known: Mapping[str, Any]) -> PumpBeside | None:
    """Read the table of a pump beside another one; None where there is none."""
    if not table.has(key):
        return None
    remedy = 'write as in beside = { curve = [["0 m^3/h", "25 m"], ["20 m^3/h", "10 m"]] }'
    keys = keys_of(PumpBeside)
    inner = table.table(key, "a table of another pump on the header", remedy, keys)
    pump = PumpBeside(**read_fields(PumpBeside, inner), display_units=inner.display_units(*keys))
    check_minimum_flow(pump, inner)
    return pump


def check_minimum_flow(pump: HeaderPump, table: TableReader) -> None:
    """Refuse a minimum flow beyond the curve of a pump, whose table this is."""
    last = pump.curve.points[-1][0]
    if pump.minimum_flow >= last:
        raise table.wrong(
            "minimum_flow",
            f"a flow below the end of the curve, {last:g} m^3/s",
            "correct the flow, or give the curve to its end",
        )


def seen_curve(pump: HeaderPump, *, automatic: bool) -> PumpCurve:
    """Return its curve as the header sees it: flat up to the minimum flow, if a valve keeps that.

    Examples
    --------
    >>> curve = PumpCurve(((0.0, 32.0), (4e-3, 16.0)))
    >>> seen_curve(PumpBeside(curve, minimum_flow=2e-3), automatic=True).points
    ((0.0, 28.0), (0.002, 28.0), (0.004, 16.0))
    """
    if not automatic:
        return pump.curve
    least = pump.minimum_flow
    head = pump.curve.head(least)
    rest = (each for each in pump.curve.points if each[0] > least)
    return PumpCurve(((0.0, head), (least, head), *rest))


def remarks_of(pump: HeaderPump, name: str, flow: float, available: float) -> tuple[Remark, ...]:
    """Return what a pump does not bear for long: too little flow, too much, too little NPSH.

    Parameters
    ----------
    name : str
        What messages call it.
    flow : float
        Of one pump at rest [m³/s].
    available : float
        NPSH that it has [m].
    """
    last = pump.curve.points[-1][0]
    unit = pump.display_units.get("minimum_flow", "m^3/h")
    of_head = pump.display_units.get("npsh_required", "m")

    def shown(value: float) -> str:
        return f"{from_si(value, 'm^3/s', unit):.3g} {unit_text(unit)}"

    found = []
    if flow < pump.minimum_flow * (1 - _ROUNDING):
        found.append(
            Remark(
                f"{name} gives {shown(flow)} at rest, left of its minimum flow of "
                f"{shown(pump.minimum_flow)}",
                "it recirculates inside, heats up and wears",
                'let liquid come back as in recirculation = "automatic"',
            )
        )
    if flow > last * (1 + _ROUNDING):
        found.append(
            Remark(
                f"{name} gives {shown(flow)} at rest, beyond the end of its curve at {shown(last)}",
                "there the curve is only continued, and its motor may be overloaded",
                "throttle more, or choose a larger pump",
            )
        )
    needed = pump.npsh_required * (flow / last) ** 2
    if pump.npsh_required and needed > available:
        found.append(
            Remark(
                f"{name} needs an NPSH of {from_si(needed, 'm', of_head):.3g} {of_head} at "
                f"{shown(flow)} and has {from_si(available, 'm', of_head):.3g} {of_head}",
                "it cavitates",
                "raise the level of its source, or let less through",
            )
        )
    return tuple(found)
