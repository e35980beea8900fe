"""A recorded step of an input, and what the output did: checked, and counted from the step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError

#: The share of the record at its end over which an output at rest is averaged.
_END = 0.1
_FEWEST = 8
#: At rest, the mean of the last stretch and of the one before differ by at most this share.
_REST = 0.02


@dataclass(frozen=True, eq=False)
class StepRecord:
    """What an output did after a single step of its input.

    Parameters
    ----------
    since : ndarray [n]
        Time since the first sample with the new input [s].
    output : ndarray [n]
        From that sample on.
    before : ndarray [m]
        The output before it.
    step : float
        Change of the input.

    Examples
    --------
    >>> StepRecord(np.arange(3.0), np.zeros(3), np.array([2.0, 4.0]), 1.0).output_before
    3.0
    """

    since: np.ndarray
    output: np.ndarray
    before: np.ndarray
    step: float

    @property
    def output_before(self) -> float:
        """Mean of the output before the step."""
        return float(np.mean(self.before))

    def noise(self) -> float:
        """Return the standard deviation of the output before the step."""
        return float(np.std(self.before))

    def settled(self) -> float:
        """Return the value that the output comes to rest at, the mean of the last tenth.

        Raises
        ------
        InputError
            It is still moving.
        """
        count = max(2, int(_END * len(self.output)))
        last, before = self.output[-count:], self.output[-2 * count : -count]
        value = float(np.mean(last))
        moved = abs(value - float(np.mean(before)))
        spread = float(np.std(last)) / np.sqrt(count)
        if moved > _REST * abs(value - self.output_before) + 3.0 * spread:
            raise InputError(
                "step record, measured",
                f"a change of {moved:.3g} near the end",
                "an output that has come to rest",
                "record for longer, or take the method for integrating levels",
            )
        return value


def step_record(
    time: ArrayLike, manipulated: ArrayLike, measured: ArrayLike, place: str
) -> StepRecord:
    """Return a record from the step of its input on.

    Raises
    ------
    InputError
        The arrays are of different lengths, too short, not finite, the time does not rise, or
        the input does not step once.

    Examples
    --------
    >>> record = step_record(np.arange(20.0), [0.0] * 5 + [2.0] * 15, np.zeros(20), "by hand")
    >>> record.step, len(record.before), float(record.since[-1])
    (2.0, 5, 14.0)
    """
    time, manipulated, measured = checked_record(time, manipulated, measured, place)
    changes = np.flatnonzero(np.diff(manipulated) != 0.0)
    if len(changes) != 1:
        raise InputError(
            f"{place}, manipulated",
            f"{len(changes)} changes",
            "one step",
            "cut the record to one step, from some samples before it on",
        )
    at = int(changes[0]) + 1
    return StepRecord(
        since=time[at:] - time[at],
        output=measured[at:],
        before=measured[:at],
        step=float(manipulated[at] - manipulated[at - 1]),
    )


def checked_record(
    time: ArrayLike, manipulated: ArrayLike, measured: ArrayLike, place: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return three arrays of one length, finite, with rising time.

    Raises
    ------
    InputError

    Examples
    --------
    >>> checked_record([0, 1], [0, 1], [0, 1], "by hand")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: by hand: got '2, 2, 2 samples', expected three arrays of \
one length, at least 8; record the three signals together.
    """
    try:
        arrays = [np.asarray(values, float) for values in (time, manipulated, measured)]
    except (TypeError, ValueError):
        raise InputError(
            place, "values that are no numbers", "three arrays of numbers", "convert them first"
        ) from None
    if (
        any(a.ndim != 1 for a in arrays)
        or len({a.size for a in arrays}) > 1
        or (arrays[0].size < _FEWEST)
    ):
        sizes = ", ".join(str(a.size) for a in arrays)
        raise InputError(
            place,
            f"{sizes} samples",
            f"three arrays of one length, at least {_FEWEST}",
            "record the three signals together",
        )
    if not all(np.all(np.isfinite(a)) for a in arrays):
        raise InputError(place, "values that are not finite", "finite numbers", "mend the gaps")
    if np.any(np.diff(arrays[0]) <= 0.0):
        raise InputError(f"{place}, time", "a step back", "rising time", "sort the record")
    return arrays[0], arrays[1], arrays[2]
