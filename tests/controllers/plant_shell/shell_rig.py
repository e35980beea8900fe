"""A controller behind a plant shell, run scan by scan by its law's own function."""

from collections import deque

import numpy as np

from clepsydra import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.program.delay_ring import DelayRing


class Scans:
    """Keeps state, rings and inputs; `scan` changes some inputs and returns the outputs by name."""

    def __init__(self, controller, period, **inputs):
        self.controller, self.law = controller, controller.law
        self.state = dict(controller.initial_state)
        self.rings = {
            entry.name: deque([self.state[entry.name]] * entry.length)
            for entry in self.law.state
            if isinstance(entry, DelayRing)
        }
        self.values = dict(controller.values)
        self.inputs = {signal.name: signal.initial for signal in self.law.inputs}
        modes = [name for name in self.inputs if name.startswith(("mode_", "sensor_"))]
        self.inputs |= dict.fromkeys(modes, 1.0) | {"time_step": period} | inputs

    def scan(self, **inputs):
        assert set(inputs) <= set(self.inputs), sorted(set(inputs) - set(self.inputs))
        self.inputs |= inputs
        self.state |= {name: ring[0] for name, ring in self.rings.items()}
        results = self.law.function(
            [self.state[entry.name] for entry in self.law.state],
            [self.inputs[signal.name] for signal in self.law.inputs],
            [self.values[signal.name] for signal in self.law.parameters],
        )
        groups = self.law.state, self.law.outputs, self.law.intermediates
        following, outputs, self.named = (
            dict(zip((e.name for e in group), np.array(values).ravel().tolist(), strict=True))
            for group, values in zip(groups, results, strict=True)
        )
        for name, ring in self.rings.items():
            ring.popleft()
            ring.append(following[name])
        self.state = following
        return outputs

    def scans(self, count, **inputs):
        """Run some scans with the same inputs and return the outputs of the last."""
        for _ in range(count):
            outputs = self.scan(**inputs)
        return outputs


def at_rest(controller, model):
    """The inputs at the operating point, in automatic."""
    at = model.point.as_dict()
    given = {f"measurement_{k}": at[n] for k, n in enumerate(controller.measurements, start=1)}
    given |= {f"setpoint_{j}": at[n] for j, n in enumerate(controller.setpoints, start=1)}
    for i, name in enumerate(controller.manipulated, start=1):
        given |= {f"manual_{i}": at[name], f"tracking_{i}": at[name]}
    return given


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


def shelled_loop(period, settings=None, **options):
    """That loop behind a shell, scan by scan, at rest."""
    return Scans(with_plant_shell(one_loop(**options), period, settings), period, **AT_REST)
