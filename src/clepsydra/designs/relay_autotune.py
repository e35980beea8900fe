"""The ultimate point of a loop from the record of a relay experiment."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.designs.models.ultimate_point import UltimatePoint

PLACE = "relay experiment"
#: Cycles that are read, and how much they may differ.
CYCLES = 3
SPREAD = 0.05
_FEWEST = 8


class RelayExperiment(Protocol):
    """The record of a relay experiment, as `loop.relay_experiment` makes it.

    Examples
    --------
    See `ultimate_point_of_relay`.
    """

    @property
    def time(self) -> np.ndarray:
        """[s]"""

    @property
    def manipulated(self) -> np.ndarray:
        """[input unit]"""

    @property
    def measured(self) -> np.ndarray:
        """[output unit]"""

    @property
    def hysteresis(self) -> float:
        """ε [output unit]"""


def ultimate_point_of_relay(
    time: ArrayLike | RelayExperiment,
    manipulated: ArrayLike | None = None,
    measured: ArrayLike | None = None,
    *,
    hysteresis: float | None = None,
) -> UltimatePoint:
    """Return the ultimate gain and period from the last cycles under a relay with hysteresis.

    A relay of amplitude d and hysteresis ε that sees a sine of amplitude a has the describing
    function N(a) whose inverse is −1/N = −π/(4 d) (√(a² − ε²) + j ε), so::

        Ku = 4 d/(π √(a² − ε²)),   Tu the period

    which is approximate: the output is no sine. Without hysteresis the error is a few percent
    for elements of several lags and grows to 27 % for an element that is all delay, where the
    output is a square wave (Ku = 1/k, and the formula gives 4/(π k)). With hysteresis the
    point lies where the imaginary part of g is −π ε/(4 d), a little before the half turn.

    Parameters
    ----------
    time, manipulated, measured : array_like [n]
        Record of the experiment, the input held from each sample to the next. In the place of
        the three, the record that `relay_experiment` returns.
    hysteresis : float, optional
        ε, from the setpoint to a switching level [output unit]; that of the record, or none.

    Returns
    -------
    UltimatePoint
        The gain is positive where the relay raised the input for a low output.

    Raises
    ------
    InputError
        The input does not switch between two values, there are fewer than three full cycles,
        they differ by more than 5 %, or the output swings by no more than the hysteresis.

    References
    ----------
    K. J. Åström and T. Hägglund, Automatic tuning of simple regulators with specifications on
    phase and amplitude margins, Automatica 20(5), 1984, 645-651,
    doi 10.1016/0005-1098(84)90014-1.

    Examples
    --------
    A swing of amplitude 0.5 and period 4 s under a relay of amplitude 1:

    >>> time = np.arange(0.0, 40.0, 0.01)
    >>> output = -0.5 * np.sin(np.pi * time / 2.0)
    >>> found = ultimate_point_of_relay(time, np.where(output < 0.0, 1.0, -1.0), output)
    >>> round(found.gain, 4), round(found.period, 4)
    (2.5465, 4.0)
    """
    if manipulated is None and measured is None and hasattr(time, "manipulated"):
        record = cast(RelayExperiment, time)
        time, manipulated, measured = record.time, record.manipulated, record.measured
        hysteresis = record.hysteresis if hysteresis is None else hysteresis
    if manipulated is None or measured is None:
        given = "one argument" if measured is None and manipulated is None else "two arrays"
        expected = "the record of relay_experiment, or time, manipulated and measured"
        raise InputError(PLACE, given, expected, "give the record as it is, or all three arrays")
    time, manipulated, measured = _checked(cast(ArrayLike, time), manipulated, measured)
    hysteresis = 0.0 if hysteresis is None else hysteresis
    if not isinstance(hysteresis, (int, float)) or not 0.0 <= hysteresis < math.inf:
        remedy = "give it in the output's unit"
        raise InputError(f"{PLACE}, hysteresis", hysteresis, "a number from 0", remedy)
    low, high = float(np.min(manipulated)), float(np.max(manipulated))
    middle, longer = 0.5 * (low + high), "let the experiment last longer"
    rises = np.flatnonzero((manipulated[:-1] < middle) & (manipulated[1:] > middle)) + 1
    if len(rises) < CYCLES + 1:
        given = f"{max(len(rises) - 1, 0)} full cycles"
        raise InputError(f"{PLACE}, manipulated", given, f"at least {CYCLES}", longer)
    marks = rises[-(CYCLES + 1) :]
    read = slice(marks[0], marks[-1])
    if len(np.unique(manipulated[read])) > 2:
        place, given = f"{PLACE}, manipulated", "more than two values"
        raise InputError(place, given, "a relay", "record the relay alone")
    swings = np.array([0.5 * np.ptp(measured[a:b]) for a, b in pairwise(marks)])
    periods = np.diff(time[marks])
    for what, values in (("amplitudes", swings), ("periods", periods)):
        if np.ptp(values) > SPREAD * np.mean(values):
            given = ", ".join(f"{value:.3g}" for value in values)
            expected = f"cycles that differ by at most {SPREAD:.0%}"
            remedy = f"{longer}, or sample it faster"
            raise InputError(f"{PLACE}, {what}", given, expected, remedy)
    amplitude = float(np.mean(swings))
    if amplitude <= hysteresis:
        expected = f"a swing beyond the hysteresis of {hysteresis:.3g}"
        remedy = "reduce the hysteresis or enlarge the relay"
        raise InputError(f"{PLACE}, measured", f"a swing of {amplitude:.3g}", expected, remedy)
    size = 4.0 * 0.5 * (high - low) / (math.pi * math.sqrt(amplitude**2 - hysteresis**2))
    # The controller's sign is positive where the output starts low while the input is high.
    high_at = manipulated[read] > middle
    sign = 1.0 if measured[read][high_at][0] < measured[read][~high_at][0] else -1.0
    return UltimatePoint(math.copysign(size, sign), float(np.mean(periods)))


def _checked(
    time: ArrayLike, manipulated: ArrayLike, measured: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return three arrays of one length, finite, with rising time."""
    try:
        arrays = [np.asarray(values, float) for values in (time, manipulated, measured)]
    except (TypeError, ValueError):
        given, expected = "values that are no numbers", "three arrays of numbers"
        raise InputError(PLACE, given, expected, "convert them first") from None
    alike = len({each.size for each in arrays}) == 1 and all(each.ndim == 1 for each in arrays)
    if not alike or arrays[0].size < _FEWEST:
        given = f"{', '.join(str(each.size) for each in arrays)} samples"
        expected = f"three arrays of one length, at least {_FEWEST}"
        raise InputError(PLACE, given, expected, "record the three signals together")
    if not all(np.all(np.isfinite(each)) for each in arrays):
        raise InputError(PLACE, "values that are not finite", "finite numbers", "mend the gaps")
    if np.any(np.diff(arrays[0]) <= 0.0):
        raise InputError(f"{PLACE}, time", "a step back", "rising time", "sort the record")
    return arrays[0], arrays[1], arrays[2]
