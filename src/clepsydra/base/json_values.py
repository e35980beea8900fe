"""Results as values that JSON knows."""

from __future__ import annotations

import math
from pathlib import PurePath
from typing import Any

import numpy as np


def json_values(value: Any) -> Any:
    """Return a result as dictionaries, lists and numbers.

    A complex number is {"re": …, "im": …}, a named tuple a dictionary, a path text. JSON
    knows neither infinity nor not-a-number: such numbers are None.

    Examples
    --------
    >>> json_values({"poles": np.array([-0.5 + 1j]), "times": np.array([2.0, np.inf])})
    {'poles': [{'re': -0.5, 'im': 1.0}], 'times': [2.0, None]}
    """
    if isinstance(value, np.ndarray):
        return json_values(value.tolist())
    if isinstance(value, PurePath):
        return str(value)
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, dict):
        return {str(key): json_values(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_values(entry) for entry in value]
    if isinstance(value, complex):
        both = math.isfinite(value.real) and math.isfinite(value.imag)
        return {"re": float(value.real), "im": float(value.imag)} if both else None
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
