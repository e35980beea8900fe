"""The sampled linear model of a process, its inputs held, exact also with dead time."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.dead_time import delay_dependencies, has_delay_in_loop
from clepsydra.linear.late_outputs import late_outputs
from clepsydra.linear.linear_model import InternalDelays, LinearModel
from clepsydra.linear.ways import in_any_steps

#: Times that differ by less than this share of the sampling period are one.
_SAME = 1e-9
#: The most numbers on their way that a sampled model holds.
MOST_STATES = 600


class SampledProcess(NamedTuple):
    """x(k+1) = held x(k) + moved u(k), y = shown x, whose first states are those of the process.

    Parameters
    ----------
    held : ndarray [N, N]
    moved : ndarray [N, m]
        With dead time the further states are what is on its way: earlier states, inputs and
        readings.
    shown : ndarray [q, N]
    """

    held: np.ndarray
    moved: np.ndarray
    shown: np.ndarray


@lru_cache(maxsize=16)
def sampled_process(model: LinearModel, period: float) -> SampledProcess:
    """Return the model from one sample to the next, with the inputs held between them.

    With dead time L behind a state, what is felt at time t left at t - L, when other inputs
    were held. So copies of the motion, one for every sum L of dead times along a way through
    the process, run side by side over the period, each from what its states were then and with
    the inputs of then, which change once within the period where L is no multiple of it (the
    modified z-transform in state space). Of an output that is told late the readings of each
    sample are on their way. Nothing is approximated.

    Parameters
    ----------
    model : LinearModel
        Without direct ways from inputs to outputs.
    period : float
        T [s]

    Raises
    ------
    NotApplicable
        A dead time stands in a loop, or an output shows it beside something else, or it is so
        many periods long that the model would have more than 600 states.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 2.

    Examples
    --------
    A tank with a time constant of 50 s, sampled each 50 s:

    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> sampled_process(tank, 50.0).held.round(6)
    array([[0.367879]])
    """
    if model.delays is None:
        return SampledProcess(*held_over(model.A, model.B, period), model.C)
    return _Cascade(model, period).sampled()


def sampled_states(model: LinearModel, period: float) -> list[tuple[str, float]]:
    """Return which signal each state of the sampled model is, and of how long ago [s].

    Parameters
    ----------
    model, period
        As for `sampled_process`.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> sampled_states(tank, 50.0)
    [('tank.level', 0.0)]
    """
    now = [(name, 0.0) for name in model.states]
    if model.delays is None:
        return now
    return now + _Cascade(model, period).on_the_way()


def held_over(A: np.ndarray, B: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the state and input matrices over one period with the input held.

    Examples
    --------
    >>> one = np.eye(1)
    >>> held_over(0.0 * one, one, 3.0)
    (array([[1.]]), array([[3.]]))
    """
    from scipy.linalg import expm

    n, m = B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = A, B
    whole = expm(block * period)
    return whole[:n, :n], whole[:n, n:]


