"""What of a history is kept: for how long, or how much."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.errors import InputError
from clepsydra.base.units import split_quantity, to_si

#: Units of size [bytes].
_SIZES = {"kB": 1_000, "MB": 1_000_000, "GB": 1_000_000_000, "TB": 1_000_000_000_000}
#: Less is no history: an hour of a small plant takes more than this [bytes]; and this long [s].
_LEAST_SIZE, _LEAST_AGE = 1_000_000, 10.0


@dataclass(frozen=True)
class Retention:
    """What of a history is kept; without limits everything.

    Parameters
    ----------
    age : float, optional
        [s]
    size : int, optional
        Of the file [bytes].
    """

    age: float | None = None
    size: int | None = None


KEEP_ALL = Retention()


def read_retention(given: object) -> Retention:
    """Return what is to be kept, of a time or a size.

    Raises
    ------
    InputError
        It is neither, or too little.

    Examples
    --------
    >>> read_retention("7 d"), read_retention("500 MB")
    (Retention(age=604800.0, size=None), Retention(age=None, size=500000000))
    """
    place = "rig, keep"
    parts = split_quantity(given)
    if parts is not None and parts[1] in _SIZES:
        size = round(float(parts[0]) * _SIZES[parts[1]])
        if size < _LEAST_SIZE:
            raise InputError(place, given, "a size of at least 1 MB", "give more room")
        return Retention(size=size)
    age = to_si(given, "s", place)
    if age < _LEAST_AGE:
        raise InputError(place, given, "a time of at least 10 s", "give a longer one")
    return Retention(age=age)
