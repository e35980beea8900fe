"""Controllers of plants, each designed once, run scan by scan by their laws' own functions."""

from collections import deque
from functools import cache

from law_function import by_path, function_of

import clepsydra as cl
from clepsydra.program.delay_ring import DelayRing
from clepsydra.studies.designs import DESIGNS

load = cache(cl.load)


@cache
def designed(name, process):
    """The controller of a design by its name in studies, and the plant that it is for."""
    plant = load(process)
    return DESIGNS[name](plant.analysis), plant


class ScannedLaw:
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
        ready = [signal.name for signal in self.law.inputs if signal.part in ("mode", "good")]
        self.inputs |= dict.fromkeys(ready, 1.0) | {"time_step": period}
        self.inputs |= by_path(self.law.inputs, inputs)

    def scan(self, **inputs):
        inputs = by_path(self.law.inputs, inputs)
        assert set(inputs) <= set(self.inputs), sorted(set(inputs) - set(self.inputs))
        self.inputs |= inputs
        self.state |= {name: ring[0] for name, ring in self.rings.items()}
        results = function_of(self.law)(
            [self.state[entry.name] for entry in self.law.state],
            [self.inputs[signal.name] for signal in self.law.inputs],
            [self.values[signal.name] for signal in self.law.parameters],
        )
        groups = self.law.state, self.law.outputs, self.law.intermediates
        following, outputs, self.named = (
            dict(zip((entry.name for entry in group), values, strict=True))
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


def at_rest(controller, plant):
    """Measurements, setpoints and what is set by hand at the operating point."""
    at = plant.point.as_dict()
    given = {f"{name}.pv": at[name] for name in controller.measurements}
    given |= {f"{name}.sp": at[name] for name in controller.setpoints}
    for name in controller.manipulated:
        given |= {f"{name}.manual": at[name], f"{name}.tracking": at[name]}
    return given
