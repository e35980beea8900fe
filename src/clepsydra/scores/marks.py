"""What happens when in a run, as numbers beside its samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.sample import Held, Sample
from clepsydra.scores.segment import Segment
from clepsydra.scores.trajectory import FloatArray, held_durations


def samples_of(time: FloatArray, segment: Segment, *, with_stop: bool = True) -> slice:
    """Return the samples of a segment, the one at its stop included unless asked otherwise.

    At the stop the output still is what this segment made of it: only inputs jump there.

    Raises
    ------
    InputError
        The run has less than two samples of it.
    """
    start, stop = segment.start, segment.stop
    first = int(np.searchsorted(time, start - _rounding(time, start)))
    beyond = _rounding(time, stop) if with_stop else -_rounding(time, stop)
    after = int(np.searchsorted(time, stop + beyond))
    if after - first < (2 if with_stop else 1):
        raise InputError(
            "segments",
            f"{segment.kind} segment from {segment.start} s to {segment.stop} s",
            f"a segment of at least two samples within {time[0]} s to {time[-1]} s",
            "lengthen the segment or the run",
        )
    return slice(first, after)


def _rounding(time: FloatArray, instant: float) -> float:
    """Return within which time of an instant a sample is the one at it [s].

    Start and stop were computed as products with the sampling period, time perhaps not.
    """
    next_sample = min(max(int(np.searchsorted(time, instant)), 1), time.size - 1)
    return 1e-6 * float(time[next_sample] - time[next_sample - 1])


def marks(time: FloatArray, segments: Sequence[Segment]) -> dict[str, FloatArray]:
    """Return the fields of `Sample` that are the same for all signals, and where loads begin [n].

    Time counts anew from the start of every segment, of noise too, so that a late step is judged
    like an early one.

    Raises
    ------
    InputError
        As `samples_of`.

    Examples
    --------
    >>> found = marks(np.arange(5.0), [Segment("setpoint", "y", start=1.0, stop=3.0, size=1.0)])
    >>> found["of_setpoint"].tolist(), found["elapsed"].tolist()
    ([0.0, 0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0, 2.0])
    """
    names = ("of_setpoint", "of_load", "of_step", "of_noise", "begins", "load", "load_begins")
    found = {name: np.zeros(time.size) for name in names}
    starts = []
    for segment in segments:
        samples = samples_of(time, segment)
        starts.append(time[samples.start])
        if segment.kind == "noise":
            after = samples_of(time, segment, with_stop=False).stop
            found["of_noise"][samples.start + 1 : after] = 1.0
            continue
        for name in (f"of_{segment.kind}", "of_step"):
            found[name][samples.start + 1 : samples.stop] = 1.0
        found["begins"][samples.start + 1] = 1.0
        if segment.kind == "load":
            acts = samples_of(time, segment, with_stop=False)
            found["load"][acts], found["load_begins"][acts.start] = 1.0, 1.0
    if not found["of_step"].any():
        found["of_step"][:] = 1.0
    return found | {"length": np.diff(time, prepend=time[0]), "elapsed": elapsed(time, starts)}


def elapsed(time: FloatArray, steps: ArrayLike) -> FloatArray:
    """Return the time from the last step, or from the first instant, to the start of each sample.

    In s, of the sample that ends at each instant [n]; 0 at the first. The steps are instants [s].
    """
    instants = np.sort(np.asarray(steps, dtype=np.float64).ravel())
    # The step of a sample may have been rounded to just after its start.
    tolerance = 1e-6 * float(np.min(np.diff(time)))
    begins = np.concatenate([[time[0]], instants[instants > time[0]]])
    last = np.searchsorted(begins, time + tolerance, side="right") - 1
    return before(np.maximum(time - begins[last], 0.0))


def per_step(time: FloatArray, segments: Sequence[Segment], signal: str) -> FloatArray:
    """Return 1 over the size of the setpoint step of a signal that each sample is judged by [n]."""
    found = np.zeros(time.size)
    for segment in segments:
        if (segment.kind, segment.signal) == ("setpoint", signal):
            samples = samples_of(time, segment)
            found[samples.start + 1 : samples.stop] = 1.0 / segment.size
    return found


def before(values: FloatArray) -> FloatArray:
    """Return the value one instant before; at the first one its own."""
    return np.concatenate([values[:1], values[:-1]])


def along(time: FloatArray, told: Mapping[str, FloatArray], **signals: FloatArray) -> Sample:
    """Return the samples of a stored run as one sample, the fields of which are arrays [n].

    Parameters
    ----------
    time : ndarray [n]
    told : mapping
        What is known of the scenario, see `marks` and `per_step`.
    **signals : ndarray [n]
        Fields at the start of each sample, as `now` and `next_setpoint`.

    Examples
    --------
    >>> along(np.array([0.0, 2.0, 5.0]), {}, now=np.array([3.0, 4.0, 6.0])).move.tolist()
    [0.0, 1.0, 2.0]
    """
    periods = np.diff(time)
    fields: dict[str, Any] = {
        "period": np.concatenate([periods[:1], periods]),
        "length": np.diff(time, prepend=time[0]),
        "held": held_durations(time),
        **told,
        **signals,
    }
    begins = np.flatnonzero(fields.pop("load_begins", ()))
    for now, earlier in (("now", "before"), ("next_setpoint", "setpoint")):
        if now in signals:
            fields[earlier] = before(signals[now])
    for name in {"inflow", "outflow", "running"} & signals.keys():
        values = signals[name]
        base = before(values)
        for start, stop in pairwise((*begins, time.size)):
            base[start:stop] = base[start]
        fields[name] = Held(before(values), values, base)
    return Sample(**fields)
