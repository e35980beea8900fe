"""A controller run scan by scan by its law's own function."""

import numpy as np


class ScannedLaw:
    """Keeps state and inputs; `scan` changes some inputs and returns the outputs by name."""

    def __init__(self, controller, period):
        self.controller, self.law = controller, controller.law
        self.state = dict(controller.initial_state)
        self.inputs = {s.name: s.initial for s in self.law.inputs} | {"time_step": period}
        self.parameters = [controller.values[p.name] for p in self.law.parameters]

    def scan(self, **inputs):
        self.inputs |= inputs
        results = self.law.function(
            [self.state[entry.name] for entry in self.law.state],
            [self.inputs[signal.name] for signal in self.law.inputs],
            self.parameters,
        )
        groups = self.law.state, self.law.outputs, self.law.intermediates
        self.state, outputs, self.named = (
            dict(zip((e.name for e in group), np.array(values).ravel().tolist(), strict=True))
            for group, values in zip(groups, results, strict=True)
        )
        return outputs


def at_rest(controller, model):
    """Measurements and setpoints at the operating point."""
    at = model.point.as_dict()
    given = {f"measurement_{k}": at[n] for k, n in enumerate(controller.measurements, start=1)}
    return given | {f"setpoint_{j}": at[n] for j, n in enumerate(controller.setpoints, start=1)}
