"""What happens in a plant beside its loops, in each sample, as expressions of its signals."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.reader import inline
from clepsydra.scores.plant import is_own_loss
from clepsydra.scores.plant_flows import forced_flow_names

#: What is read of a tank that averages, and of a forced flow that may break off.
INFLOW, OUTFLOW, FILLING, RUNNING = "inflow", "outflow", "filling", "running"


def plant_readings(process: Process) -> tuple[Signal, ...]:
    """Return what is read: flows and filling of tanks that average, forced flows as they run.

    None of a process with delays, where a flow may have come out of one.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [signal.name for signal in plant_readings(cl.load("equalisation-tank").process)]
    ['level.inflow', 'level.outflow', 'level.filling']
    """
    if process.motion.delays:
        return ()
    of_buffers = [
        Signal(path(name, part), unit)
        for name in process.averaging
        for part, unit in ((INFLOW, "m^3/s"), (OUTFLOW, "m^3/s"), (FILLING, "1"))
    ]
    running = [Signal(path(name, RUNNING), "m^3/s") for name in sorted(forced_flow_names(process))]
    return (*of_buffers, *running)


def append_plant_readings(
    builder: BlockBuilder, process: Process, value: Mapping[str, int]
) -> list[int]:
    """Append what `plant_readings` names to a program, and return the values.

    Parameters
    ----------
    builder : BlockBuilder
    value : mapping
        Value of each state, memory, input, disturbance and parameter of the process by name.
    """
    if not plant_readings(process):
        return []
    groups = (process.state, process.motion.memories, process.inputs, process.disturbances)
    names = [each.name for group in (*groups, process.parameters) for each in group]
    symbols = {name: ca.SX.sym(name) for name in names}
    found: list[ca.SX] = []
    for name in process.averaging:
        found += [*buffer_flows(process, name, symbols), _filling(process, name, symbols)]
    flows = zip(process.motion.flow_paths, _flows(process, symbols, ca.SX(0, 1)), strict=True)
    running = {way.element: flow for way, flow in flows}
    found += [running[name] for name in sorted(forced_flow_names(process))]
    function = ca.Function("readings", list(symbols.values()), [ca.vertcat(*found)])
    return inline(builder, function, [value[name] for name in symbols])


def _flows(process: Process, value: Mapping[str, ca.SX], delayed: ca.SX) -> list[ca.SX]:
    motion = process.motion
    outside = (motion.memories, process.inputs, process.disturbances, process.parameters)
    x, *held = (
        ca.vertcat(*(value[signal.name] for signal in group)) for group in (process.state, *outside)
    )
    found: list[ca.SX] = ca.vertsplit(motion.flows(motion.to_contents(x, held[-1]), delayed, *held))
    return found


def buffer_flows(process: Process, name: str, value: Mapping[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
    """Return what enters and what leaves the tank of an averaging measurement [m³/s].

    What it spills, leaks or evaporates is left out, as in `clepsydra.scores.plant`.

    Parameters
    ----------
    process : Process
    name : str
        Of the measurement.
    value : mapping
        State, memory, input, disturbance and parameter of the process by name.

    Raises
    ------
    InputError
        One of these flows comes out of a delay.
    """
    motion, tank = process.motion, _tank_of(process, name).name
    delayed = ca.SX.sym("z", len(motion.delays))
    flows = _flows(process, value, delayed)
    useful = [
        (path, flow)
        for path, flow in zip(motion.flow_paths, flows, strict=True)
        if not is_own_loss(path, tank)
    ]
    inflow = sum((flow for path, flow in useful if path.destination == tank), ca.SX(0))
    outflow = sum((flow for path, flow in useful if path.source == tank), ca.SX(0))
    if motion.delays and any(ca.which_depends(ca.vertcat(inflow, outflow), delayed)):
        raise InputError(
            f"running scores, {name}", f"a flow of {tank} that comes out of a delay",
            "an averaging tank without one", "choose other scores",
        )  # fmt: skip
    return inflow, outflow


def _filling(process: Process, name: str, value: Mapping[str, ca.SX]) -> ca.SX:
    """Return volume over capacity of the tank of an averaging measurement [1]."""
    tank = _tank_of(process, name)
    vessel = tank.vessel
    sizes = {each.name: value[path(tank.name, each.name)] for each in vessel.parameters()}
    return vessel.volume(value[tank.level], sizes) / vessel.capacity


def _tank_of(process: Process, measurement: str) -> Tank:
    """Return the tank whose level a sensor shows."""
    sensor = next(e for e in process.elements if isinstance(e, Sensor) and e.name == measurement)
    return next(e for e in process.elements if isinstance(e, Tank) and e.name == sensor.tank)
