"""What hands can do to a process beside its own signals: pour water in, and open another hole."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.elements.forced_flow import ForcedFlow
from clepsydra.process.elements.linear_outlet import LinearOutlet
from clepsydra.process.elements.orifice import Orifice
from clepsydra.process.elements.reservoir import Reservoir
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.equations import join
from clepsydra.process.process import Process

#: Share of a level's scale that pouring once adds, and how long that takes [s], or a sample.
POURED, POURING = 0.25, 1.0
#: A hole is as large as what runs through a tank at rest asks for, and no smaller than one that
#: drains as much as a full tank holds in so many sampling periods.
SLOWEST_DRAINING = 1000.0
_OUTSIDE = "outside_of_the_rig"


@dataclass(frozen=True)
class HandsOnTank:
    """What hands can do to a tank.

    Attributes
    ----------
    tank : str
    pour : str
        The disturbance that pours into it.
    full : float
        The flow that adds a quarter of its scale in `samples` [m³/s].
    samples : int
        How long pouring once takes.
    extra_outlet : str
        The parameter of a hole that is closed.
    area : float
        Of the hole when it is open [m²].
    outlets : dict
        Element to the parameter that is 0 where it is plugged.
    """

    tank: str
    pour: str
    full: float
    samples: int
    extra_outlet: str
    area: float
    outlets: dict[str, str]


def with_hands(model: LinearModel) -> LinearModel:
    """Return a model of the process with an inflow and a closed hole more for each tank.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = with_hands(cl.load("quadruple-tank").linear)
    >>> [signal.name for signal in model.point.process.disturbances][-1]
    'pour_into_tank_4'
    """
    point = operating_point_of(model)
    process = point.process
    tanks = [each for each in process.elements if isinstance(each, Tank)]
    sinks = [each.name for each in process.elements if isinstance(each, Reservoir)]
    added = [] if sinks else [Reservoir(_OUTSIDE)]
    sink = sinks[0] if sinks else _OUTSIDE
    elements = (
        *process.elements,
        *added,
        *(
            element
            for tank in tanks
            for element in (
                ForcedFlow(
                    _pour(tank), "", tank.name, low=0.0, high=_flow(process, tank), nominal=0.0,
                    components=process.components,
                ),
                Orifice(
                    _hole(tank), tank.name, sink, area=0.0, components=process.components
                ),
            )
        ),
    )  # fmt: skip
    joined = join(
        elements,
        process.signal("gravity"),
        components=process.components,
        manipulated=[u.name for u in process.inputs],
    )
    # Whose numbers may be others than those of its elements.
    own = {parameter.name: parameter for parameter in process.parameters}
    parameters = tuple(own.get(each.name, each) for each in joined.parameters)
    handled = replace(process, **vars(joined) | {"parameters": parameters}, elements=elements)
    at = point.as_dict()
    disturbances = np.array([at.get(d.name, 0.0) for d in handled.disturbances])
    return linearise(OperatingPoint.at(handled, point.state, point.inputs, disturbances))


def hands_on(point: OperatingPoint) -> list[HandsOnTank]:
    """Return what hands can do to each tank of a process `with_hands` at rest."""
    process = point.process
    holes = [each for each in process.elements if isinstance(each, Orifice | LinearOutlet)]
    found = []
    for tank in (each for each in process.elements if isinstance(each, Tank)):
        own = [each for each in holes if each.source == tank.name and each.name != _hole(tank)]
        found.append(
            HandsOnTank(
                tank.name,
                _pour(tank),
                _flow(process, tank),
                _samples(process),
                f"{_hole(tank)}.area",
                _area(point, tank),
                {each.name: f"{each.name}.{each.opening}" for each in own},
            )
        )
    return found


def _pour(tank: Tank) -> str:
    return f"pour_into_{tank.name}"


def _hole(tank: Tank) -> str:
    return f"extra_outlet_of_{tank.name}"


def _samples(process: Process) -> int:
    return max(1, round(POURING / process.sampling_period))


def _flow(process: Process, tank: Tank) -> float:
    """Return the flow that pours in once a quarter of what its level is shown against."""
    share = POURED
    for sensor in process.elements:
        if (
            isinstance(sensor, Sensor)
            and sensor.tank == tank.name
            and sensor.measured == "level"
            and sensor.unit == "1"
            and sensor.gain
        ):
            share = POURED / (sensor.gain * tank.height)
    return share * tank.vessel.capacity / (_samples(process) * process.sampling_period)


def _area(point: OperatingPoint, tank: Tank) -> float:
    """Return the hole through which as much runs at rest as already does."""
    process, motion, gravity = point.process, point.process.motion, point.process.signal("gravity")
    at = point.as_dict()
    rest = motion.at_rest(point.state, point.inputs, point.disturbances, process.parameter_values)
    flows = np.array(motion.flows(*rest)).ravel()
    leaving = sum(
        abs(flow)
        for way, flow in zip(motion.flow_paths, flows, strict=True)
        if way.source == tank.name
    )
    level = max(at[tank.level], 0.1 * tank.height)
    speed = np.sqrt(2 * gravity.initial * level)
    slowest = tank.vessel.capacity / (SLOWEST_DRAINING * process.sampling_period)
    return float(max(leaving, slowest) / speed)
