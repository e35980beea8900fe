"""All scores of one run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.scores.effort import time_in_saturation, total_variation
from clepsydra.scores.integral_errors import integral_absolute_error, integral_squared_error
from clepsydra.scores.load_response import peak_deviation, return_time
from clepsydra.scores.step_response import overshoot, rise_time, settling_time
from clepsydra.scores.trajectory import FloatArray

#: Half the width of the band of settling and return, as a share of the setpoint step.
BAND = 0.05


class ScoredSegment(Protocol):
    """A stretch of a run in which one thing happens: what the scores need of it.

    Examples
    --------
    The segments of a scenario are such:

    >>> from types import SimpleNamespace
    >>> step = SimpleNamespace(kind="setpoint", signal="y", start=0.0, stop=4.0, size=1.0)
    >>> target, output = np.ones(6), np.array([0.0, 0.5, 1.0, 1.0, 1.0, 1.0])
    >>> scores = score_run(np.arange(6.0), {"y": target}, {"y": output}, {}, {}, [step])
    >>> scores["overshoot[y]"], scores["settling_time[y]"]  # within 5 % on the way from .5 to 1
    (0.0, 1.9)
    """

    @property
    def kind(self) -> str:
        """One of "setpoint", "load" and "noise"."""

    @property
    def signal(self) -> str:
        """The controlled variable or the disturbance that steps at the start."""

    @property
    def start(self) -> float:
        """[s]."""

    @property
    def stop(self) -> float:
        """[s]; a step at the stop belongs to the next segment."""

    @property
    def size(self) -> float:
        """Of the step, in the signal's unit."""


def score_run(
    time: FloatArray,
    setpoints: Mapping[str, FloatArray],
    outputs: Mapping[str, FloatArray],
    inputs: Mapping[str, FloatArray],
    input_limits: Mapping[str, tuple[float, float]],
    segments: Iterable[ScoredSegment],
) -> dict[str, float]:
    """Return every score of a run that its segments allow.

    - ``iae[y]`` and ``ise[y]``: over the whole run.
    - ``overshoot[y]``, ``rise_time[y]``, ``settling_time[y]``: the worst of the setpoint
      steps of y, up and down.
    - ``peak_deviation[y]``, ``return_time[y]``: the worst of all load steps. The band of the
      return is that of the settling time, 5 % of the largest setpoint step of y; in a run
      without one it is 5 % of the peak deviation.
    - ``total_variation[u]``, ``time_in_saturation[u]``: over the whole run.

    A score that no segment asks for is left out. A response that never gets there, and any
    score of a signal with a value that is not finite, is infinite.

    Parameters
    ----------
    time : ndarray [n]
        Start of each sample [s].
    setpoints : mapping
        Controlled variable y to its setpoint [n].
    outputs : mapping
        The same names to the true trajectory [n], without measurement noise.
    inputs : mapping
        Manipulated variable u to its trajectory [n], held during each sample.
    input_limits : mapping
        The same names to (low, high).
    segments : iterable of ScoredSegment
        What happened when.

    Returns
    -------
    dict
        "score[signal]" to value; `catalogue.SCORES` describes the scores.

    Raises
    ------
    InputError
        A setpoint has no output or an input no limits, a segment steps the setpoint of an
        unknown signal or holds fewer than two samples, or trajectories differ in length.

    Examples
    --------
    >>> scores = score_run(np.array([0.0, 1.0]), {"y": np.array([1.0, 1.0])},
    ...                    {"y": np.array([0.0, 1.0])}, {"u": np.array([2.0, 5.0])},
    ...                    {"u": (0.0, 5.0)}, [])
    >>> scores["iae[y]"], scores["total_variation[u]"], scores["time_in_saturation[u]"]
    (0.5, 3.0, 1.0)
    """
    _require_same_names("outputs", setpoints, outputs)
    _require_same_names("input_limits", inputs, input_limits)
    happened = tuple(segments)
    for segment in happened:
        if segment.kind == "setpoint" and segment.signal not in setpoints:
            raise InputError(
                "segments",
                segment.signal,
                f"one of the controlled variables {', '.join(setpoints)}",
                "name the controlled variable whose setpoint steps",
            )
    scores: dict[str, float] = {}
    for name, setpoint in setpoints.items():
        output = outputs[name]
        found = {
            "iae": integral_absolute_error(time, setpoint, output),
            "ise": integral_squared_error(time, setpoint, output),
        }
        steps = [s for s in happened if s.kind == "setpoint" and s.signal == name]
        found |= _worst(_step_scores(time, setpoint, output, segment) for segment in steps)
        band = BAND * max((abs(segment.size) for segment in steps), default=0.0)
        loads = [segment for segment in happened if segment.kind == "load"]
        found |= _worst(_load_scores(time, setpoint, output, segment, band) for segment in loads)
        scores |= {f"{score}[{name}]": value for score, value in found.items()}
    for name, held in inputs.items():
        scores[f"total_variation[{name}]"] = total_variation(time, held)
        scores[f"time_in_saturation[{name}]"] = time_in_saturation(time, held, *input_limits[name])
    return scores


def _step_scores(
    time: FloatArray, setpoint: FloatArray, output: FloatArray, segment: ScoredSegment
) -> dict[str, float]:
    samples = _samples(time, segment)
    target = float(setpoint[samples.start])
    response = (time[samples], output[samples], target - segment.size, target)
    return {
        "overshoot": overshoot(*response),
        "rise_time": rise_time(*response),
        "settling_time": settling_time(*response, band=BAND),
    }


def _load_scores(
    time: FloatArray,
    setpoint: FloatArray,
    output: FloatArray,
    segment: ScoredSegment,
    band: float,
) -> dict[str, float]:
    samples = _samples(time, segment)
    target = float(setpoint[samples.start])
    response = (time[samples], output[samples], target)
    peak = peak_deviation(*response)
    if peak == 0.0:
        return {"peak_deviation": 0.0, "return_time": 0.0}
    if not np.isfinite(peak):
        return {"peak_deviation": peak, "return_time": float("inf")}
    return {"peak_deviation": peak, "return_time": return_time(*response, band or BAND * peak)}


def _samples(time: FloatArray, segment: ScoredSegment) -> slice:
    """Return the samples of a segment, the one at its stop included.

    At the stop the output still is what this segment made of it: only inputs jump there.
    """
    # Start and stop were computed as products with the sampling period, time perhaps not.
    tolerance = 1e-6 * float(np.min(np.diff(time)))
    first = int(np.searchsorted(time, segment.start - tolerance))
    after = int(np.searchsorted(time, segment.stop + tolerance))
    if after - first < 2:
        raise InputError(
            "segments",
            f"{segment.kind} segment from {segment.start} s to {segment.stop} s",
            f"a segment of at least two samples within {time[0]} s to {time[-1]} s",
            "lengthen the segment or the run",
        )
    return slice(first, after)


def _worst(candidates: Iterable[dict[str, float]]) -> dict[str, float]:
    worst: dict[str, float] = {}
    for candidate in candidates:
        for score, value in candidate.items():
            worst[score] = max(value, worst.get(score, 0.0))
    return worst


def _require_same_names(
    place: str, wanted: Mapping[str, object], given: Mapping[str, object]
) -> None:
    if wanted.keys() != given.keys():
        raise InputError(
            place,
            ", ".join(given) or "nothing",
            f"exactly the signals {', '.join(wanted) or '(none)'}",
            "pass one entry for each signal",
        )