class _Cascade:
    """The copies of a model at every sum of dead times, and the register of what they need."""

    def __init__(self, model: LinearModel, period: float) -> None:
        waits = f"dead times of {', '.join(f'{time:.6g}' for time in model.times)} s"
        model, ages = late_outputs(model)
        delays = model.delays or _none(model)
        if has_delay_in_loop(model):
            raise NotApplicable(
                f"{waits}, one of them in a loop, have no sampled model; judge it by simulation"
            )
        if np.any(delays.to_outputs != 0.0):
            raise NotApplicable(
                f"an output shows what comes out of {waits}; let a state stand before the output"
            )
        self.model, self.delays, self.period = model, delays, period
        self.lags = _sums_along_ways(delay_dependencies(model), delays.times, _SAME * period)
        # L = steps T + late, with 0 <= late < T.
        parts = [_whole_and_rest(lag, period) for lag in self.lags]
        self.steps, self.late = [k for k, _ in parts], [late for _, late in parts]
        self.told = {
            model.outputs.index(name): _whole_and_rest(age, period) for name, age in ages.items()
        }
        # The places of the states that something delayed depends on.
        fed = (delays.from_states != 0.0) @ in_any_steps(model.A != 0.0)
        part_late = [row for row, (_, late) in self.told.items() if late]
        self.kept = np.flatnonzero(fed.any(axis=0) | model.C[part_late].any(axis=0))
        self.latenesses = sorted({*self.late, *(late for _, late in self.told.values())})
        # The register holds x(kT - late), k steps back, for each lateness, and u.
        self.places: dict[tuple[float, int], slice] = {}
        n, m = model.B.shape
        stop = n
        for lateness in self.latenesses:
            longest = max(
                (k for k, of in zip(self.steps, self.late, strict=True) if of == lateness),
                default=0,
            )
            # x(kT - late) is made in the step before, so it is there with none back already.
            for back in range(0 if lateness else 1, longest + 1):
                self.places[lateness, back] = slice(stop, stop + len(self.kept))
                stop += len(self.kept)
        self.input_places: dict[int, slice] = {}
        for back in range(1, max(self.steps) + 2 if len(delays.times) else 1):
            self.input_places[back] = slice(stop, stop + m)
            stop += m
        # And of each output that is told late its readings, the newest first.
        self.reading_places: dict[int, range] = {}
        for row, (k, _) in self.told.items():
            self.reading_places[row] = range(stop, stop + k)
            stop += k
        self.size = stop
        if stop > MOST_STATES:
            raise NotApplicable(
                f"{waits} are too many sampling periods of {period:g} s; sample more slowly"
            )

    def on_the_way(self) -> list[tuple[str, float]]:
        """Return name and age of what the register holds, in its order."""
        states, inputs = self.model.states, self.model.inputs
        found = [
            (states[place], late + back * self.period)
            for late, back in self.places
            for place in self.kept
        ]
        found += [(name, back * self.period) for back in self.input_places for name in inputs]
        return found + [
            (self.model.outputs[row], self.told[row][1] + (back + 1) * self.period)
            for row, places in self.reading_places.items()
            for back in range(len(places))
        ]

    def sampled(self) -> SampledProcess:
        """Return the sampled model: register and held input to the next register."""
        n, m = self.model.B.shape
        size = self.size
        motion = self._motion()
        # Columns: the register now, then u(k).
        state = np.zeros((n * len(self.lags), size + m))
        for place, (k, late) in enumerate(zip(self.steps, self.late, strict=True)):
            rows = n * place + (np.arange(n) if k == 0 and late == 0.0 else self.kept)
            columns = slice(0, n) if k == 0 and late == 0.0 else self.places[late, k]
            state[rows, np.arange(columns.start, columns.stop)] = 1.0
        following = np.zeros((size, size + m))
        now, period = 0.0, self.period
        moments = sorted({*self.late, *(period - late for late in self.latenesses if late), period})
        for moment in moments:
            if moment - now > _SAME * period:
                middle = 0.5 * (now + moment)
                held = np.vstack([self._input(place, middle) for place in range(len(self.lags))])
                Phi, Gamma = held_over(*motion, moment - now)
                state = Phi @ state + Gamma @ held
                now = moment
            for late in self.latenesses:
                if late and abs(period - late - moment) <= _SAME * period:
                    following[self.places[late, 0]] = state[self.kept]
        following[:n] = state[:n]
        for (late, back), taken in self.places.items():
            if back == 1 and not late:
                following[taken, self.kept] = np.eye(len(self.kept))
            elif back:
                following[taken, self.places[late, back - 1]] = np.eye(len(self.kept))
        for back, taken in self.input_places.items():
            before = slice(size, size + m) if back == 1 else self.input_places[back - 1]
            following[taken, before] = np.eye(m)
        read = self._read()
        for row, places in self.reading_places.items():
            for back, place in enumerate(places):
                following[place] = read[row] if back == 0 else np.eye(size + m)[place - 1]
        shown = read[:, :size].copy()
        for row, places in self.reading_places.items():
            if places:
                shown[row] = np.eye(size)[places[-1]]
        return SampledProcess(following[:, :size], following[:, size:], shown)

    def _read(self) -> np.ndarray:
        """Return what every sensor reads, less than a sample ago, by register and u(k)."""
        C = self.model.C
        read = np.zeros((len(C), self.size + self.model.B.shape[1]))
        read[:, : C.shape[1]] = C
        for row, (_, late) in self.told.items():
            if late:
                read[row] = 0.0
                read[row, self.places[late, 0]] = C[row, self.kept]
        return read

    def _motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Return A and B of all copies side by side, driven by the inputs of each."""
        model, delays, count = self.model, self.delays, len(self.lags)
        n, m = model.B.shape
        A, B = np.zeros((n * count, n * count)), np.zeros((n * count, m * count))
        for place, lag in enumerate(self.lags):
            rows = slice(n * place, n * (place + 1))
            A[rows, rows] += model.A
            B[rows, m * place : m * (place + 1)] += model.B
            # z = w of τ before = from_states x + from_inputs u + through z, all of then.
            waiting = [(lag, delays.to_states)]
            while waiting:
                at, into = waiting.pop()
                for i in range(len(delays.times)):
                    column = into[:, [i]]
                    then = self._place(at + delays.times[i])
                    if then is None or not np.any(column):
                        continue
                    A[rows, n * then : n * (then + 1)] += column @ delays.from_states[[i]]
                    B[rows, m * then : m * (then + 1)] += column @ delays.from_inputs[[i]]
                    waiting.append((self.lags[then], column @ delays.through[[i]]))
        return A, B

    def _place(self, lag: float) -> int | None:
        near = _SAME * self.period
        return next((i for i, known in enumerate(self.lags) if abs(known - lag) <= near), None)

    def _input(self, place: int, moment: float) -> np.ndarray:
        """Return what a copy's inputs are at a moment within the period, by register and u(k)."""
        m = self.model.B.shape[1]
        back = self.steps[place] + (1 if moment < self.late[place] else 0)
        chosen = np.zeros((m, self.size + m))
        columns = slice(self.size, self.size + m) if back == 0 else self.input_places[back]
        chosen[:, columns] = np.eye(m)
        return chosen


def _whole_and_rest(time: float, period: float) -> tuple[int, float]:
    """Return the whole periods in a time, and what is left."""
    whole = int(np.floor(time / period + _SAME))
    rest = time - whole * period
    return whole, 0.0 if rest <= _SAME * period else rest


def _none(model: LinearModel) -> InternalDelays:
    """Return no delayed signals of a model."""
    n, m, k, q = (
        len(names) for names in (model.states, model.inputs, model.disturbances, model.outputs)
    )
    zeros = np.zeros
    return InternalDelays(
        zeros(0), zeros((n, 0)), zeros((0, n)), zeros((0, m)), zeros((0, k)), zeros((0, 0)),
        zeros((q, 0)),
    )  # fmt: skip


def _sums_along_ways(depends: np.ndarray, times: np.ndarray, near: float) -> list[float]:
    """Return zero and every sum of dead times along a way against the flow, rising."""
    found, waiting, seen = [0.0], [(float(t), i) for i, t in enumerate(times)], set()
    while waiting:
        lag, last = waiting.pop()
        key = (round(lag / near), last)
        if key in seen:
            continue
        seen.add(key)
        if all(abs(lag - known) > near for known in found):
            found.append(lag)
        waiting += [(lag + float(times[j]), int(j)) for j in np.flatnonzero(depends[last])]
    return sorted(found)
