"""A controller behind a plant shell, run scan by scan by its law's own function."""

import numpy as np
from law_function import by_path
from scan_rig import ScannedLaw

from clepsydra import Signal
from clepsydra.controllers.blocks import status
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.plant_shell.status import SHELL_STATUS_BITS

LEVEL = Signal("level_1", "V", low=0.0, high=16.0, initial=5.0)
PUMP = Signal("pump_1", "V", low=0.0, high=10.0, initial=3.0)


def one_loop(form=None, level=LEVEL, rate_limited=False, **values):
    """PI control of one level, at rest at 5 V and 3 V; 16 V of range are 16 mA."""
    law = multiloop_pid_law([level], [PUMP], form, rate_limited=rate_limited)
    chosen = {parameter.name: parameter.initial for parameter in law.parameters}
    chosen |= {
        "level_1.proportional_gain": 2.0,
        "level_1.integral_time": 40.0,
        "level_1.tracking_time": 10.0,
    }
    chosen |= {"level_1.derivative_time": 8.0, "level_1.derivative_filter": 5.0}
    chosen |= by_path(law.parameters, values)
    chosen = {parameter.name: chosen[parameter.name] for parameter in law.parameters}
    state = {entry.name: entry.initial for entry in law.state}
    state |= {"level_1.integral": 3.0, "pump_1.last_output": 3.0, "level_1.filtered_signal": 5.0}
    state = {
        entry.name: state[entry.name]
        for entry in law.state
        if entry.name.replace("last_", "") not in chosen
    }
    return Controller(
        "PI, by hand", "multiloop PI", "By hand.", law, chosen, state, ("level_1",), ("level_1",),
        ("pump_1",),
    )  # fmt: skip


def read_status(word):
    """The names of the bits of a shell's status word that are set."""
    return status.read_status(word, SHELL_STATUS_BITS)


AT_REST = {"level_1.sp": 5.0, "level_1.pv": 5.0, "pump_1.manual": 3.0, "pump_1.tracking": 3.0}


_shelled = {}


def shelled_loop(period, settings=None, **options):
    """That loop behind a shell, scan by scan, at rest."""
    key = repr((period, settings, sorted(options.items())))
    if key not in _shelled:
        _shelled[key] = with_plant_shell(one_loop(**options), period, settings)
    return ScannedLaw(_shelled[key], period, **AT_REST)


def scans(controller, count):
    """Random scans in which everything happens: starts, faults, modes, times that are none."""
    random = np.random.default_rng(4)
    period = controller.values["sampling_period"]
    found = {}
    for signal in controller.law.inputs:
        part = signal.part
        column = np.full(count, signal.initial)
        if part in ("pv", "sp", "manual", "tracking"):
            low, high = (end if np.isfinite(end) else 16.0 for end in (signal.low, signal.high))
            column = random.normal(0.5 * (low + high), 0.25 * abs(high - low), count)
            column[random.random(count) < 0.02] = np.nan
        elif part == "good":
            column = 1.0 * (random.random(count) < 0.95)
        elif part == "mode":
            column = np.repeat(random.choice([0.0, 1.0, 1.0, 2.0, 3.0], count // 20), 20)
        elif signal.name == "time_step":
            column = np.where(random.random(count) < 0.9, period, np.nan)
        elif signal.name == "start":
            column = random.choice([0.0, 1.0, 2.0], count, p=[0.94, 0.03, 0.03])
        elif signal.name == "acknowledge":
            column = 1.0 * (random.random(count) < 0.2)
        found[signal.name] = column
    return found
