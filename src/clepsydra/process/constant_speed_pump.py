"""A pump at constant speed before a throttle: where its curve meets pipe, lift and a line back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import casadi as ca

from clepsydra.base.quantity import quantities, quantity
from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import from_si
from clepsydra.process.declared import choice, keys_of, part, read_fields, table_schema
from clepsydra.process.header_pump import (
    CURVE_TOLD,
    PumpBeside,
    check_minimum_flow,
    least_flow,
    npsh_at_the_end,
    read_beside,
    read_curve,
    remarks_of,
    seen_curve,
    so_many,
)
from clepsydra.process.pump_curve import PumpCurve
from clepsydra.process.recirculation import flow_beside_a_line
from clepsydra.process.table_reader import TableReader
from clepsydra.process.unlike_pumps import LikePumps, flow_of_unlike_pumps

#: What a Kv is defined with: water [kg/m³], and a pressure difference of 1 bar [Pa].
WATER, BAR = 1000.0, 1e5
#: Ways in which liquid comes back from the discharge to where it was drawn.
NONE, AUTOMATIC, OPEN_LINE = "none", "automatic", "open line"
_EXPECTED = "a table of a pump"
_REMEDY = (
    'write as in pump = { curve = [["0 m^3/h", "32 m"], ["30 m^3/h", "13 m"]], '
    'static_head = "8 m" }'
)


def kv_conductance(gravity: Any) -> Any:
    """Return what a Kv is multiplied by to be a flow per root of a metre [1/√m]."""
    return ca.sqrt(gravity * (WATER / BAR))


@dataclass(frozen=True)
class ConstantSpeedPump:
    """Like pumps at full speed on one header, with a check valve each.

    The head of a pump at its flow x is that of its curve, H = aᵢ - bᵢ x² between two points. N of
    them give the header q = N x, which meets the lift H_s and what pipe and throttle lose,
    (q/G)²:

        q = G √(aᵢ - H_s) / √(1 + (bᵢ/N²) G²),

    in the segment i in which q/N lies: a closed form with one root of the head. An *automatic*
    recirculation valve keeps each pump at its minimum flow, so that the head below that flow is
    the one at it. An *open line* lets G_r √H back to where it was drawn: the flow is then the root
    of G √(H - H_s) + G_r √H = N x, see `clepsydra.process.recirculation`. With unlike pumps
    *beside* them the header gets what the curves have together at one head, see
    `clepsydra.process.unlike_pumps`. J. F. Gülich,
    Centrifugal Pumps, 3rd edition, 2014, sections 11.1 to 11.4, doi 10.1007/978-3-642-40114-5.

    Parameters
    ----------
    curve : PumpCurve
        Of one pump.
    static_head : float
        H_s, height of the end of the pipe above the source's floor, or above a reservoir [m].
    pumps : float
        N, how many run.
    minimum_flow : float
        Of one pump [m³/s].
    recirculation : {"none", "automatic", "open line"}
    recirculation_kv : float
        Of the open line [m³/s at 1 bar].
    npsh_required : float
        Head that a pump needs above vapour pressure at its inlet, at the last flow of its curve;
        at another one in proportion to the flow squared [m].
    npsh_available : float
        What it has with an empty source [m]; the level adds to it.
    beside : PumpBeside or None
        An unlike pump on the same header, or several like it.
    name : str
        Of the valve behind it.

    Examples
    --------
    At 15 m³/h a curve through 30 m at 10 and 24 m at 20 m³/h gives 27.5 m; of these a lift of 8.2 m
    leaves 19.3 m to the valve:

    >>> points = ((0.0, 32.0), (10 / 3600, 30.0), (20 / 3600, 24.0), (30 / 3600, 13.0))
    >>> pump = ConstantSpeedPump(PumpCurve(points), static_head=8.2, name="LV")
    >>> symbols = {"LV.static_head": 8.2, "LV.pumps": 1.0}
    >>> round(float(pump.flow(15 / 3600 / 19.3**0.5, 0.0, symbols)) * 3600, 9)
    15.0
    """

    curve: PumpCurve = part(read_curve, required=("",), **CURVE_TOLD)
    static_head: float = quantity(
        "m",
        "a height",
        "static head of",
        at_least=0.0,
        remedy="give the height of the end of the pipe above the source",
    )
    pumps: float = so_many()
    recirculation: str = choice(
        (NONE, AUTOMATIC, OPEN_LINE), words="how liquid comes back from its discharge"
    )
    minimum_flow: float = least_flow()
    recirculation_kv: float = quantity(
        "m^3/s",
        "a Kv",
        "flow at 1 bar in the recirculation of",
        above=0.0,
        absent=0.0,
        remedy="give the flow at 1 bar of the line back",
    )
    npsh_required: float = npsh_at_the_end()
    npsh_available: float = quantity(
        "m",
        "a head",
        default=0.0,
        needs="npsh_required",
        remedy="give the NPSH at the inlet while the source is empty",
    )
    beside: PumpBeside | None = part(
        read_beside,
        default=None,
        **{"description": "an unlike pump on the same header", **table_schema(PumpBeside)},
    )
    name: str = field(default="", kw_only=True)
    display_units: Mapping[str, str] = field(default_factory=dict, compare=False, kw_only=True)

    @classmethod
    def read(cls, table: TableReader, key: str) -> Self:
        """Read the table of a pump that stands in that of a valve.

        Parameters
        ----------
        key : str
            Under which it stands.
        """
        inner = table.table(key, _EXPECTED, _REMEDY, keys_of(cls))
        pump = cls(**read_fields(cls, inner), display_units=inner.display_units(*keys_of(cls)))
        shut_off = pump.curve.points[0][1]
        if pump.static_head >= shut_off:
            unit = pump.display_units.get("static_head", "m")
            raise inner.wrong(
                "static_head",
                f"a height below the head at no flow, {from_si(shut_off, 'm', unit):g} {unit}",
                "choose a pump with more head, or correct the height",
            )
        if pump.recirculation == AUTOMATIC and not pump.minimum_flow:
            raise inner.wrong(
                "recirculation",
                "a minimum_flow beside it, below which it opens",
                'add as in minimum_flow = "4 m^3/h"',
            )
        check_minimum_flow(pump, inner)
        if (pump.recirculation == OPEN_LINE) != bool(pump.recirculation_kv):
            raise inner.wrong(
                "recirculation_kv" if pump.recirculation_kv else "recirculation",
                f'a recirculation_kv with recirculation = "{OPEN_LINE}", and with no other',
                "give both, or none",
            )
        if pump.beside is None:
            return pump
        if pump.recirculation == OPEN_LINE:
            raise inner.wrong(
                "beside",
                f'no unlike pump beside recirculation = "{OPEN_LINE}"',
                f'write recirculation = "{AUTOMATIC}", or give both pumps one curve',
            )
        if pump.recirculation == AUTOMATIC and not pump.beside.minimum_flow:
            raise inner.wrong(
                "beside",
                f'a minimum_flow in it with recirculation = "{AUTOMATIC}"',
                'add as in minimum_flow = "4 m^3/h"',
            )
        return pump

    def named(self, valve: str) -> Self:
        """Return it as the pump of a valve, to which its parameters belong."""
        beside = self.beside and replace(self.beside, name=path(valve, "beside"))
        return replace(self, name=valve, beside=beside)

    def parameters(self) -> tuple[Signal, ...]:
        """Return lift, number of pumps and line back as parameters of the valve."""
        found = (
            each.parameter(pump, pump.display_units.get(each.name, ""))
            for pump in (self, self.beside)
            if pump is not None
            for each in quantities(type(pump))
        )
        return tuple(signal for signal in found if signal is not None)

    def flow(self, conductance: Any, source_head: Any, symbols: Mapping[str, Any]) -> ca.SX:
        """Return what goes through the throttle [m³/s].

        Parameters
        ----------
        conductance : casadi.SX
            G of pipe and throttle [m³/s per root of a metre].
        source_head : casadi.SX
            Of the liquid above the source's floor, and its pressure [m].
        """
        return self._balance(conductance, source_head, symbols)[0]

    def pump_flows(
        self, conductance: Any, source_head: Any, symbols: Mapping[str, Any]
    ) -> tuple[ca.SX, ...]:
        """Return what each pump gives, and each of those beside them [m³/s], as for `flow`."""
        _, flows = self._balance(conductance, source_head, symbols)
        if self.recirculation != AUTOMATIC:
            return flows
        return tuple(
            ca.fmax(flow, pump.minimum_flow) for flow, pump in zip(flows, self._kinds, strict=True)
        )

    def remarks(
        self, conductance: float, source_head: float, symbols: Mapping[str, float]
    ) -> tuple[Remark, ...]:
        """Return what a pump does not bear for long: too little flow, too much, too little NPSH."""
        names = f"the pump of {self.name}", f"the pump beside that of {self.name}"
        flows = self.pump_flows(conductance, source_head, symbols)
        return tuple(
            remark
            for pump, name, flow in zip(self._kinds, names, flows, strict=False)
            for remark in remarks_of(pump, name, float(flow), self.npsh_available + source_head)
        )

    def _balance(
        self, conductance: Any, source_head: Any, symbols: Mapping[str, Any]
    ) -> tuple[ca.SX, tuple[ca.SX, ...]]:
        """Return what goes through the throttle, and what each pump of a kind gives to it."""
        conductance = ca.SX(conductance)
        lift = symbols[path(self.name, "static_head")] - source_head
        first, *beside = (
            LikePumps(
                seen_curve(pump, automatic=self.recirculation == AUTOMATIC),
                symbols[path(pump.name, "pumps")],
            )
            for pump in self._kinds
        )
        if beside:
            into, *flows = flow_of_unlike_pumps(first, beside[0], conductance, lift)
            return into, tuple(flows)
        if self.recirculation == OPEN_LINE:
            line = symbols[path(self.name, "recirculation_kv")] * kv_conductance(symbols["gravity"])
            corners = [flow for flow, _ in first.curve.points[1:-1]]
            into, flow = flow_beside_a_line(
                first.curve.segments, corners, conductance, lift, first.pumps, line
            )
            return into, (flow,)
        into = first.curve.throttled(conductance, lift, first.pumps)
        return into, (into / first.pumps,)

    @property
    def _kinds(self) -> tuple[ConstantSpeedPump | PumpBeside, ...]:
        return (self,) if self.beside is None else (self, self.beside)
