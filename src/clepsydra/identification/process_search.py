"""The search for physical parameters: simulations, their sensitivities, and least squares."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.identification.estimate import Estimate, around, by_logarithm
from clepsydra.identification.process_batch import ProcessBatch
from clepsydra.identification.record import Record
from clepsydra.process.process import Process

#: Half the distance of central differences in scaled unknowns.
_STEP = 1e-5
#: An unknown that moves the outputs by less of the largest such motion does not show.
_NO_TRACE = 1e-7
#: Unknowns whose effects differ by less than this share of their size are not told apart.
_ALIKE = 1e-5
#: Share of a sensor's range that it does not resolve.
_RESOLVED = 1e-5
_TOLERANCE = 1e-10


@dataclass(frozen=True)
class Unknown:
    """A number that is searched, scaled to about one."""

    signal: Signal
    start: float  # where the search begins [SI]
    scale: float | None  # what it is divided by; None where its logarithm is searched

    @property
    def guess(self) -> float:
        """Scaled, to begin with."""
        return 0.0 if self.scale is None else self.start / self.scale

    @property
    def bounds(self) -> tuple[float, float]:
        """Scaled, with room for central differences."""
        if self.scale is None:
            return -10.0, 10.0
        low, high = self.signal.low / self.scale, self.signal.high / self.scale
        return low + 2.0 * _STEP, high - 2.0 * _STEP

    def value(self, x: np.ndarray) -> np.ndarray:
        """Return what some scaled values stand for [SI]."""
        return self.start * np.exp(x) if self.scale is None else self.scale * x

    def estimate(self, x: np.ndarray, reach: np.ndarray) -> Estimate:
        """Return the estimate at a scaled value, with the half width of its interval."""
        value = float(self.value(x))
        if self.scale is None:
            return by_logarithm(self.signal, value, float(reach))
        return around(self.signal, value, float(self.scale * reach))


def _scale(signal: Signal, start: float) -> float:
    return signal.span if math.isfinite(signal.span) else max(abs(start), 1.0)


class ProcessSearch:
    """The search for parameters of a process and its state at the first row of a record.

    The unknowns are scaled: parameters above zero by their logarithm, fractions as they are,
    states by their range.
    """

    def __init__(self, process: Process, record: Record, parameters: Sequence[str]) -> None:
        self.record = record
        self.process = replace(process, sampling_period=record.period)
        self.count = record.held_back
        self.parameters = checked_parameters(process, parameters)
        columns = {signal.name for signal in record.signals}
        sources = (*process.inputs, *process.disturbances)
        outside = [s for s in sources if s.name in columns]
        self.outputs = [s for s in process.measurements if s.name in columns]
        for found, what, known, kind in (
            (outside, f"an input of {process.name}, which may stand still", sources, "signals"),
            (self.outputs, f"a measurement of {process.name}", process.measurements, "sensors"),
        ):
            if not found:
                raise InputError(
                    record.place,
                    f"columns {', '.join(s.name for s in record.signals)[:100]}",
                    f"{what} ({', '.join(s.name for s in known)})",
                    f"name the columns as the process file names its {kind}",
                )
        given = {s.name: np.asarray(record.values[s.name], float) for s in outside}
        self.notes = tuple(
            f"{s.name} is not in the record and stays at its nominal value"
            for s in process.inputs
            if s.name not in columns
        )
        #: Inputs and disturbances that move in the first two thirds.
        self.moving = [s for s in outside if np.ptp(given[s.name][: self.count]) > 0.0]
        if not self.moving:
            self.notes += (
                "no input moved: what is left of the measurements is held against none, so that "
                "its colour may be of dynamics that the file lacks",
            )
        for signal in self.outputs:
            ended = int(np.sum(np.asarray(record.values[signal.name]) >= signal.high))
            if ended:
                self.notes += (
                    f"{signal.name} stands at the end of its range in {ended} rows, where it shows "
                    "less than there is: cut the record before",
                )
        self.batch = ProcessBatch(self.process, given)
        measurements = [s.name for s in process.measurements]
        self.rows = [measurements.index(s.name) for s in self.outputs]
        self.measured = np.stack([np.asarray(record.values[s.name]) for s in self.outputs])
        # Below what any sensor resolves, a residual is as good as none.
        largest = np.max(np.abs(self.measured), axis=1)
        ranges = [s.span if math.isfinite(s.span) else 0.0 for s in self.outputs]
        self.smallest = _RESOLVED * np.maximum(np.maximum(ranges, largest), 1e-300)
        #: What brings residuals of the outputs to comparable size in the first round.
        self.spans = np.maximum(np.std(self.measured[:, : self.count], axis=1), self.smallest)
        self.states = list(range(len(process.state)))
        self.start = self._start()
        self._at: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None

    @property
    def unknowns(self) -> list[Unknown]:
        """What is searched: the parameters, then the states at the first row."""
        states, start = self.process.state, self.start
        return [
            *(Unknown(s, s.initial, None if is_positive(s) else 1.0) for s in self.parameters),
            *(Unknown(states[i], start[i], _scale(states[i], start[i])) for i in self.states),
        ]

    @property
    def guess(self) -> np.ndarray:
        """Scaled unknowns to begin with."""
        return np.array([unknown.guess for unknown in self.unknowns])

    def _start(self) -> np.ndarray:
        """Return the state at the first row: at rest there, but where a sensor shows it."""
        names = [s.name for s in self.process.state]
        shown_states = {self.process.measured_state[signal.name] for signal in self.outputs}
        start = np.array([signal.initial for signal in self.process.state])
        if shown_states != set(names):
            start = self.batch.rest()
        p = self.process.parameter_values
        for row, signal, values in zip(self.rows, self.outputs, self.measured, strict=True):
            place = names.index(self.process.measured_state[signal.name])
            span = self.process.state[place].span
            moved = start.copy()
            moved[place] += 0.01 * (span if math.isfinite(span) else 1.0)
            shown, further = (
                float(np.array(self.process.measure(x, p)).ravel()[row]) for x in (start, moved)
            )
            if further != shown:
                wanted = (float(values[0]) - shown) / (further - shown)
                start[place] += wanted * (moved[place] - start[place])
        low, high = (np.array([getattr(s, e) for s in self.process.state]) for e in ("low", "high"))
        spans = np.where(np.isfinite(high - low), high - low, 1.0)
        return np.clip(start, low + 1e-3 * spans, high - 1e-3 * spans)

    def simulated(self, lanes: np.ndarray, samples: int | None = None) -> np.ndarray:
        """Return the outputs [lanes, outputs, samples] at scaled unknowns [unknowns, lanes]."""
        count = len(self.parameters)
        found = [each.value(row) for each, row in zip(self.unknowns, lanes, strict=True)]
        values = {s.name: row for s, row in zip(self.parameters, found, strict=False)}
        start = np.tile(self.start[:, None], (1, lanes.shape[1]))
        start[self.states] = np.reshape(found[count:], (len(self.states), lanes.shape[1]))
        return np.asarray(self.batch.measured(values, start, samples)[:, self.rows])

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals [outputs, N] and slopes of the outputs [outputs, N, unknowns]."""
        if self._at is None or not np.array_equal(self._at[0], x):
            count = len(x)
            lanes = np.tile(x[:, None], (1, 2 * count + 1))
            lanes[np.arange(count), 1 + np.arange(count)] += _STEP
            lanes[np.arange(count), 1 + count + np.arange(count)] -= _STEP
            found = self.simulated(lanes, self.count)
            slopes = (found[1 : count + 1] - found[count + 1 :]) / (2.0 * _STEP)
            left = found[0] - self.measured[:, : self.count]
            self._at = (x.copy(), left, np.moveaxis(slopes, 0, -1))
        return self._at[1], self._at[2]

    def keep_those_with_trace(self) -> None:
        """Leave out states at the start that no output shows; refuse such parameters."""
        slopes = self.at(self.guess)[1] / self.spans[:, None, None]
        traces = np.linalg.norm(slopes.reshape(-1, slopes.shape[-1]), axis=0)
        count = len(self.parameters)
        for signal, trace in zip(self.parameters, traces, strict=False):
            if not trace > _NO_TRACE * traces.max():
                raise InputError(
                    f"parameters, {signal.name}", Finding(f"no trace in {self.record.place}"),
                    "a parameter that the recorded measurements depend on",
                    "leave it out, or record a measurement that it moves",
                )  # fmt: skip
        self.states = [
            place
            for place, trace in zip(self.states, traces[count:], strict=True)
            if trace > _NO_TRACE * traces.max()
        ]
        self._at = None

    def search(self, x: np.ndarray, sizes: np.ndarray) -> np.ndarray:
        """Return the unknowns of the least weighed squares, from some on."""
        from scipy.optimize import least_squares

        low, high = np.transpose([unknown.bounds for unknown in self.unknowns])
        found = least_squares(
            lambda x: (self.at(x)[0] / sizes[:, None]).ravel(),
            np.clip(x, low, high),
            jac=lambda x: (self.at(x)[1] / sizes[:, None, None]).reshape(-1, len(x)),
            bounds=(low, high), x_scale="jac", ftol=_TOLERANCE, xtol=_TOLERANCE, gtol=None,
        )  # fmt: skip
        return np.asarray(found.x)

    def check_apart(self, slopes: np.ndarray) -> None:
        """Refuse unknowns that move the outputs alike."""
        sizes = np.linalg.norm(slopes, axis=0)
        sizes[sizes == 0.0] = 1.0
        _, strengths, directions = np.linalg.svd(slopes / sizes, full_matrices=False)
        if strengths[-1] > _ALIKE * strengths[0]:
            return
        names = [s.name for s in self.parameters]
        names += [f"{self.process.state[place].name} at the start" for place in self.states]
        shares = np.abs(directions[-1])
        alike = [
            name for name, share in zip(names, shares, strict=True) if share > 0.1 * shares.max()
        ]
        raise InputError(
            "parameters",
            f"{' and '.join(alike)}, which move the measurements alike",
            "parameters that the record tells apart",
            "leave one of them out, or record another measurement",
        )


def is_positive(signal: Signal) -> bool:
    """Return whether a parameter is searched by its logarithm."""
    return signal.low == 0.0 and not math.isfinite(signal.high) and signal.initial > 0.0


def checked_parameters(process: Process, names: Sequence[str]) -> list[Signal]:
    """Return parameters of a process by their names, at least one and each once, or refuse them."""
    known = {signal.name: signal for signal in process.parameters}
    if not names:
        raise InputError(
            "parameters", Finding("none"), f"parameters of {process.name} ({', '.join(known)})",
            f"name those to fit, such as {next(iter(known))}",
        )  # fmt: skip
    found: list[Signal] = []
    for name in names:
        require_known("parameters", name, known, f"a parameter of {process.name}")
        if known[name] in found:
            raise InputError("parameters", name, "each parameter once", "leave one of them out")
        signal = known[name]
        if signal.low == 0.0 and signal.initial == 0.0 and not math.isfinite(signal.high):
            raise InputError(
                f"parameters, {name}", f"0 {signal.shown_unit}",
                "a number above 0 in the process file, from which the search can begin",
                "leave it out while it is plugged, or give about what it may be",
            )  # fmt: skip
        found.append(known[name])
    return found
