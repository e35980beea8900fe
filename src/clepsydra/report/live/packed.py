"""Bytes and numbers as a page of text holds them: deflated, then in base 64."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def packed(content: bytes) -> str:
    """Return bytes as a page holds them.

    Examples
    --------
    >>> packed(bytes(1000))
    'eNpjYBgFo2AUDHcAAAPoAAE='
    """
    return base64.b64encode(zlib.compress(content, 9)).decode("ascii")


def packed_numbers(arrays: Iterable[ArrayLike]) -> str:
    """Return the numbers of arrays one after the other, in 64 bits with the low ones first."""
    flat = [np.asarray(each, dtype="<f8").ravel() for each in arrays]
    return packed(np.concatenate(flat).tobytes())


def column(values: np.ndarray) -> dict[str, Any]:
    """Return an input of a run [samples], or the one value that it has.

    Examples
    --------
    >>> column(np.array([2.0, 2.0]))
    {'constant': 2.0, 'packed': None}
    """
    first = float(values[0])
    # Zeros of both signs are equal, and not the same.
    same = np.all(values.view(np.int64) == np.float64(first).view(np.int64))
    return {"constant": first, "packed": None if same else packed_numbers([values])}
