"""The state of a step law with which a loop starts at rest."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.program.step_law import StepLaw

#: So long lasts a scan that every filter comes to its end in [s].
_FOR_EVER = 1e15
_SCANS = 12


def state_at_rest(
    law: StepLaw, values: Mapping[str, float], inputs: Mapping[str, float]
) -> dict[str, float]:
    """Return the state of a law after it tracked the outputs of an operating point for ever.

    In tracking every memory of a law follows: integrals, filters, the setpoints of inner loops.
    So a few scans with a very long time step bring it to rest, whatever blocks it is made of.

    Parameters
    ----------
    law : StepLaw
    values : mapping
        Parameter name to value.
    inputs : mapping
        setpoint_j, measurement_j and tracking_i at the operating point, and what differs from
        its initial value of the other inputs.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> law = multiloop_pid_law(1)
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> state_at_rest(law, values, dict(setpoint_1=5.0, measurement_1=5.0, tracking_1=3.0))
    {'integral_1': 3.0, 'last_proportional_gain_1': 1.0, 'last_setpoint_weight_1': 1.0, \
'last_output_1': 3.0}
    """
    given = {signal.name: signal.initial for signal in law.inputs} | dict(inputs)
    given |= {name: float(Mode.TRACKING) for name in given if name.startswith("mode_")}
    given |= {"time_step": _FOR_EVER}
    state = np.array([entry.initial if isinstance(entry, Signal) else 0.0 for entry in law.state])
    for _ in range(_SCANS):
        following, _, _ = law.function(
            state,
            [given[signal.name] for signal in law.inputs],
            [values[parameter.name] for parameter in law.parameters],
        )
        state = np.array(following).ravel()
    return {entry.name: float(value) for entry, value in zip(law.state, state, strict=True)}
