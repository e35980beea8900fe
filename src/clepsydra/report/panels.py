"""Which panels a trend picture has: one signal each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.process.averaging import averaged_flows
from clepsydra.process.process import Process
from clepsydra.report.recording import recorded_inner_setpoints


@dataclass(frozen=True)
class Panel:
    """One panel: which signal it shows and how tall it is.

    Parameters
    ----------
    kind : {"level", "state", "input", "disturbance", "total"}
        "state" for a state that is no level.
    signal : Signal
    height : float
        [inch]
    measurement : str
        The sensor that shows a level, empty for none.
    controlled : bool
    beside : tuple of Signal
        In the same unit, to compare with: what arrives in a tank beside what leaves it.

    Examples
    --------
    >>> Panel("input", Signal("pump_1", "V", low=0.0, high=10.0), height=0.85).controlled
    False
    """

    kind: str
    signal: Signal
    height: float
    measurement: str = ""
    controlled: bool = False
    beside: tuple[Signal, ...] = ()


def controlled_panels(run: Run) -> list[Panel]:
    """Return one panel for each state that follows a setpoint.

    Before a level that averages comes what leaves its tank, which is to be smooth.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> [panel.signal.name for panel in controlled_panels(run)]
    ['tank_1.level', 'tank_2.level']
    """
    process = run.process
    shown = []
    for name in process.controlled:
        shown += _outflows(process, name) if name in process.averaging else []
        signal = process.signal(process.measured_state[name])
        shown.append(Panel(_kind(signal), signal, 1.3, name, True))
    return shown


def _outflows(process: Process, name: str) -> list[Panel]:
    """Return the panels of what moves the outflow of an averaging level, beside what arrives."""
    leaving, arriving = (
        [process.signal(each) for each in names] for names in averaged_flows(process, name)
    )
    return [
        Panel("input", signal, 1.3, beside=tuple(d for d in arriving if d.unit == signal.unit))
        for signal in leaving
    ]


def all_panels(run: Run | Simulation) -> list[Panel]:
    """Return the panels of a whole run: states, manipulated variables, disturbances that act.

    Volumes spilt are shown where something was spilt. What an inner loop measures has a panel
    too; the state of its sensor, where that has a lag, gives way to it.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> [panel.signal.name for panel in all_panels(run)][2:6]
    ['tank_3.level', 'tank_4.level', 'pump_1', 'pump_2']
    """
    process = run.process
    sensors = {state: name for name, state in reversed(process.measured_state.items())}
    controlled = [] if isinstance(run, Simulation) else controlled_panels(run)
    shown = {panel.signal.name for panel in controlled}
    height = 0.72 if controlled else 0.95
    others = [
        Panel(_kind(signal), signal, height, sensors.get(signal.name, ""))
        for signal in process.state
        if signal.name not in shown
    ]
    inner = [] if isinstance(run, Simulation) else recorded_inner_setpoints(run)
    for name in dict.fromkeys(each.measurement for each in inner):
        others = [panel for panel in others if panel.signal.name != f"{name}.lagged"]
        if all(panel.measurement != name for panel in (*controlled, *others)):
            others.append(Panel("state", process.signal(name), 0.85))
    inputs = [Panel("input", u, 0.85) for u in process.inputs if u.name not in shown]
    disturbances = [
        Panel("disturbance", signal, 0.45)
        for signal in process.disturbances
        if np.ptp(run.values[signal.name]) > 0.0
        and not any(signal in panel.beside for panel in controlled)
    ]
    totals = [
        Panel("total", signal, 0.45)
        for signal in process.motion.totals
        if signal.name in run.values and np.ptp(run.values[signal.name]) > 0.0
    ]
    return [*controlled, *others, *inputs, *disturbances, *totals]


def _kind(signal: Signal) -> str:
    return "level" if signal.name.endswith(".level") else "state"
