"""All scores of one run."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Protocol

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.scores.actuator_wear import reversals, travel
from clepsydra.scores.averaging import largest_rate_of_change, variance_ratio, volume_used
from clepsydra.scores.effort import noise_movement, peak_move, time_in_saturation, total_variation
from clepsydra.scores.generalised_squared_error import generalised_squared_error
from clepsydra.scores.integral_errors import (
    integral_absolute_error,
    integral_error,
    integral_squared_error,
)
from clepsydra.scores.load_response import peak_deviation, return_time
from clepsydra.scores.noisy_settling import settling_time_under_noise
from clepsydra.scores.offset import offset
from clepsydra.scores.plant import BufferTrajectories, PlantTrajectories
from clepsydra.scores.pumping import (
    energy_to_liquid,
    starts_per_hour,
    volume_pumped,
    volume_spilt,
)
from clepsydra.scores.step_response import overshoot, rise_time, settling_time
from clepsydra.scores.time_weighted_errors import (
    integral_time_absolute_error,
    integral_time_squared_error,
)
from clepsydra.scores.trajectory import FloatArray

#: Half the width of the band of settling and return, as a share of the setpoint step.
BAND = 0.05
#: The narrower band of the settling time.
NARROW_BAND = 0.02
_JOULES_PER_KILOWATT_HOUR = 3.6e6
_SECONDS_PER_HOUR = 3600.0


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
    *,
    measured: Mapping[str, FloatArray] | None = None,
    plant: PlantTrajectories | None = None,
    followed: Collection[str] | None = None,
    movable: Mapping[str, tuple[float, float]] | None = None,
    inner: Mapping[str, tuple[FloatArray, float, float]] | None = None,
) -> dict[str, float]:
    """Return every score of a run that its segments and its process allow.

    - ``iae[y]``, ``ise[y]``, ``itae[y]``, ``itse[y]``, ``iseg[y]``: over the whole run, time
      counting from the start of each segment, so that a late one weighs no more.
    - ``ie[y]``: the magnitudes of the integrals over all segments with a step, added up; over the
      whole run where there is none.
    - ``iae_setpoint[y]``, ``iae_load[y]``: over the segments of all setpoint steps, and of all
      load steps; the segment of noise is in neither.
    - ``overshoot[y]``, ``rise_time[y]``, ``settling_time[y]`` (5 %), ``settling_time_2[y]``,
      ``settling_time_noisy[y]``: the worst of the setpoint steps of y, up and down, where the
      controller follows the setpoint of y. The last one needs `measured`.
    - ``peak_deviation[y]``, ``return_time[y]``: the worst of all load steps. The band of the
      return is that of the settling time, 5 % of the largest setpoint step of y; in a run
      without one it is 5 % of the peak deviation.
    - ``offset[y]``: the worst of all segments with a step.
    - ``total_variation[u]``, ``peak_move[u]``, ``time_in_saturation[u]``: over the whole run; of
      an input with a finite range also ``travel[u]`` and ``reversals[u]``. Where a segment has
      nothing but noise, ``noise_movement[u]``.
    - ``time_at_setpoint_limit[m]`` of an inner loop of measurement m: over the whole run.
    - Of the plant: ``starts_per_hour[pump]``, ``volume_pumped[pump]``, ``energy[pump]`` where the
      pump has a curve, ``volume_spilt[tank]`` where the tank has a weir, and for averaging
      control ``outflow_rate[y]``, ``variance_ratio[y]`` and ``volume_used[y]`` during loads.

    A score that no segment asks for is left out, and so is one for which the process says too
    little. A response that never gets there, and any score of a signal with a value that is not
    finite, is infinite.

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
    measured : mapping, optional
        The names of the setpoints to what the controller got [n], with noise.
    plant : PlantTrajectories, optional
        What the run says of pumps and tanks, see `clepsydra.scores.plant`.
    followed : collection of str, optional
        The controlled variables whose setpoints the controller follows; all if omitted. A
        controller that starts and stops pumps at levels follows none.
    movable : mapping, optional
        Manipulated variable u to the limits between which the controller moves it, where these
        are narrower than `input_limits`: the time in saturation is that at them.
    inner : mapping, optional
        Measurement of an inner loop to its setpoint [n] and the limits of that.

    Returns
    -------
    dict
        "score[signal]" to value; `catalogue.SCORES` describes the scores.

    Raises
    ------
    InputError
        A setpoint has no output or measurement or an input no limits, a segment steps the
        setpoint of an unknown signal or holds fewer than two samples, or trajectories differ in
        length.

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
    if measured is not None:
        _require_same_names("measured", setpoints, measured)
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
        found = _integral_scores(time, setpoint, output, happened)
        steps = [s for s in happened if s.kind == "setpoint" and s.signal == name]
        follows = followed is None or name in followed
        if follows:
            found |= _worst(_step_scores(time, setpoint, output, segment) for segment in steps)
        if follows and measured is not None:
            seen = measured[name]
            noise = _noise_deviation(time, seen - output, happened)
            found |= _worst(_noisy_scores(time, setpoint, seen, s, noise) for s in steps)
        band = BAND * max((abs(segment.size) for segment in steps), default=0.0)
        loads = [segment for segment in happened if segment.kind == "load"]
        found |= _worst(_load_scores(time, setpoint, output, segment, band) for segment in loads)
        if not np.all(np.isfinite(output)):
            found = dict.fromkeys(found, float("inf"))
        scores |= {f"{score}[{name}]": value for score, value in found.items()}
    for name, held in inputs.items():
        found = _effort_scores(time, held, *input_limits[name])
        if movable is not None and name in movable:
            found["time_in_saturation"] = time_in_saturation(time, held, *movable[name])
        quiet = [_samples(time, s, with_stop=False) for s in happened if s.kind == "noise"]
        if quiet:
            found["noise_movement"] = max(noise_movement(time[at], held[at]) for at in quiet)
        scores |= {f"{score}[{name}]": value for score, value in found.items()}
    for name, (held, low, high) in (inner or {}).items():
        scores[f"time_at_setpoint_limit[{name}]"] = time_in_saturation(time, held, low, high)
    return scores | _plant_scores(time, plant or PlantTrajectories(), happened)


