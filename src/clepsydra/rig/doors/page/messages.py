"""What a page says to a rig: the touches of the laboratory's session, without their samples."""

from __future__ import annotations

import json
from collections.abc import Iterable

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.laboratory.touch import DriftTouch, InputTouch, NoiseTouch, touch_of
from clepsydra.rig.doors.page.cell import Cell
from clepsydra.rig.tag import DRIFT, NOISE

#: No touch is longer [bytes].
LONGEST = 1024
#: What a touch has, whichever it is.
_FIELDS = ({"input", "value"}, {"noise"}, {"drift", "rate"})


class Malformed(Exception):
    """A message that no page sends: its sender is let go."""


class NotTaken(Exception):
    """A touch that cannot be, with the reason for who made it."""


class Messages:
    """The messages of pages, each checked.

    Parameters
    ----------
    cells : iterable of Cell
        What they may set.

    Examples
    --------
    >>> messages = Messages([Cell("pump_1.mode", 0.0, 2.0, whole=True), Cell("level_1.drift")])
    >>> messages.read('{"input": "pump_1.mode", "value": 0}')
    ('pump_1.mode', 0.0)
    >>> messages.read('{"drift": "level_1", "rate": 0.001}')
    ('level_1.drift', 0.001)
    """

    def __init__(self, cells: Iterable[Cell]) -> None:
        self._cells = {cell.name: cell for cell in cells}

    def read(self, text: str) -> tuple[str, float]:
        """Return which cell a message sets, and to what [SI].

        Raises
        ------
        Malformed
            It is no touch.
        NotTaken
            It is one, of what a page may not set, or to what it may not.
        """
        name, value = _asked(text)
        cell = self._cells.get(name)
        if cell is None:
            raise NotTaken(f"a page does not set {name}")
        if doubt := cell.doubt(value):
            raise NotTaken(doubt)
        return name, value


def _asked(text: str) -> tuple[str, float]:
    try:
        found = json.loads(text, parse_int=float)
    except (ValueError, RecursionError):
        raise Malformed("that is no JSON") from None
    if not isinstance(found, dict) or set(found) not in _FIELDS:
        raise Malformed("that is no touch of a running plant")
    try:
        touch = touch_of({"sample": 0, **found}, "touch")
    except InputError as error:
        raise Malformed(f"{error.place}: expected {error.expected}") from None
    match touch:
        case InputTouch(input=name, value=value):
            return name, value
        case NoiseTouch(is_noisy=is_noisy):
            return NOISE, float(is_noisy)
        case DriftTouch(measurement=name, rate=rate):
            return path(name, DRIFT), rate
    raise Malformed("that is no touch of a running plant")
