"""Every flow of a plant along a trajectory, as it runs and not as it is asked for."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.engine.many_points import at_many_points
from clepsydra.process.elements.forced_flow import ForcedFlow
from clepsydra.process.motion import FlowPath
from clepsydra.process.process import Process
from clepsydra.scores.trajectory import FloatArray


def plant_flows(
    process: Process, time: FloatArray, values: Mapping[str, FloatArray]
) -> list[tuple[FlowPath, FloatArray]]:
    """Return every flow of the plant with its path.

    Parameters
    ----------
    time : ndarray [samples]
        [s]
    values : mapping
        States, inputs, disturbances and memories by name, SI; a memory that is missing stays as it
        is at first.
    """
    motion, parameters = process.motion, process.parameter_values

    def stacked(names: list[str]) -> FloatArray:
        return np.array([values[name] for name in names]).reshape(len(names), time.size)

    states = stacked([s.name for s in process.state])
    contents = at_many_points(motion.to_contents, [states, parameters])
    memories = np.array(
        [values.get(s.name, np.full(time.size, s.initial)) for s in motion.memories]
    )
    outside = [
        memories.reshape(len(motion.memories), time.size),
        stacked([s.name for s in process.inputs]),
        stacked([s.name for s in process.disturbances]),
        parameters,
    ]
    # What leaves a delay entered it earlier, and one delay may feed the next.
    delayed = np.zeros((len(motion.delays), time.size))
    for _ in motion.delays:
        sent = at_many_points(motion.rates, [contents, delayed, *outside], 1)
        delayed = np.array(
            [
                np.interp(time - delay.time, time, row)
                for delay, row in zip(motion.delays, sent, strict=True)
            ]
        )
    rates = at_many_points(motion.flows, [contents, delayed, *outside])
    return list(zip(motion.flow_paths, rates, strict=True))


def forced_flows(
    process: Process, time: FloatArray, values: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """Return the forced flows that may break off, as they run [m³/s].

    Their signal is the flow that is asked for, which is not there while the tank that it comes
    from is empty, or the one that it goes to is closed and full.

    Parameters
    ----------
    time : ndarray [samples]
    values : mapping
        As in `plant_flows`.
    """
    names = forced_flow_names(process)
    if not names:
        return {}
    flows = plant_flows(process, time, values)
    return {path.element: rate for path, rate in flows if path.element in names}


def forced_flow_names(process: Process) -> set[str]:
    """Return the forced flows that may break off."""
    refused = any(element.may_refuse for element in process.elements)
    forced = [element for element in process.elements if isinstance(element, ForcedFlow)]
    return {element.name for element in forced if refused or element.suction}
