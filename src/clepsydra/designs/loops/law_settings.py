"""The settings of a PID controller as the parameters of its law, whatever its form."""

from __future__ import annotations

import math

from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.loops.pid_settings import PidSettings, to_parallel, to_series

#: Derivative time over the time constant of its filter.
DERIVATIVE_FILTER = 10.0
#: Stands for an integral time that is infinite [s].
_NEVER = 1e9


def law_settings(settings: PidSettings, form: PidForm) -> dict[str, float]:
    """Return the settings in ISA form as parameters of a loop in any form, names without i.

    The derivative's filter has the time constant Td/10. The tracking time is Ti, or √(Ti Td)
    with derivative action.

    Parameters
    ----------
    place : str
        For the message.

    Raises
    ------
    InputError
        The series form is asked for, and Ti is below four times Td.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 3, for the tracking
    time.

    Examples
    --------
    >>> law_settings(PidSettings(2.5, 12.5, 2.0), PidForm("PID", "series"))["integral_time"]
    10.0
    """
    gain, integral_time, derivative_time = settings
    tracking = math.sqrt(integral_time * derivative_time) if derivative_time else integral_time
    tracking = min(tracking, _NEVER)
    if form.algorithm == "parallel":
        gain, integral_gain, derivative_gain = to_parallel(settings)
        return {
            "proportional_gain": gain,
            "integral_gain": integral_gain,
            "derivative_gain": derivative_gain,
            # Without derivative action the filter acts on nothing.
            "filter_time": derivative_time / DERIVATIVE_FILTER or 1.0,
            "tracking_time": tracking,
        }
    if form.algorithm == "series":
        gain, integral_time, derivative_time = to_series(settings)
    return {
        "proportional_gain": gain,
        "integral_time": min(integral_time, _NEVER),
        "derivative_time": derivative_time,
        "derivative_filter": DERIVATIVE_FILTER,
        "tracking_time": tracking,
    }
