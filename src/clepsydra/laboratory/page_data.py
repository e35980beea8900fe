"""What the page of a laboratory carries to move a rig, as values for JSON."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from clepsydra import __version__
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import unit_text
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.engine.white_noise import stream_of
from clepsydra.laboratory.alarms_data import alarms_data
from clepsydra.laboratory.drawings import drawn
from clepsydra.laboratory.flows import flows_data
from clepsydra.laboratory.laws_data import laws_data
from clepsydra.laboratory.lessons.lesson import Lesson
from clepsydra.laboratory.lessons.lesson_data import lesson_data
from clepsydra.laboratory.limits import output_limits
from clepsydra.laboratory.rig import STARTS, Rig, Station
from clepsydra.laboratory.setups import Setup, setups, setups_of
from clepsydra.loop.rims import open_rims
from clepsydra.report.drawing.control_functions import control_functions
from clepsydra.report.live.modules import Modules
from clepsydra.report.quantities import display_factor, flow_unit

#: Of what stands here, and of a session; another one is refused.
FORM = 2
#: Of the noise.
SEED = 1


def page_data(rig: Rig, lesson: Lesson | None = None, *, answers: bool = False) -> dict[str, Any]:
    """Return all that the page needs beside its drawings.

    Parameters
    ----------
    lesson : Lesson, optional
        That the rig is of.
    answers : bool
        Whether the page is the lecturer's.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> data = page_data(Rig(plant.linear, [cl.design.simc(plant)]))
    >>> [loop["moves"] for loop in data["controllers"][0]["loops"]]
    [['pump_1'], ['pump_2']]
    """
    modules = Modules()
    controllers = [
        {**_controller(station, modules), "drawing": number}
        for station, number in zip(rig.stations, drawn(rig)[1], strict=True)
    ]
    found = {
        **plant_data(rig, modules),
        "digest": rig.digest,
        "setups": [asdict(setup) for setup in _setups(rig, lesson)],
        "lesson": None,
        "tanks": [asdict(tank) for tank in rig.tanks],
        "seed": SEED,
        "controllers": controllers,
        "laws": laws_data(rig.model, rig.controllers, rig.free, modules),
        "modules": modules.held,
    }
    if lesson is not None:
        found |= {
            "process": lesson.address,
            "name": lesson.file_stem,
            "lesson": lesson_data(lesson, answers=answers),
        }
    return found


def plant_data(rig: Rig, modules: Modules) -> dict[str, Any]:
    """Return what a page needs to show the plant of a rig, whoever moves it.

    Parameters
    ----------
    modules : Modules
        To which that of its flows is added.
    """
    process = rig.process
    measured = {signal.name for signal in process.measurements}
    return {
        "form": FORM,
        "version": __version__,
        "process": process.address,
        "name": process.file_stem,
        "period": process.sampling_period,
        "signals": [
            _shown(signal)
            for group in (process.state, process.measurements, process.inputs, process.disturbances)
            for signal in group
        ],
        "controlled": list(process.controlled),
        "measurements": [signal.name for signal in process.measurements],
        "inputs": [signal.name for signal in process.inputs],
        "disturbances": [signal.name for signal in rig.point.process.disturbances],
        "parameters": [
            {**_shown(signal), "value": signal.initial} for signal in process.parameters
        ],
        "noises": [
            {
                "input": path(name, "noise") if name in measured else name,
                "stream": stream_of(name),
                "deviation": deviation,
            }
            for name, deviation in rig.noises.items()
        ],
        "spills": _spills(rig),
        "levels": list(process.levels),
        "events": [
            {"count": each.counted, "words": each.words, "isHarm": bool(each.harm)}
            for each in process.motion.events
        ],
        "alarms": alarms_data(process),
        "flows": flows_data(
            # What hands pour is counted as the plant counts.
            rig.stations[0].loop.point,
            flow_unit(rig.point.process),
            modules,
        ),
    }


def seen_controller(station: Station) -> dict[str, Any]:
    """Return what a page needs to show a controller, which moves the plant elsewhere."""
    controller = station.controller
    return {
        "name": controller.name,
        "title": controller.title,
        "parameters": list(station.numbers.parameters.items()),
        "loops": _loops(station),
        "limits": output_limits(controller),
    }


def _setups(rig: Rig, lesson: Lesson | None) -> list[Setup]:
    if lesson is None:
        return setups(rig.point.process)
    return setups_of([(name, title, "", way) for name, (title, way) in lesson.ways.items()])


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
    program, own = station.program, station.numbers
    rings, of_process = rings_and_turns(program), set(station.process_rings)
    return {
        **seen_controller(station),
        "module": modules.add(program),
        "inputs": [[signal.name, own.at_rest[signal.name]] for signal in program.inputs],
        "outputs": [signal.name for signal in program.outputs],
        "states": list(own.starts["rest"].state),
        "rings": [
            {
                "name": ring.name,
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
                "state": list(own.starts[start].state.values()),
                "rings": [
                    value
                    for ring, _ in rings
                    for value in own.starts[start].rings[ring.name].tolist()
                ],
            }
            for start in STARTS
        },
        "cold": {
            "state": list(own.cold.state.values()),
            "rings": [value for ring in own.cold.rings.values() for value in ring.tolist()],
        },
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
    process = rig.process
    totals = {signal.name: signal for signal in process.motion.totals}
    spilling = {tank: totals[total] for tank, total in process.spilt.items()} | open_rims(process)
    return [
        {
            "tank": tank,
            "total": total.name,
            "factor": display_factor(total),
            "unit": unit_text(total.shown_unit),
        }
        for tank, total in spilling.items()
    ]
