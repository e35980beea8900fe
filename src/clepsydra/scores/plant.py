"""What a run says of the plant beside its loops: flows, heads, pumps that run, filling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import casadi as ca
import numpy as np

from clepsydra.engine.many_points import at_many_points
from clepsydra.process.elements.pump import Pump
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.motion import FlowPath
from clepsydra.process.process import Process
from clepsydra.process.vessels.vessel import Vessel
from clepsydra.scores.plant_flows import plant_flows
from clepsydra.scores.trajectory import FloatArray


@dataclass(frozen=True, eq=False)
class BufferTrajectories:
    """What flows through a tank that is there to smooth a flow.

    Parameters
    ----------
    inflow, outflow : ndarray [n]
        All that enters; all that leaves but what spills or evaporates [m³/s].
    filling : ndarray [n]
        Volume over capacity [1].
    """

    inflow: FloatArray
    outflow: FloatArray
    filling: FloatArray


@dataclass(frozen=True, eq=False)
class PlantTrajectories:
    """What a run says of the plant beside its loops, sample by sample.

    Parameters
    ----------
    pumped : mapping
        Pump to its flow [n] [m³/s].
    running : mapping
        The same pumps to 1 where they run and 0 where they stand still [n].
    heads : mapping
        Those pumps that have a curve to what they lift against [n] [m].
    spilt : mapping
        Tank with a weir to the volume lost over it until then [n] [m³].
    buffers : mapping
        Averaging measurement of the process to what flows through its tank.
    bands : mapping
        Those of them with a band to its ends [signal unit].
    gravity : float
        [m/s²]
    """

    pumped: Mapping[str, FloatArray] = field(default_factory=dict)
    running: Mapping[str, FloatArray] = field(default_factory=dict)
    heads: Mapping[str, FloatArray] = field(default_factory=dict)
    spilt: Mapping[str, FloatArray] = field(default_factory=dict)
    buffers: Mapping[str, BufferTrajectories] = field(default_factory=dict)
    bands: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    gravity: float = 9.81


def plant_trajectories(
    process: Process, time: FloatArray, values: Mapping[str, FloatArray]
) -> PlantTrajectories:
    """Return flows, heads, pumps that run and filling from the recorded signals of a run.

    Parameters
    ----------
    time : ndarray [n]
        Start of each sample [s].
    values : mapping
        Name to trajectory [n] in SI: every state, input and disturbance, and the memories and
        volumes spilt where the process has them. A memory that was not recorded stands as at
        first.
    """
    parameters = {signal.name: signal.initial for signal in process.parameters}
    flows = plant_flows(process, time, values)
    pumps = [element for element in process.elements if isinstance(element, Pump)]
    tanks = {element.name: element for element in process.elements if isinstance(element, Tank)}
    sensors = {element.name: element for element in process.elements if isinstance(element, Sensor)}
    pumped = {pump.name: _sum(flows, time, element=pump.name) for pump in pumps}
    return PlantTrajectories(
        pumped=pumped,
        running={pump.name: _running(pump, values, time) for pump in pumps},
        heads={
            pump.name: _head(pump, pumped[pump.name], values, parameters)
            for pump in pumps
            if pump.curve is not None
        },
        spilt={name: values[total] for name, total in process.spilt.items() if total in values},
        buffers={
            name: _buffer(tanks[sensors[name].tank], flows, values, time, parameters)
            for name in process.averaging
        },
        bands=process.bands,
        gravity=parameters.get("gravity", 9.81),
    )


def _sum(flows: list[tuple[FlowPath, FloatArray]], time: FloatArray, **ends: str) -> FloatArray:
    """Return the sum of the flows with these ends [m³/s]."""
    total = np.zeros(time.size)
    for path, rate in flows:
        if all(getattr(path, end) == name for end, name in ends.items()):
            total = total + rate
    return total


def _running(pump: Pump, values: Mapping[str, FloatArray], time: FloatArray) -> FloatArray:
    """Return whether a pump runs: its signal is above standstill, and no switch keeps it off."""
    standstill = pump.dead_band if pump.curve is None else pump.low
    runs = values[pump.name] > standstill
    for memory in pump.memories():
        state = values.get(memory.name, np.full(time.size, memory.initial)) > 0.5
        if memory.name == f"{pump.name}.runs":
            runs = runs & state
        elif memory.name == f"{pump.name}.tripped":
            runs = runs & ~state
    return np.where(np.isfinite(values[pump.name]), runs, np.nan)


def _head(
    pump: Pump,
    flow: FloatArray,
    values: Mapping[str, FloatArray],
    parameters: Mapping[str, float],
) -> FloatArray:
    """Return the static head above the liquid and the loss in the pipe [m]."""
    lifted = np.full(flow.size, parameters[f"{pump.name}.static_head"])
    if pump.suction is not None:
        lifted = lifted - values[f"{pump.source}.level"]
    return lifted + parameters[f"{pump.name}.pipe_loss"] * flow**2


def is_own_loss(path: FlowPath, tank: str) -> bool:
    """Return whether a flow is what a tank spills, leaks or evaporates, which averaging leaves out.

    Examples
    --------
    >>> is_own_loss(FlowPath("basin.overflow", "basin", ""), "basin")
    True
    >>> is_own_loss(FlowPath("outflow", "basin", ""), "basin")
    False
    """
    return path.element.startswith(f"{tank}.")


def _buffer(
    tank: Tank,
    flows: list[tuple[FlowPath, FloatArray]],
    values: Mapping[str, FloatArray],
    time: FloatArray,
    parameters: Mapping[str, float],
) -> BufferTrajectories:
    useful = [(path, rate) for path, rate in flows if not is_own_loss(path, tank.name)]
    sizes = [parameters[f"{tank.name}.{each.name}"] for each in tank.vessel.parameters()]
    filling = at_many_points(_filling(tank.vessel), [values[tank.level][None], sizes])
    return BufferTrajectories(
        inflow=_sum(useful, time, destination=tank.name),
        outflow=_sum(useful, time, source=tank.name),
        filling=filling[0],
    )


@lru_cache(maxsize=16)
def _filling(vessel: Vessel) -> ca.Function:
    """Return the function of level and sizes that is the volume over the capacity of a vessel.

    Every run of a study asks for it, and it is compiled once.
    """
    level, names = ca.SX.sym("level"), [each.name for each in vessel.parameters()]
    sizes = ca.SX.sym("sizes", len(names))
    volume = vessel.volume(level, {name: sizes[place] for place, name in enumerate(names)})
    return ca.Function("filling", [level, sizes], [volume / vessel.capacity])
