"""What the page of a laboratory carries to move a rig, as values for JSON."""

from __future__ import annotations

import math
from typing import Any

from clepsydra import __version__
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import unit_text
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.engine.white_noise import stream_of
from clepsydra.laboratory.rig import STARTS, Rig, Station
from clepsydra.report.drawing.control_functions import control_functions
from clepsydra.report.live.modules import Modules
from clepsydra.report.quantities import display_factor

#: Of what stands here, and of a session; another one is refused.
FORM = 1
#: Of the noise.
SEED = 1


def page_data(rig: Rig) -> dict[str, Any]:
    """Return all that the page needs beside its drawings.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> data = page_data(Rig(plant.linear, [cl.design.simc(plant)]))
    >>> [loop["moves"] for loop in data["controllers"][0]["loops"]], len(data["modules"])
    ([['pump_1'], ['pump_2']], 1)
    """
    process, modules = rig.process, Modules()
    controllers = [_controller(station, modules) for station in rig.stations]
    return {
        "form": FORM,
        "version": __version__,
        "digest": rig.digest,
        "process": process.address,
        "name": process.file_stem,
        "period": process.sampling_period,
        "signals": [
            _shown(signal)
            for group in (process.state, process.measurements, process.inputs, process.disturbances)
            for signal in group
        ],
        "controlled": list(process.controlled),
        "inputs": [signal.name for signal in process.inputs],
        "disturbances": [signal.name for signal in process.disturbances],
        "seed": SEED,
        "noises": [
            {"input": path(name, "noise"), "stream": stream_of(name), "deviation": deviation}
            for name, deviation in rig.noises.items()
        ],
        "spills": _spills(rig),
        "controllers": controllers,
        "modules": modules.held,
    }


def _shown(signal: Signal) -> dict[str, Any]:
    low, high = (end if math.isfinite(end) else None for end in (signal.low, signal.high))
    return {
        "name": signal.name,
        "words": signal.description,
        "unit": unit_text(signal.shown_unit),
        "factor": display_factor(signal),
        "low": low,
        "high": high,
    }


def _controller(station: Station, modules: Modules) -> dict[str, Any]:
    program, controller = station.program, station.controller
    rings, of_process = rings_and_turns(program), set(station.process_rings)
    return {
        "name": controller.name,
        "title": controller.title,
        "module": modules.add(program),
        "inputs": [[signal.name, station.at_rest[signal.name]] for signal in program.inputs],
        "outputs": [signal.name for signal in program.outputs],
        "parameters": list(station.parameters.values()),
        "rings": [
            {
                "initial": 0.0,
                "length": ring.length,
                "turns": turns,
                "isOfProcess": ring.name in of_process,
            }
            for ring, turns in rings
        ],
        "moving": station.moving,
        "starts": {
            start: {
                "state": list(station.starts[start].state.values()),
                "rings": [
                    value
                    for ring, _ in rings
                    for value in station.starts[start].rings[ring.name].tolist()
                ],
            }
            for start in STARTS
        },
        "loops": _loops(station),
    }


def _loops(station: Station) -> list[dict[str, Any]]:
    """Return the faceplates: what is controlled together, and what moves it."""
    controller = station.controller
    loops: list[dict[str, Any]] = []
    functions = [each for each in control_functions(controller) if each.gives]
    moved = {name for each in functions for name in each.gives}
    if moved != set(controller.manipulated) or len(functions) == 1:
        # What is no loop of its own stands in one faceplate.
        return [{"controls": list(controller.setpoints), "moves": list(controller.manipulated)}]
    for each in functions:
        own = [name for name in controller.setpoints if name == each.at]
        loops.append({"controls": own, "moves": list(each.gives)})
    told = {name for loop in loops for name in loop["controls"]}
    rest = [name for name in controller.setpoints if name not in told]
    if rest:
        loops[0]["controls"] += rest
    return loops


def _spills(rig: Rig) -> list[dict[str, Any]]:
    totals = {signal.name: signal for signal in rig.process.motion.totals}
    return [
        {
            "tank": tank,
            "total": total,
            "factor": display_factor(totals[total]),
            "unit": unit_text(totals[total].shown_unit),
        }
        for tank, total in rig.process.spilt.items()
    ]
