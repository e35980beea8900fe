"""How far a level may move, and how fast a load moves it: what averaging control starts from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.first_order_delay import half_rule
from clepsydra.designs.models.transfer_element import transfer_element
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.elements.pump import Pump
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.level_switch import LevelLimit
from clepsydra.process.process import Process

#: What is kept free before a limit, a share of the measurement's range.
MARGIN = 0.1


class Load(NamedTuple):
    """A step of a disturbance, and how fast it moves a measurement at first.

    Parameters
    ----------
    signal, unit : str
    size : float
        [its unit]
    rate : float
        Magnitude [unit of the measurement per second].

    Examples
    --------
    >>> Load("inflow", "m^3/s", 0.12, 1.2e-4).rate
    0.00012
    """

    signal: str
    unit: str
    size: float
    rate: float


def largest_load(model: LinearModel, output: str, method: str) -> Load:
    """Return the load step of the process that moves a measurement fastest.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    output : str
    method : str
        For the message.

    Raises
    ------
    NotApplicable
        The process names no load step that moves the measurement.

    Examples
    --------
    A basin of 1000 m² whose sensor shows 5 m as 100 %:

    >>> import clepsydra as cl
    >>> load = largest_load(cl.load("equalisation-tank").linear, "level", "by hand")
    >>> load.signal, round(load.rate, 9)
    ('inflow', 2.4e-05)
    """
    process = operating_point_of(model).process
    loads = []
    for element in process.elements:
        for name, size in element.load_steps().items():
            if name not in model.disturbances:
                continue
            found = transfer_element(as_input(model, name), output, name, method=method)
            if found is not None:
                rate = abs(half_rule(found, method=method).slope * size)
                loads.append(Load(name, process.signal(name).unit, size, rate))
    if not loads:
        raise NotApplicable(
            method, f"the process names no load step that moves {output}; give an arrest time"
        )
    return max(loads, key=lambda load: load.rate)


def as_input(model: LinearModel, disturbance: str) -> LinearModel:
    """Return the model with a disturbance in the place of its inputs, its dead times at zero.

    How fast a load moves a level does not depend on when it arrives.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one, one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), ("inflow",), ("level",))
    >>> as_input(tank, "inflow").B
    array([[1.]])
    """
    model = at_rest(model)
    column = [model.disturbances.index(disturbance)]
    empty = np.zeros((len(model.outputs), 1))
    return replace(
        model,
        B=model.E[:, column],
        D=empty,
        E=np.zeros((len(model.states), 0)),
        inputs=(disturbance,),
        disturbances=(),
    )


def averaging_room(point: OperatingPoint, output: Signal, method: str) -> float:
    """Return how far a level may move to the nearest limit, less a margin [output unit].

    Limits are the ends of the measurement's range, the floor and the rim of the tank, and the
    level switches of pumps; the margin is a tenth of the measurement's range.

    Raises
    ------
    NotApplicable
        There is no room left beyond the margin.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("equalisation-tank"))
    >>> round(averaging_room(point, point.process.signal("level"), "by hand"), 9)
    0.4
    """
    here = point.as_dict()[output.name]
    limits = [output.low, output.high, *_vessel_limits(point, output.name)]
    way = min(abs(limit - here) for limit in limits)
    room = way - MARGIN * output.span
    if room <= 0.0:
        raise NotApplicable(
            method,
            f"{output.name} stands {100.0 * way / output.span:.2g} % of its range from a limit, "
            f"and {100.0 * MARGIN:g} % are kept free",
        )
    return room


def is_level(process: Process, output: str) -> bool:
    """Return whether a measurement shows how full a tank is.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> basin = load_process("equalisation-tank")
    >>> is_level(basin, "level"), is_level(basin, "strength")
    (True, False)
    """
    if process.measured_state.get(output) in process.levels:
        return True
    return any(
        isinstance(element, Sensor)
        and element.name == output
        and element.measured in ("level", "volume")
        for element in process.elements
    )


def _vessel_limits(point: OperatingPoint, output: str) -> Iterator[float]:
    """Yield floor, rim and switches of the measured tank, as the sensor would read them."""
    process = point.process
    shown = process.measured_state[output]
    if shown not in process.levels:
        return  # a sensor with a lag shows a state of its own, and its range has to do
    place = [signal.name for signal in process.state].index(shown)
    row = [signal.name for signal in process.measurements].index(output)
    tank = process.state[place]
    switches = [limit.level for limit in _switches(process) if f"{limit.tank}.level" == shown]
    for level in (tank.low, tank.high, *switches):
        state = np.array(point.state, float)
        state[place] = level
        yield float(np.array(process.measure(state, process.parameter_values)).ravel()[row])


def _switches(process: Process) -> Iterator[LevelLimit]:
    """Yield the trips of pumps, and the levels that would stop a running one or start another."""
    for element in process.elements:
        if not isinstance(element, Pump):
            continue
        if element.trips is not None:
            yield from element.trips.limits
        if element.starter is not None:
            yield element.starter.stop if element.starter.running else element.starter.start
