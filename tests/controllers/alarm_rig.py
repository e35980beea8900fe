"""Alarms of a process file run over a signal, scan by scan, by the law and by the engine."""

import numpy as np
from law_function import function_of
from written_plants import plant_of

from clepsydra.controllers.alarms.law import alarm_controller

PLANT = """
name = "watched"
sampling_period = "1 s"
controlled = ["level_1"]
[reservoirs.basin]
[tanks.tank_1]
area = "1 m^2"
height = "100 m"
[orifices.outlet_1]
source = "tank_1"
destination = "basin"
area = "1 cm^2"
[pumps.pump_1]
source = "basin"
destination = "tank_1"
gain = "1 l/(s V)"
range = ["0 V", "10 V"]
nominal = "2 V"
[sensors.level_1]
tank = "tank_1"
range = ["0 m", "100 m"]
[alarms.level_1]
"""


def watched(folder, alarms, *edits):
    """Return the plant with these alarms."""
    return plant_of(folder, PLANT + alarms, *edits)


def scanned(controller, level, step=1.0, **given):
    """Run the alarms over a level; return each of their outputs by name [scans]."""
    law = controller.law
    called = function_of(law)
    state = [controller.initial_state[entry.name] for entry in law.state]
    parameters = [controller.values[parameter.name] for parameter in law.parameters]
    columns = {"level_1.pv": level, "level_1.good": 1.0, "time_step": step} | given
    columns = {
        name: np.broadcast_to(np.asarray(c, float), len(level)) for name, c in columns.items()
    }
    rows = []
    for k in range(len(level)):
        inputs = [columns[s.name][k] if s.name in columns else s.initial for s in law.inputs]
        state, outputs, _ = called(state, inputs, parameters)
        rows.append(outputs)
    return {
        s.name: np.array(column)
        for s, column in zip(law.outputs, zip(*rows, strict=True), strict=True)
    }


def times_of(active, step=1.0):
    """Return when an alarm came and returned [s], one after the other."""
    return (np.flatnonzero(np.diff(active, prepend=0.0)) * step).tolist()


def alarms_of(folder, alarms, *edits):
    """Return the controller of these alarms of the plant."""
    return alarm_controller(watched(folder, alarms, *edits).process)