def _integral_scores(
    time: FloatArray, setpoint: FloatArray, output: FloatArray, segments: Sequence[ScoredSegment]
) -> dict[str, float]:
    stretches = [(s.kind, _samples(time, s)) for s in segments]
    starts = [time[samples.start] for _, samples in stretches]
    run = (time, setpoint, output)
    found = {
        "iae": integral_absolute_error(*run),
        "ise": integral_squared_error(*run),
        "itae": integral_time_absolute_error(*run, starts),
        "itse": integral_time_squared_error(*run, starts),
        "iseg": generalised_squared_error(*run),
    }
    responses = [(kind, _cut(run, cut)) for kind, cut in stretches if kind != "noise"]
    found["ie"] = sum(abs(integral_error(*r)) for _, r in responses or [("", run)])
    for kind in ("setpoint", "load"):
        of_kind = [response for found_kind, response in responses if found_kind == kind]
        if of_kind:
            found[f"iae_{kind}"] = sum(integral_absolute_error(*r) for r in of_kind)
    if responses:
        found["offset"] = max(abs(offset(*response)) for _, response in responses)
    return found


def _effort_scores(time: FloatArray, held: FloatArray, low: float, high: float) -> dict[str, float]:
    found = {
        "total_variation": total_variation(time, held),
        "peak_move": peak_move(time, held),
        "time_in_saturation": time_in_saturation(time, held, low, high),
    }
    if np.isfinite(high - low):
        found["travel"] = travel(time, held, low, high)
        found["reversals"] = reversals(time, held, low, high)
    return found


def _plant_scores(
    time: FloatArray, plant: PlantTrajectories, segments: Sequence[ScoredSegment]
) -> dict[str, float]:
    scores: dict[str, float] = {}
    for name, flow in plant.pumped.items():
        scores[f"volume_pumped[{name}]"] = volume_pumped(time, flow)
    for name, running in plant.running.items():
        scores[f"starts_per_hour[{name}]"] = starts_per_hour(time, running)
    for name, head in plant.heads.items():
        energy = energy_to_liquid(time, plant.pumped[name], head, plant.gravity)
        scores[f"energy[{name}]"] = energy / _JOULES_PER_KILOWATT_HOUR
    for name, total in plant.spilt.items():
        scores[f"volume_spilt[{name}]"] = volume_spilt(time, total)
    loads = [_samples(time, s, with_stop=False) for s in segments if s.kind == "load"]
    for name, buffer in plant.buffers.items() if loads else ():
        found = _averaging_scores(time, buffer, loads)
        scores |= {f"{score}[{name}]": value for score, value in found.items()}
    return scores


def _averaging_scores(
    time: FloatArray, buffer: BufferTrajectories, loads: Sequence[slice]
) -> dict[str, float]:
    rate = largest_rate_of_change(time, buffer.outflow, loads)
    found = {
        "outflow_rate": rate * _SECONDS_PER_HOUR**2,
        "volume_used": volume_used(time, buffer.filling, loads),
    }
    ratio = variance_ratio(time, buffer.inflow, buffer.outflow, loads)
    return found if ratio is None else found | {"variance_ratio": ratio}


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
        "settling_time_2": settling_time(*response, band=NARROW_BAND),
    }


def _noisy_scores(
    time: FloatArray,
    setpoint: FloatArray,
    seen: FloatArray,
    segment: ScoredSegment,
    deviation: float,
) -> dict[str, float]:
    samples = _samples(time, segment)
    target = float(setpoint[samples.start])
    response = (time[samples], seen[samples], target - segment.size, target)
    return {"settling_time_noisy": settling_time_under_noise(*response, deviation, band=BAND)}


def _noise_deviation(
    time: FloatArray, noise: FloatArray, segments: Sequence[ScoredSegment]
) -> float:
    """Return the standard deviation of what the measurement adds, where there is noise.

    A scenario may have its noise in a segment of its own; the steps are then judged by it.
    """
    noisy = [_samples(time, s, with_stop=False) for s in segments if s.kind == "noise"]
    parts = np.concatenate([noise[samples] for samples in noisy]) if noisy else noise
    return float(np.std(parts)) if np.all(np.isfinite(parts)) else 0.0


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


def _samples(time: FloatArray, segment: ScoredSegment, *, with_stop: bool = True) -> slice:
    """Return the samples of a segment, the one at its stop included unless asked otherwise.

    At the stop the output still is what this segment made of it: only inputs jump there.
    """
    # Start and stop were computed as products with the sampling period, time perhaps not.
    tolerance = 1e-6 * float(np.min(np.diff(time)))
    first = int(np.searchsorted(time, segment.start - tolerance))
    after = int(np.searchsorted(time, segment.stop + (tolerance if with_stop else -tolerance)))
    if after - first < (2 if with_stop else 1):
        raise InputError(
            "segments",
            f"{segment.kind} segment from {segment.start} s to {segment.stop} s",
            f"a segment of at least two samples within {time[0]} s to {time[-1]} s",
            "lengthen the segment or the run",
        )
    return slice(first, after)


def _cut(
    run: tuple[FloatArray, FloatArray, FloatArray], samples: slice
) -> tuple[FloatArray, FloatArray, FloatArray]:
    time, setpoint, output = run
    return time[samples], setpoint[samples], output[samples]


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
