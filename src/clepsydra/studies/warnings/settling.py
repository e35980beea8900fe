"""Warnings of controlled variables that are not at rest at the end of their setpoint steps."""

from __future__ import annotations

import math
from collections.abc import Mapping

_SCORE = "settling_time["


def settling_warnings(scores: Mapping[str, float]) -> tuple[str, ...]:
    """Return which controlled variables do not come to stay within 5 % of a setpoint step.

    Parameters
    ----------
    scores : mapping
        Score to value, "settling_time[level_1]"; infinite for one that does not settle.

    Examples
    --------
    >>> settling_warnings({"settling_time[level_1]": math.inf, "iae[level_1]": 2.0})
    ('level_1 does not settle within its setpoint step: the loop is too slow or rings; compare \
its trend.',)
    """
    return tuple(
        f"{key.removeprefix(_SCORE).removesuffix(']')} does not settle within its setpoint step: "
        "the loop is too slow or rings; compare its trend."
        for key, time in scores.items()
        if key.startswith(_SCORE) and math.isinf(time)
    )
