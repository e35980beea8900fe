"""How far a level may move, and how fast a load moves it: what averaging control starts from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.delayed_lags import half_rule
from clepsydra.designs.models.transfer_element import transfer_element
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.averaging import averaged_flows
from clepsydra.process.elements.pump import Pump
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.process import Process

#: What is kept free before a limit, a share of the measurement's range.
MARGIN = 0.1
#: What is kept free of a band, a share of the way to its end: a design knows the tank near the
#: operating point, and a controller acts at samples.
BAND_MARGIN = 0.05
_LEVELS = 201


class Room(NamedTuple):
    """How far a level may move either way [output unit].

    Examples
    --------
    A level that swings back by half as far as it was moved:

    >>> Room(below=0.1, above=0.3).against(+1.0, swings_back=0.5)
    0.2
    """

    below: float
    above: float

    def against(self, rate: float, swings_back: float = 0.0) -> float:
        """Return how far a load of this direction may move it, so that it has room both ways."""
        first, second = (self.above, self.below) if rate > 0.0 else (self.below, self.above)
        return min(first, second / swings_back) if swings_back else first


class Load(NamedTuple):
    """A step of a disturbance, and how fast it moves a measurement at first.

    Parameters
    ----------
    size : float
        [its unit]
    rate : float
        [unit of the measurement per second]
    """

    signal: str
    size: float
    rate: float


def load_steps(model: LinearModel, output: str, others: Sequence[str] = ()) -> list[Load]:
    """Return the load steps of the process that move a measurement.

    One that an averaging tank upstream passes on arrives through the inputs of other loops. It is
    taken as a step of what these have moved when all is at rest again: nearly as it comes from a
    loop as slow as this one, and as worse than it comes from any other.

    Parameters
    ----------
    others : sequence of str
        The inputs of other loops.

    Raises
    ------
    NotApplicable
        The process names no load step that moves the measurement.

    Examples
    --------
    A basin of 1000 m² whose sensor shows 5 m as 100 %:

    >>> import clepsydra as cl
    >>> (load,) = load_steps(cl.load("equalisation-tank").linear, "level")
    >>> load.signal, round(load.rate, 9)
    ('inflow', 2.4e-05)
    """
    process, loads = operating_point_of(model).process, []
    for element in process.elements:
        for name, sizes in element.load_steps().items():
            if name not in model.disturbances:
                continue
            slope = _slope(_as_input(model, name), output, name)
            if others:
                moves = _moves_at_rest(model, name)
                slope += sum(moves[u] * _slope(model, output, u) for u in others)
            loads += [Load(name, size, slope * size) for size in sizes if slope]
    if not loads:
        raise NotApplicable(
            f"the process names no load step that moves {output}; give an arrest time"
        )
    return loads


def _slope(model: LinearModel, output: str, input_name: str) -> float:
    """Return how fast a unit of an input moves an output at first; 0 where it does not."""
    found = transfer_element(model, output, input_name)
    return half_rule(found).slope if found is not None else 0.0


def _moves_at_rest(model: LinearModel, disturbance: str) -> dict[str, float]:
    """Return how far each input has moved when a unit of a load has left no error."""
    model, process = at_rest(model), operating_point_of(model).process
    rows = [place for place, name in enumerate(model.outputs) if name in process.controlled]
    matrix = np.block([[model.A, model.B], [model.C[rows], model.D[rows]]])
    pushed = np.append(-model.E[:, model.disturbances.index(disturbance)], np.zeros(len(rows)))
    found = np.linalg.lstsq(matrix, pushed, rcond=None)[0]
    return dict(zip(model.inputs, found[len(model.states) :].tolist(), strict=True))


def _as_input(model: LinearModel, disturbance: str) -> LinearModel:
    """Return the model with a disturbance in the place of its inputs, its dead times at zero."""
    model = at_rest(model)
    columns = [
        *range(len(model.states)),
        model.ports.d.start + model.disturbances.index(disturbance),
    ]
    return model.with_matrix(
        model.matrix[:, columns], model.times, inputs=(disturbance,), disturbances=()
    )


def averaging_room(point: OperatingPoint, output: Signal) -> Room:
    """Return how far a level may move [output unit].

    With a band, to its ends but for a twentieth of the way. Else as far either way as the nearest
    of the ends of the measurement's range, the floor and the rim of the tank, and the level
    switches of pumps is away, less a tenth of the measurement's range.

    Raises
    ------
    NotApplicable
        There is no room left beyond the margin.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("equalisation-tank"))
    >>> round(averaging_room(point, point.process.signal("level")).above, 9)
    0.4
    """
    here = point.as_dict()[output.name]
    band = point.process.bands.get(output.name)
    if band is not None:
        free = 1.0 - BAND_MARGIN
        room = Room(free * (here - band[0]), free * (band[1] - here))
        if min(room) <= 0.0:
            raise NotApplicable(f"{output.name} rests at the end of its band")
        return room
    limits = [output.low, output.high, *_vessel_limits(point, output.name)]
    way = min(abs(limit - here) for limit in limits)
    left = way - MARGIN * output.span
    if left <= 0.0:
        raise NotApplicable(
            f"{output.name} stands {100.0 * way / output.span:.2g} % of its range from a limit, "
            f"and {100.0 * MARGIN:g} % are kept free"
        )
    return Room(left, left)


def longest_arrest(model: LinearModel) -> float:
    """Return the longest arrest time of the levels with a band, under their worst load step [s].

    That of damping 1 on the linear model, e · room / rate; 0 where no load moves a level with a
    band.

    Examples
    --------
    >>> import clepsydra as cl
    >>> longest_arrest(cl.load("equalisation-tank").linear)
    0.0
    """
    point = operating_point_of(model)
    times = [0.0]
    for name in point.process.bands:
        with suppress(NotApplicable):
            room = averaging_room(point, point.process.signal(name))
            leaving, _ = averaged_flows(point.process, name)
            loads = load_steps(model, name, [u for u in model.inputs if u not in leaving])
            times.append(math.e * min(room.against(each.rate) / abs(each.rate) for each in loads))
    return max(times)


def smallest_area(point: OperatingPoint, output: Signal, room: Room) -> float:
    """Return the smallest surface that a tank has within the room, over that at rest.

    There a flow moves the level fastest. It is 1 of a volume, and of a tank with upright walls.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("equalisation-tank"))
    >>> smallest_area(point, point.process.signal("level"), Room(0.1, 0.1))
    1.0
    """
    process, here = point.process, point.as_dict()[output.name]
    sensor = next((e for e in process.elements if e.name == output.name), None)
    if not isinstance(sensor, Sensor) or sensor.measured != "level":
        return 1.0
    tank = next(e for e in process.elements if e.name == sensor.tank and isinstance(e, Tank))
    readings = np.append(np.linspace(here - room.below, here + room.above, _LEVELS), here)
    values = tank.vessel.values()
    areas = [float(tank.vessel.surface(ca.SX(sensor.to_quantity(y)), values)) for y in readings]
    return min(areas) / areas[-1]


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
    levels = [process.state[place].low, process.state[place].high]
    for pump in process.elements:
        if isinstance(pump, Pump) and pump.trips is not None:
            levels += [trip.level for trip in pump.trips.limits if f"{trip.tank}.level" == shown]
        if isinstance(pump, Pump) and (starter := pump.starter) is not None:
            # The level that would stop a running one or start another.
            switch = starter.stop if starter.running else starter.start
            levels += [switch.level] if f"{switch.tank}.level" == shown else []
    for level in levels:
        state = np.array(point.state, float)
        state[place] = level
        yield float(np.array(process.measure(state, process.parameter_values)).ravel()[row])
