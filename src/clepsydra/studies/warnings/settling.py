"""Warnings of controlled variables that are not at rest at the end of their setpoint steps."""

from __future__ import annotations

import math
from collections.abc import Mapping


def settling_warnings(times: Mapping[str, float]) -> tuple[str, ...]:
    """Return which controlled variables do not come to stay within 5 % of a setpoint step.

    Parameters
    ----------
    times : mapping
        Name to settling time [s]; infinite for one that does not settle.

    Examples
    --------
    >>> settling_warnings({"level_1": math.inf, "level_2": 20.0})
    ('level_1 does not settle within its setpoint step: the loop is too slow or rings; compare \
its trend.',)
    """
    return tuple(
        f"{name} does not settle within its setpoint step: the loop is too slow or rings; compare "
        "its trend."
        for name, time in times.items()
        if math.isinf(time)
    )
