"""Scores that are added up while a loop runs, for batches that store no trajectories."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.engine.trajectories import Trajectories
from clepsydra.loop.running_averaging import AVERAGING_SCORES, RunningAveraging
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.reader import inline
from clepsydra.scores.generalised_squared_error import WEIGHT

#: Beyond every level, so that the first one is the highest and the lowest so far.
_BEYOND = 1e300

# What the program is told of the scenario; "before" is the sample before.
_COUNTS = "scores.counts"
_LENGTH = "scores.length"
_ELAPSED = "scores.elapsed"


@dataclass(frozen=True)
class _Sample:
    """The sample that ends now, of one controlled measurement.

    The setpoint r was held during it while the output moved on a straight line, so that the
    error went from a to b.
    """

    a: ca.SX
    b: ca.SX
    step_of_setpoint: ca.SX
    elapsed: ca.SX
    period: float

    def absolute(self) -> ca.SX:
        """Mean of |e|."""
        p, q, both = ca.fabs(self.a), ca.fabs(self.b), self._both()
        return both / 2 - ca.if_else(self._crosses(), p * (q / both), 0)

    def squared(self) -> ca.SX:
        """Mean of e²."""
        a, b = self.a, self.b
        return (a * a + a * b + b * b) / 3

    def timed_absolute(self) -> ca.SX:
        """Mean of t |e|, t from the last step."""
        p, q, both = ca.fabs(self.a), ca.fabs(self.b), self._both()
        kept = p + 2 * q
        crossed = (p * p * p + 2 * q * q * q + 3 * p * q * q) / (both * both)
        return self.elapsed * self.absolute() + self.period / 6 * ca.if_else(
            self._crosses(), crossed, kept
        )

    def timed_squared(self) -> ca.SX:
        """Mean of t e², t from the last step."""
        a, b = self.a, self.b
        late = a * a + 2 * a * b + 3 * b * b
        return self.elapsed * self.squared() + self.period / 12 * late

    def generalised(self) -> ca.SX:
        """Mean of e² + a ė²: the rate from sample to sample, that of the setpoint included."""
        rate = (self.b + self.step_of_setpoint - self.a) / self.period
        return self.squared() + WEIGHT * rate * rate

    def _both(self) -> ca.SX:
        return ca.fabs(self.a) + ca.fabs(self.b)

    def _crosses(self) -> ca.SX:
        return self.a * self.b < 0


#: Scores of a controlled measurement that are integrals, with the power of its unit and of time.
_INTEGRALS: dict[str, tuple[Callable[[_Sample], ca.SX], int, int]] = {
    "ie": (lambda sample: (sample.a + sample.b) / 2, 1, 1),
    "iae": (_Sample.absolute, 1, 1),
    "ise": (_Sample.squared, 2, 1),
    "itae": (_Sample.timed_absolute, 1, 2),
    "itse": (_Sample.timed_squared, 2, 2),
    "iseg": (_Sample.generalised, 2, 1),
}
INTEGRAL_SCORES = tuple(_INTEGRALS)
RUNNING_SCORES = (
    *INTEGRAL_SCORES,
    "overshoot",
    "total_variation",
    "highest",
    "lowest",
    *AVERAGING_SCORES,
)


@dataclass(frozen=True)
class RunningScores:
    """Some scores of a closed loop as states of its program.

    They follow the rule of `clepsydra.scores`: the setpoint is held during a sample, the
    output moves on a straight line to its next value, and errors are those of the true output,
    without noise. Their last values therefore are those that `clepsydra.scores.evaluate` finds
    on the stored trajectories of the same run, but for rounding, except for three: IE is signed
    over the whole run, there the magnitudes of its segments are added; ITAE and ITSE go on
    through a segment of noise with the time since the last step, there they start again.

    Parameters
    ----------
    process : Process
    names : tuple of str
        "iae[level_1]": any of "ie", "iae", "ise", "itae", "itse", "iseg" and "overshoot" of a
        controlled measurement, "total_variation" of an input, "highest" and "lowest" of a
        tank's level, "outflow_rate" and "variance_ratio" of an averaging measurement while loads
        act. In ITAE and ITSE time counts from the last step; ISEG is
        ∫ e² + 0.5 ė² dt with the rate taken from sample to sample.

    Raises
    ------
    InputError
        A name is no such score, or of another signal; what an averaging tank gives comes out of
        a delay.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> scores = RunningScores(load_process("quadruple-tank"), ("iae[level_1]", "ise[level_1]"))
    >>> [signal.unit for signal in scores.state]
    ['V', 'V s', 'V^2 s']
    """

    process: Process
    names: tuple[str, ...]
    _averaging: RunningAveraging = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in self.names:
            score, signal = split_score(name)
            known = self._signals(score)
            if not known:
                raise InputError(
                    "running scores", name, f"one of {', '.join(RUNNING_SCORES)}", "choose one"
                )
            if signal not in known:
                raise InputError(
                    "running scores", name, f"{score} of one of {', '.join(known)}",
                    f"write it as {score}[{known[0]}]",
                )  # fmt: skip
        judged = [split_score(name) for name in self.names]
        averaged = tuple(dict.fromkeys(y for score, y in judged if score in AVERAGING_SCORES))
        object.__setattr__(self, "_averaging", RunningAveraging(self.process, averaged))

    def _signals(self, score: str) -> tuple[str, ...]:
        """Return the signals that a score may be of; none for what is no running score."""
        process = self.process
        if score in _INTEGRALS or score == "overshoot":
            return tuple(process.controlled)
        if score == "total_variation":
            return tuple(u.name for u in process.inputs)
        if score in AVERAGING_SCORES:
            return tuple(self.process.averaging)
        if score in ("highest", "lowest"):
            return tuple(x.name for x in process.state if x.name in process.levels)
        return ()

    @property
    def remembered(self) -> tuple[str, ...]:
        """Return the measurements and inputs whose last values are kept."""
        scores = [split_score(name) for name in self.names]
        return tuple(
            dict.fromkeys(
                signal
                for score, signal in scores
                if score in _INTEGRALS or score == "total_variation"
            )
        )

    @property
    def state(self) -> tuple[Signal, ...]:
        """The values of the last sample, what scores of flows sum up, then the scores so far."""
        process = self.process
        kept = [
            Signal(_before(name), process.signal(name).unit, description=f"{name} before")
            for name in self.remembered
        ]
        found = (self._score_signal(name) for name in self.names)
        return (*kept, *self._averaging.state, *found)

    def _score_signal(self, name: str) -> Signal:
        score, signal = split_score(name)
        unit = self.process.signal(signal).unit
        if score in _INTEGRALS:
            _, power, times = _INTEGRALS[score]
            squared, clock = ("", "^2")[power - 1], ("", "^2")[times - 1]
            return Signal(name, f"{unit}{squared} s{clock}")
        if score in AVERAGING_SCORES:
            return Signal(name, "1" if score == "variance_ratio" else "m^3/h^2")
        start = {"highest": -_BEYOND, "lowest": _BEYOND}.get(score, 0.0)
        return Signal(name, "%" if score == "overshoot" else unit, initial=start)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        """What the scores must be told of the scenario, see `inputs_of`."""
        process = self.process
        common = (
            Signal(_COUNTS, kind="boolean", low=0.0, high=1.0),
            Signal(_LENGTH, "s", low=0.0),
            Signal(_ELAPSED, "s", low=0.0),
        )
        own: list[Signal] = []
        for name in process.controlled:
            unit = process.signal(name).unit
            own.append(Signal(_before(f"{name}.setpoint"), unit))
            own += [Signal(entry, f"1/{unit}") for entry in (_step(name), _before(_step(name)))]
        return (*common, *own, *self._averaging.inputs)

    def inputs_of(self, scenario: Scenario) -> dict[str, np.ndarray]:
        """Return the values of `inputs` in a scenario by name [samples].

        Before the first sample nothing counts. The step of a setpoint is given as its inverse,
        zero where no step of this setpoint is judged.

        Raises
        ------
        InputError
            A score of averaging is asked for, and no load acts.
        """
        period, samples = scenario.sampling_period, scenario.samples
        counts = np.ones(samples)
        counts[0] = 0.0
        places = [
            (round(part.start / period), round(part.stop / period), part)
            for part in scenario.segments
        ]
        elapsed = np.arange(samples, dtype=float) * period
        for start, _, part in places:
            if part.kind != "noise":
                elapsed[start:] = np.arange(samples - start) * period
        given = {_COUNTS: counts, _LENGTH: period * counts, _ELAPSED: _shifted(elapsed)}
        for column, name in enumerate(self.process.controlled):
            inverse = np.zeros(samples)
            for start, stop, part in places:
                if part.kind == "setpoint" and part.signal == name:
                    inverse[start:stop] = 1.0 / part.size
            given[_before(f"{name}.setpoint")] = _shifted(scenario.setpoints[:, column])
            given[_step(name)] = inverse
            given[_before(_step(name))] = _shifted(inverse)
        return given | self._averaging.inputs_of(scenario)

    def append(self, builder: BlockBuilder, value: Mapping[str, int], period: float) -> list[int]:
        """Append a sample's share to a program and return the values of the next state.

        Parameters
        ----------
        builder : BlockBuilder
        value : mapping
            Value of each state, input, setpoint, true measurement, manipulated variable,
            disturbance, parameter and state of the process by name.
        period : float
            Sampling period [s].
        """
        if not self.names:
            return []
        signals = [split_score(name)[1] for name in self.names]
        setpoints = [f"{name}.setpoint" for name in self.process.controlled]
        names = list(
            dict.fromkeys(
                [
                    *(s.name for s in (*self.state, *self.inputs)),
                    *setpoints,
                    *signals,
                    *self._averaging.needed,
                ]
            )
        )
        symbols = {name: ca.SX.sym(f"v{place}") for place, name in enumerate(names)}
        flows = self._averaging.next_state(symbols, symbols[_COUNTS])
        following = [
            *(symbols[name] for name in self.remembered),
            *(flows[signal.name] for signal in self._averaging.state),
            *(self._next(name, symbols, flows, period) for name in self.names),
        ]
        function = ca.Function("scores", list(symbols.values()), [ca.vertcat(*following)])
        return inline(builder, function, [value[name] for name in names])

    def _next(
        self,
        name: str,
        symbols: Mapping[str, ca.SX],
        flows: Mapping[str, ca.SX],
        period: float,
    ) -> ca.SX:
        score, signal = split_score(name)
        so_far, now = symbols[name], symbols[signal]
        if score in AVERAGING_SCORES:
            return self._averaging.score(
                score, signal, so_far, symbols, flows, symbols[_COUNTS], period
            )
        if score in _INTEGRALS:
            held = symbols[_before(f"{signal}.setpoint")]
            sample = _Sample(
                a=held - symbols[_before(signal)],
                b=held - now,
                step_of_setpoint=symbols[f"{signal}.setpoint"] - held,
                elapsed=symbols[_ELAPSED],
                period=period,
            )
            return so_far + symbols[_LENGTH] * _INTEGRALS[score][0](sample)
        if score == "overshoot":
            # At the first sample of a segment its own step counts, at the last one still the same.
            first = (now - symbols[f"{signal}.setpoint"]) * symbols[_step(signal)]
            later = (now - symbols[_before(f"{signal}.setpoint")]) * symbols[_before(_step(signal))]
            return ca.fmax(so_far, 100 * ca.fmax(first, later))
        if score == "total_variation":
            return so_far + symbols[_COUNTS] * ca.fabs(now - symbols[_before(signal)])
        return ca.fmax(so_far, now) if score == "highest" else ca.fmin(so_far, now)

    def read(self, result: Trajectories) -> dict[str, np.ndarray]:
        """Return the scores of every scenario of a batch [scenarios].

        All scores are infinite where the run ended in a state that is not finite.
        """
        contents = [result.state(s.name) for s in self.process.motion.contents]
        broken = ~np.all(np.isfinite(contents), axis=0)
        found = {}
        for name in self.names:
            values = result.state(name).copy()
            values[broken | ~np.isfinite(values)] = np.inf
            found[name] = values
        return found


def split_score(name: str) -> tuple[str, str]:
    """Return score and signal of "score[signal]".

    Raises
    ------
    InputError

    Examples
    --------
    >>> split_score("iae[level_1]")
    ('iae', 'level_1')
    """
    score, bracket, rest = name.partition("[")
    if not bracket or not rest.endswith("]"):
        raise InputError("score", name, "a score of a signal", 'write it as in "iae[level_1]"')
    return score, rest[:-1]


def _before(name: str) -> str:
    return f"scores.before.{name}"


def _step(name: str) -> str:
    return f"scores.step.{name}"


def _shifted(values: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return what was given one sample before; the first sample has its own value."""
    array = np.asarray(values, dtype=float)
    return np.concatenate([array[:1], array[:-1]])
