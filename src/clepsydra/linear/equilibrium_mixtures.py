"""Concentrations that no mixture of what flows into a plant has."""

from __future__ import annotations

import numpy as np

from clepsydra.base.units import from_si
from clepsydra.linear.equilibrium_request import EquilibriumRequest
from clepsydra.process.concentrations import BringsFromOutside
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.kinds import kinds
from clepsydra.process.outside_signal import DisturbanceRange
from clepsydra.process.process import Process

# A share of a concentration that rounding may add to it.
_ROUNDING = 1e-9


def beyond_mixtures(process: Process, request: EquilibriumRequest) -> tuple[str, ...]:
    """Return a sentence for each asked concentration that no mixture of what flows in can have.

    Tanks mix, and nothing else changes a concentration, unless liquid evaporates or an element is
    of the user's own: then there is no such bound.

    Parameters
    ----------
    request : EquilibriumRequest
        Of that process.
    """
    bounded = all(type(each) in kinds() for each in process.elements) and not any(
        isinstance(each, Tank) and each.evaporation for each in process.elements
    )
    sensors = {each.name: each for each in process.elements if isinstance(each, Sensor)}
    components = {each.name: each for each in process.components}
    reasons = []
    for place, target in zip(request.outputs, request.targets, strict=True):
        sensor = sensors.get(process.measurements[place].name)
        if not bounded or sensor is None or sensor.measured not in components:
            continue
        component = components[sensor.measured]
        asked = sensor.to_quantity(float(target))
        brought = _brought(process, request, component.name)
        least = min(brought, key=lambda each: each[0])
        most = max(brought, key=lambda each: each[1])
        slack = _ROUNDING * max(abs(asked), most[1])
        if least[0] - slack <= asked <= most[1] + slack:
            continue
        unit = component.display_unit or component.unit
        wanted, low, high = (
            f"{from_si(value, component.unit, unit):.4g} {unit}"
            for value in (asked, least[0], most[1])
        )
        reasons.append(
            f"{sensor.name} asks for {wanted} of {component.name} in {sensor.tank}, but no mixture "
            f"of {low} ({least[2]}) and {high} ({most[2]}), which is what flows in, gives {wanted}"
            if least[2] != most[2]
            else f"{sensor.name} asks for {wanted} of {component.name} in {sensor.tank}, but all "
            f"that flows in ({most[2]}) has {high}"
        )
    return tuple(reasons)


def _brought(
    process: Process, request: EquilibriumRequest, component: str
) -> list[tuple[float, float, str]]:
    """Return least and largest concentration of each liquid that flows in, and where from [SI]."""
    elements = {each.name: each for each in process.elements}
    free = {process.inputs[place].name for place in request.free_inputs}
    signals = (*process.inputs, *process.disturbances)
    given = np.concatenate([request.inputs, request.disturbances])
    values = dict(zip((signal.name for signal in signals), given, strict=True))
    found = []
    for path in process.motion.flow_paths:
        element = elements[path.source or path.element.partition(".")[0]]
        if path.source and not element.endless:
            continue
        low = high = 0.0
        if isinstance(element, BringsFromOutside) and component in element.given:
            stream = element.given[component]
            if isinstance(stream, DisturbanceRange):
                name = f"{element.name}.{component}"
                low = high = float(values[name])
                if name in free:
                    low, high = stream.low, stream.high
            else:
                low = high = stream
        found.append((low, high, element.name))
    return found
