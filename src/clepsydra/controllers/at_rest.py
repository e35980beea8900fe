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
    law: StepLaw, values: Mapping[str, float], at: Mapping[str, float]
) -> dict[str, float]:
    """Return the state of a law after it tracked the outputs of an operating point for ever.

    In tracking every memory of a law follows: integrals, filters, the setpoints of inner loops.
    So a few scans with a very long time step bring it to rest, whatever blocks it is made of.

    Parameters
    ----------
    values : mapping
        Parameter name to value.
    at : mapping
        Of the operating point: inputs of the law by name, or process signals, of which each is
        the pv, sp and tracking that belong to it. Any other input has its initial value.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level"], ["pump"])
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> state_at_rest(law, values, {"level": 5.0, "pump": 3.0})
    {'level.integral': 3.0, 'level.last_proportional_gain': 1.0, 'level.last_setpoint_weight': \
1.0, 'pump.last_output': 3.0}
    """
    of_process = [signal for signal in law.inputs if signal.part in ("sp", "pv", "tracking")]
    given = {signal.name: signal.initial for signal in law.inputs}
    given |= {signal.name: at.get(signal.owner, signal.initial) for signal in of_process}
    given |= dict(at)
    given |= {s.name: float(Mode.TRACKING) for s in law.inputs if s.part == "mode"}
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
