"""Quantities as a caller gives them: text with a unit, or a number in the unit that people see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_signal, require_type
from clepsydra.base.errors import InputError
from clepsydra.base.units import to_si
from clepsydra.process.document import Document
from clepsydra.process.signal_values import check_in_range, read_value
from clepsydra.process.table_reader import TableReader

if TYPE_CHECKING:
    from clepsydra.base.signal import Signal

#: Text with a unit, "5 cm", "10 %" or "2 min", or a number in the display unit of its signal, the
#: one that tables show, and in seconds for a time.
Quantity = str | float


@dataclass(frozen=True)
class _Arguments(Document):
    """Arguments of a call, read as the table of a file is, but for its lines."""

    def place(self, *path: str) -> str:
        return ", ".join([self.file, *path])


def arguments(
    place: str, values: Mapping[str, Any], keys: tuple[str, ...] | None = None
) -> TableReader:
    """Return the arguments of a call as a table, which refuses what is wrong with them.

    Parameters
    ----------
    place : str
        What is called, for messages.
    values : mapping
    keys : tuple of str, optional
        Those that there are; any if left out.

    Examples
    --------
    >>> arguments("step of level_1", {"at": "2 min"}).quantity("at", "s", "a time", "give one")
    120.0
    """
    _check_names(place, values)
    return TableReader(_Arguments(place, dict(values), {}), (), keys)


def _check_names(place: str, values: Mapping[str, Any]) -> None:
    """Refuse a dictionary with a key that is no text, which no file could have."""
    for name, value in values.items():
        require_type(name, str, place, "names as text", 'write as in {"level_1": 1.0}')
        if isinstance(value, Mapping):
            _check_names(f"{place}, {name}", value)


def with_unit(value: Any, unit: str) -> Any:
    """Return a number with its unit as text, and anything else as it is.

    Examples
    --------
    >>> with_unit(5, "cm"), with_unit("5 mm", "cm")
    ('5.0 cm', '5 mm')
    """
    if isinstance(value, Real) and not isinstance(value, bool):
        return repr(float(value)) if unit == "1" else f"{float(value)!r} {unit}"
    return value


def read_signal(
    place: str, key: str, value: object, signal: Signal, what: str, *, change: bool = False
) -> float:
    """Return a value of a signal, or a change of it [SI].

    Percent of a signal that is not itself in percent are those of its range.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> read_signal("tank", "level", 12.0, Signal("level", "m", "cm"), "a level")
    0.12
    """
    table = arguments(place, {key: with_unit(value, signal.shown_unit)})
    remedy = "give text with a unit, or a number in that unit"
    return read_value(table, key, signal, what, remedy, change=change)


def check_within(
    place: str, key: str, signal: Signal, value: float, written: object, what: str
) -> None:
    """Refuse a value [SI] outside the range of its signal."""
    table = arguments(place, {key: with_unit(written, signal.shown_unit)})
    check_in_range(table, key, signal, value, what)


def read_time(place: str, key: str, value: object) -> float:
    """Return a time from zero on [s]; a number is in seconds.

    Examples
    --------
    >>> read_time("step", "at", "2 min"), read_time("step", "at", 30)
    (120.0, 30.0)
    """
    time = to_si(with_unit(value, "s"), "s", f"{place}, {key}")
    if time < 0.0:
        raise InputError(f"{place}, {key}", value, "a time from 0 s on", "give 0 s or more")
    return time


def read_values(
    place: str, given: Mapping[str, object], signals: Sequence[Signal], words: str
) -> dict[str, float]:
    """Return values of signals by name [SI]; the words say what they are, for a refusal."""
    return {
        name: read_signal(
            place, name, value, require_signal(place, name, signals, words), "a value"
        )
        for name, value in given.items()
    }
