"""What enters and what leaves a tank that averages, as expressions of the motion of its process."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.process.process import Process
from clepsydra.process.sensor import Sensor
from clepsydra.scores.plant import is_own_loss


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

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("equalisation-tank")
    >>> outside = (*process.inputs, *process.disturbances, *process.parameters)
    >>> signals = (*process.state, *process.motion.memories, *outside)
    >>> at_first = {signal.name: ca.SX(signal.initial) for signal in signals}
    >>> buffer_flows(process, "level", at_first | {"inflow": ca.SX(0.3)})[0]
    SX(0.3)
    """
    motion = process.motion
    tank = next(e.tank for e in process.elements if isinstance(e, Sensor) and e.name == name)
    outside = (motion.memories, process.inputs, process.disturbances, process.parameters)
    x, *held = (
        ca.vertcat(*(value[signal.name] for signal in group)) for group in (process.state, *outside)
    )
    delayed = ca.SX.sym("z", len(motion.delays))
    flows = ca.vertsplit(motion.flows(motion.to_contents(x, held[-1]), delayed, *held))
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
