"""A controller behind a plant shell, run scan by scan by its law's own function."""

from scan_rig import ScannedLaw

from clepsydra import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.shell import with_plant_shell

LEVEL = Signal("level_1", "V", low=0.0, high=16.0, initial=5.0)
PUMP = Signal("pump_1", "V", low=0.0, high=10.0, initial=3.0)


def one_loop(form=None, level=LEVEL, rate_limited=False, **values):
    """PI control of one level, at rest at 5 V and 3 V; 16 V of range are 16 mA."""
    law = multiloop_pid_law(
        1, form, measured=[level], manipulated=[PUMP], rate_limited=rate_limited
    )
    chosen = {parameter.name: parameter.initial for parameter in law.parameters}
    chosen |= {"proportional_gain_1": 2.0, "integral_time_1": 40.0, "tracking_time_1": 10.0}
    chosen |= {"derivative_time_1": 8.0, "derivative_filter_1": 5.0} | values
    chosen = {parameter.name: chosen[parameter.name] for parameter in law.parameters}
    state = {entry.name: entry.initial for entry in law.state}
    state |= {"integral_1": 3.0, "last_output_1": 3.0, "filtered_signal_1": 5.0}
    state = {
        entry.name: state[entry.name]
        for entry in law.state
        if entry.name.removeprefix("last_") not in chosen
    }
    return Controller(
        "PI, by hand", "multiloop PI", "By hand.", law, chosen, state, ("level_1",), ("level_1",),
        ("pump_1",),
    )  # fmt: skip


AT_REST = {"setpoint_1": 5.0, "measurement_1": 5.0, "manual_1": 3.0, "tracking_1": 3.0}


_shelled = {}


def shelled_loop(period, settings=None, **options):
    """That loop behind a shell, scan by scan, at rest."""
    key = repr((period, settings, sorted(options.items())))
    if key not in _shelled:
        _shelled[key] = with_plant_shell(one_loop(**options), period, settings)
    return ScannedLaw(_shelled[key], period, **AT_REST)
