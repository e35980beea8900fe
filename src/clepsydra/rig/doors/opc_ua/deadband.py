"""When a value is told to who watches it: by what has changed since it was told last."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clepsydra.rig.tag import Tag


class RefusedFilter(Exception):
    """A filter that a tag does not take.

    Parameters
    ----------
    code : str
        The name of the status code that says why.
    """

    def __init__(self, code: str) -> None:
        super().__init__(code)
        self.code = code


@dataclass(frozen=True)
class ChangeFilter:
    """What has to change before a value is told again (OPC 10000-4 1.05, 7.22.2).

    Parameters
    ----------
    values : bool
        Whether a value that changes is told; a status that changes always is.
    deadband : float
        By more than so much, from the value that was told last [the tag's unit]. It is not the
        value that was seen last: what drifts slowly is told too.

    Examples
    --------
    >>> told, filter_ = [], ChangeFilter(deadband=5.0)
    >>> for level in range(51):
    ...     if not told or filter_.passes((told[-1], 0), (float(level), 0)):
    ...         told.append(float(level))
    >>> told
    [0.0, 6.0, 12.0, 18.0, 24.0, 30.0, 36.0, 42.0, 48.0]
    """

    values: bool = True
    deadband: float = 0.0

    def passes(self, told: tuple[float | None, int], now: tuple[float | None, int]) -> bool:
        """Return whether a value with its status is told, after another one."""
        (before, status), (value, new) = told, now
        if status != new:
            return True
        if not self.values or before is None or value is None:
            return False
        if math.isnan(before) or math.isnan(value):
            return math.isnan(before) != math.isnan(value)
        return abs(value - before) > self.deadband


def change_filter(tag: Tag, trigger: int, kind: int, deadband: float) -> ChangeFilter:
    """Return the filter of a tag that a client asks for.

    Parameters
    ----------
    tag : Tag
    trigger : int
        0 for changes of the status alone.
    kind : int
        0 for no deadband, 1 for an absolute one, 2 for one in percent of the range
        (OPC 10000-8 1.04, 6.2).
    deadband : float

    Raises
    ------
    RefusedFilter
        A deadband of something that is no number, or in percent of no range.
    """
    values = trigger != 0
    if kind == 0:
        return ChangeFilter(values)
    if tag.signal.kind == "boolean" or kind not in (1, 2):
        raise RefusedFilter("BadMonitoredItemFilterUnsupported")
    if not (math.isfinite(deadband) and deadband >= 0.0):
        raise RefusedFilter("BadDeadbandFilterInvalid")
    if kind == 1:
        return ChangeFilter(values, deadband)
    if tag.signal.kind != "real" or not tag.signal.has_range:
        raise RefusedFilter("BadMonitoredItemFilterUnsupported")
    if deadband > 100.0:
        raise RefusedFilter("BadDeadbandFilterInvalid")
    return ChangeFilter(values, deadband / 100.0 * tag.signal.span)
