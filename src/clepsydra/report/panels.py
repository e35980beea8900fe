"""Which panels a trend picture has: one signal each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run


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


def controlled_panels(run: Run) -> list[Panel]:
    """Return one panel for each state that follows a setpoint.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> [panel.signal.name for panel in controlled_panels(run)]
    ['tank_1.level', 'tank_2.level']
    """
    process = run.process
    shown = [(name, process.signal(process.measured_state[name])) for name in process.controlled]
    return [Panel(_kind(signal), signal, 1.3, name, True) for name, signal in shown]


def all_panels(run: Run | Simulation) -> list[Panel]:
    """Return the panels of a whole run: states, manipulated variables, disturbances that act.

    Volumes spilt are shown where something was spilt.

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
    inputs = [Panel("input", signal, 0.85) for signal in process.inputs]
    disturbances = [
        Panel("disturbance", signal, 0.45)
        for signal in process.disturbances
        if np.ptp(run.values[signal.name]) > 0.0
    ]
    totals = [
        Panel("total", signal, 0.45)
        for signal in process.motion.totals
        if signal.name in run.values and np.ptp(run.values[signal.name]) > 0.0
    ]
    return [*controlled, *others, *inputs, *disturbances, *totals]


def _kind(signal: Signal) -> str:
    return "level" if signal.name.endswith(".level") else "state"
