"""Arguments of a public function that are something else than it takes."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from numbers import Real
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.words import with_article


def is_finite_number(value: object) -> bool:
    """Tell whether a value is a finite real number; text and truth values are none."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond all floating-point numbers
        return False


def check_choice(
    place: str, value: object, known: Sequence[str], remedy: str = "correct the name"
) -> None:
    """Refuse what is none of the known names."""
    if value not in known:
        raise InputError(place, value, f"one of {', '.join(known)}", remedy)


def require_known(
    place: str,
    name: object,
    known: Collection[str],
    words: str = "",
    remedy: str = "choose one of them",
) -> None:
    """Refuse a name that is none of those that there are, with the nearest.

    Parameters
    ----------
    words : str
        What they are: "an input of the plant"; one of the names where that is not said.
    remedy : str
        What to do where none of them is close.

    Examples
    --------
    >>> require_known("step", "pmup", ["pump", "valve"], "an input")
    Traceback (most recent call last):
    clepsydra.base.errors.InputError: step: got 'pmup', expected an input (pump, valve); \
perhaps 'pump' was meant.
    """
    if isinstance(name, str) and name in known:
        return
    names = ", ".join(known)
    expected = f"{words} ({names or 'none'})" if words else f"one of {names}"
    raise InputError(place, str(name)[:60], expected, suggestion(name, known, remedy))


def require_signal(place: str, name: object, signals: Iterable[Signal], words: str) -> Signal:
    """Return a signal by its name; refuse one that there is not as `require_known` does."""
    known = {signal.name: signal for signal in signals}
    require_known(place, name, known, words)
    return known[str(name)]


def require_type(
    value: object, wanted: type | tuple[type, ...], place: str, expected: str, remedy: str
) -> None:
    """Refuse an argument of another type, in words.

    Parameters
    ----------
    value : object
        The argument.
    place : str
        The name of the argument.
    expected, remedy : str
        What it must be, and how to get one.

    Raises
    ------
    InputError
        The argument is of another type.

    Examples
    --------
    >>> require_type([1.0], str, "process", "a name", "give the name of a process")
    Traceback (most recent call last):
    clepsydra.base.errors.InputError: process: got 'a list', expected a name; \
give the name of a process.
    """
    if isinstance(value, wanted):
        return
    shown: object
    if value is None or isinstance(value, (bool, int, float)):
        shown = value
    elif isinstance(value, str):
        shown = value[:60]
    else:  # a whole result or an array would bury the message
        shown = with_article(type(value).__name__)
    raise InputError(place, shown, expected, remedy)


def sequence_of(
    value: Any, wanted: type | tuple[type, ...], place: str, expected: str, remedy: str
) -> tuple[Any, ...]:
    """Return a list or tuple of one type; refuse anything else, in words.

    Parameters
    ----------
    value : object
        The argument.
    wanted : type
        Of each entry.
    place, expected, remedy : str
        As for `require_type`.

    Raises
    ------
    InputError
        The argument is no list or tuple, or an entry is of another type.

    Examples
    --------
    >>> sequence_of(["level"], str, "names", "a list of names", "write as in [name]")
    ('level',)
    >>> sequence_of("level", str, "names", "a list of names", "write as in [name]")
    Traceback (most recent call last):
    clepsydra.base.errors.InputError: names: got 'level', expected a list of names; \
write as in [name].
    """
    require_type(value, (list, tuple), place, expected, remedy)
    for entry in value:
        require_type(entry, wanted, place, expected, remedy)
    return tuple(value)
