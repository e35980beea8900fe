"""What the inputs of an equilibrium are to the plant: flows, at the ends of their ranges too."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible, from_si, unit_text
from clepsydra.base.words import digits_apart
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import beyond_of_range, shown
from clepsydra.process.element import Element
from clepsydra.process.elements.pump import Pump

_FLOW = "m^3/s"
# How far inside of its end, as a share of the range, the flow is taken for its slope there.
_INSIDE = 1e-3
# A flow this near to a straight line over the whole range counts as in proportion to the signal.
_STRAIGHT = 1e-6
# A share of the range; nearer to an end of it there is hardly any room for control.
_NEAR = 0.05
# A percentage that was meant as a number is a hundred times too large; less may be a small pump.
_FAR = 10.0


@dataclass(frozen=True, eq=False)
class InputFlow:
    """The flow that an element causes over the range of its signal, with all levels as they are.

    Parameters
    ----------
    unit : str
        The one in which its file gives flows.
    """

    point: OperatingPoint
    element: Element
    signal: Signal
    unit: str

    def at(self, share: float) -> float:
        """Return the flow at a share of the range from 0 to 1 [m³/s].

        An actuator that takes its time has arrived there.
        """
        process, motion = self.point.process, self.point.process.motion
        p, state, inputs = (
            process.parameter_values,
            self.point.state.copy(),
            self.point.inputs.copy(),
        )
        for signals, values in ((process.state, state), (process.inputs, inputs)):
            for place, signal in enumerate(signals):
                moved = signal.name == self.signal.name or signal.owner == self.signal.name
                if moved and math.isfinite(signal.span):
                    values[place] = signal.low + share * signal.span
        rest = motion.at_rest(state, inputs, self.point.disturbances, p)
        flows = np.array(motion.flows(*rest)).ravel()
        own = [path.element == self.element.name for path in motion.flow_paths]
        return float(flows[own].sum())

    def beyond(self, share: float) -> float:
        """Return the flow at a share outside of the range, in a straight line from its end."""
        end = 1.0 if share > 1.0 else 0.0
        inside = abs(end - _INSIDE)
        slope = (self.at(end) - self.at(inside)) / (end - inside)
        return self.at(end) + slope * (share - end)

    @property
    def straight(self) -> bool:
        """Whether it is in proportion to the signal, beyond the range too."""
        low, middle, high = (self.at(share) for share in (0.0, 0.5, 1.0))
        return abs(middle - (low + high) / 2.0) <= _STRAIGHT * abs(high - low)

    def shown(self, flow: float, digits: int = 3) -> str:
        """Return a flow [m³/s] as text."""
        return f"{from_si(flow, _FLOW, self.unit):.{digits}g} {unit_text(self.unit)}"

    def shown_apart(self, flow: float, other: float) -> tuple[str, str]:
        """Return two flows [m³/s] as texts, with digits that tell them apart."""
        unit = _FLOW, self.unit
        digits = digits_apart(from_si(flow, *unit), from_si(other, *unit), digits=3)
        return self.shown(flow, digits), self.shown(other, digits)


@dataclass(frozen=True, eq=False)
class BeyondRange:
    """An input that would have to leave its range to hold an equilibrium.

    Parameters
    ----------
    value : float
        The one that it would have to have [its unit].
    flow : InputFlow or None
        What it moves; None where that is no flow of an element, or it is a flow itself.
    """

    signal: Signal
    value: float
    flow: InputFlow | None

    @property
    def share(self) -> float:
        """Where the value lies: below 0 or above 1, as a share of the range."""
        return (self.value - self.signal.low) / self.signal.span

    @property
    def end(self) -> float:
        """The end of the range beyond which the value lies [its unit]."""
        return self.signal.high if self.share > 1.0 else self.signal.low

    @property
    def excess(self) -> float:
        """How far beyond that end the value lies [its unit]."""
        return abs(self.value - self.end)

    @property
    def flows(self) -> tuple[float, float] | None:
        """The flow at that end, and the one that is needed [m³/s]; None without a flow."""
        if self.flow is None:
            return None
        return self.flow.at(1.0 if self.share > 1.0 else 0.0), self.flow.beyond(self.share)


def input_flow(point: OperatingPoint, signal: Signal) -> InputFlow | None:
    """Return the flow that an input moves; None where it is no flow of an element, or itself one.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> flow = input_flow(point, point.process.inputs[0])
    >>> flow.shown(flow.at(1.0))
    '33.3 cm³/s'
    """
    process = point.process
    element = next((each for each in process.elements if each.name == signal.name), None)
    caused = [path.element for path in process.motion.flow_paths]
    if element is None or signal.name not in caused or signal.unit == _FLOW or not signal.has_range:
        return None
    unit = _unit_of_flow(element, signal)
    return InputFlow(point, element, signal, unit)


def _unit_of_flow(element: Element, signal: Signal) -> str:
    """Return the unit in which a file gives the flow of an element: that of a Kv, or of a gain."""
    for written in element.display_units.values():
        without = re.sub(rf"[ */]*{re.escape(signal.shown_unit)}(?!\w)", "", written)
        bare = re.sub(r"\( *(\w+) *\)", r"\1", without)
        for unit in (bare, written):
            if "%" not in unit and convertible(unit, _FLOW):
                return unit
    return "m^3/h"


def beyond_its_range(beyond: BeyondRange) -> str:
    """Return what an input would have to be beyond its range, and the flow that it is about."""
    signal, value, flow, flows = beyond.signal, beyond.value, beyond.flow, beyond.flows
    words = f"{signal.name} would have to "
    if flow is None or flows is None:
        return f"{words}be {beyond_of_range(signal, value)}"
    most, needed = flows
    if flow.straight:
        words += f"be {beyond_of_range(signal, value)}: "
    else:
        words += f"go beyond {shown(signal, beyond.end)}, the end of its range: "
    if needed < 0.0:
        return f"{words}{flow.shown(-needed)} would have to flow back through it"
    given, asked = flow.shown_apart(most, needed)
    gives = f"at {shown(signal, beyond.end)} it gives {given}, and {asked} are needed"
    return f"{words}{gives}{_percent_forgotten(flow, value)}"


def _percent_forgotten(flow: InputFlow, value: float) -> str:
    """Return which unit a gain of a signal in percent may lack, "" where that would not help."""
    element, signal = flow.element, flow.signal
    written = element.display_units.get("gain", "")
    percent = isinstance(element, Pump) and signal.shown_unit == "%" and written
    if not percent or "%" in written or not signal.high * _FAR < value <= 100.0 * signal.high:
        return ""
    place = flow.point.process.place(element.table, element.name, "gain")
    return (
        f" ({place}: a gain in {written} is the flow at 100 %; that of each percent is in "
        f"{_per_percent(written)})"
    )


def _per_percent(unit: str) -> str:
    """Return a unit of flow for each percent.

    >>> _per_percent("m^3/h"), _per_percent("l / min")
    ('m^3/(h %)', 'l/(min %)')
    """
    above, _, below = unit.partition("/")
    return f"{above.strip()}/({below.strip('() ')} %)"


def warnings_of_inputs(point: OperatingPoint) -> list[Remark]:
    """Return a sentence for each input that rests so near an end of its range that it has no room.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> warnings_of_inputs(find_equilibrium(load_process("quadruple-tank"), {"pump_1": 0.2}))
    ['pump_1 rests at 0.2 V, close to the end of its range at 0 V, where a controller can hardly \
lower it: it gives 0.666 cm³/s of at most 33.3 cm³/s; move the operating point, or give it \
another size.']
    """
    found = []
    for signal, value in zip(point.process.inputs, point.inputs, strict=True):
        share = (value - signal.low) / signal.span if signal.has_range else 0.5
        if _NEAR <= share <= 1.0 - _NEAR:
            continue
        way, end = ("raise", signal.high) if share > 0.5 else ("lower", signal.low)
        words = (
            f"the end of its range, where a controller cannot {way} it"
            if value == end
            else f"close to the end of its range at {shown(signal, end)}, where a controller can "
            f"hardly {way} it"
        )
        flow = input_flow(point, signal)
        gives = (
            flow and f"it gives {flow.shown(flow.at(share))} of at most {flow.shown(flow.at(1.0))}"
        )
        remedy = "move the operating point, or give it another size"
        seen = f"{signal.name} rests at {shown(signal, value)}, {words}"
        found.append(Remark(seen, gives or "", remedy))
    return found
