"""Scores that are added up while a loop runs, for batches that store no trajectories."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.engine.trajectories import Trajectories
from clepsydra.loop.plant_readings import buffer_flows
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.reader import inline
from clepsydra.scores.error_extremes import ERROR_EXTREMES
from clepsydra.scores.extreme_levels import EXTREME_LEVELS
from clepsydra.scores.marks import before, marks, per_step
from clepsydra.scores.sample import Held, Sample
from clepsydra.scores.score import SCORES, Of, Score
from clepsydra.scores.score_key import score_key

#: What a score may want of a scenario, in words.
_KINDS = {"setpoint": "setpoint step", "load": "load step", "noise": "stretch of noise"}


def running_scores() -> dict[str, Score]:
    """Return the scores that can be added up while a loop runs."""
    running = {key: score for key, score in SCORES.items() if score.is_running}
    return running | EXTREME_LEVELS | ERROR_EXTREMES


class RunningScores:
    """Some scores of a closed loop as states of its program.

    The integrand of each is that of its score of a stored run, so that its last value is the score
    that `clepsydra.scores.evaluate` finds on the trajectories of the same run, but for rounding.
    Errors are those of the true output, without noise.

    Parameters
    ----------
    process : Process
    names : tuple of str
        "iae[level_1]": any of `running_scores`, of a signal that it is of.

    Attributes
    ----------
    state : tuple of Signal
        The values of the last sample that scores need, then the scores so far.
    inputs : tuple of Signal
        What the scores must be told of the scenario, see `inputs_of`.

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

    def __init__(self, process: Process, names: tuple[str, ...]) -> None:
        self.process, self.names = process, names
        self._scores = {name: _score(name, process) for name in names}
        # The expressions need values by their names, and keep some from sample to sample.
        self._symbols: dict[str, ca.SX] = {}
        self._told: dict[str, Signal] = {}
        self._memory: dict[str, tuple[Signal, ca.SX]] = {}
        self._folds: dict[str, list[str]] = {}
        #: What each state of a fold is before its first sample.
        self.starts: dict[str, float] = {}
        following: dict[str, tuple[Signal, ca.SX]] = {}
        for name, (score, signal) in self._scores.items():
            following |= self._following(name, score, signal)
        self._needed = _leaves(following)
        kept: dict[str, tuple[Signal, ca.SX]] = {}
        while more := {n: m for n, m in self._memory.items() if n in self._needed - kept.keys()}:
            kept |= more
            self._needed |= _leaves(more)
        self._next = kept | following
        self.state = tuple(signal for signal, _ in self._next.values())
        self.inputs = tuple(told for name, told in self._told.items() if name in self._needed)

    def inputs_of(self, scenario: Scenario) -> dict[str, np.ndarray]:
        """Return the values of `inputs` in a scenario by name [samples].

        Raises
        ------
        InputError
            A score judges a kind of step that the scenario has not.
        """
        kinds = {part.kind for part in scenario.segments}
        for wanted in _KINDS:
            judges = [s.key for s, _ in self._scores.values() if s.wants == wanted]
            if judges and wanted not in kinds:
                raise InputError(
                    "running scores, scenario", Finding(f"no {_KINDS[wanted]}"),
                    f"one, for {' and '.join(dict.fromkeys(judges))}",
                    "give the scenario one, or choose other scores",
                )  # fmt: skip
        told = marks(scenario.time, scenario.segments)
        told["length"] = np.sign(told["length"]) * scenario.sampling_period  # not rounded
        given = {_mark(name): values for name, values in told.items()}
        for column, name in enumerate(self.process.controlled):
            given[_before(f"{name}.setpoint")] = before(scenario.setpoints[:, column])
            given[_mark("per_step", name)] = per_step(scenario.time, scenario.segments, name)
        return {signal.name: given[signal.name] for signal in self.inputs}

    @property
    def units(self) -> dict[str, str]:
        """The unit of each score."""
        unit = self.process.signal
        return {name: _unit(score, unit(y).unit) for name, (score, y) in self._scores.items()}

    def folds(self, name: str) -> list[str]:
        """Return the states that a score is made of, or is itself."""
        return self._folds[name]

    def joined(self, name: str, parts: Sequence[np.ndarray]) -> np.ndarray:
        """Return a score of some parts of a run from what its `folds` came to in each.

        Parameters
        ----------
        parts : sequence of ndarray [parts, scenarios]
            One for each of the folds.
        """
        score, _ = self._scores[name]
        whole = [score.fold.joined(rows) for rows in parts]
        values = np.array(score.finish(*whole) if score.finish else whole[0])
        values[~np.isfinite(values)] = np.inf
        return values

    def append(self, builder: BlockBuilder, value: Mapping[str, int]) -> list[int]:
        """Append a sample's share to a program and return the values of the next state.

        Parameters
        ----------
        builder : BlockBuilder
        value : mapping
            Value of each state, input, setpoint, true measurement, manipulated variable,
            disturbance, parameter and state of the process by name.
        """
        if not self.names:
            return []
        needed = {name: symbol for name, symbol in self._symbols.items() if name in self._needed}
        following = ca.vertcat(*(expression for _, expression in self._next.values()))
        function = ca.Function("scores", list(needed.values()), [following])
        return inline(builder, function, [value[name] for name in needed])

    def read(self, result: Trajectories) -> dict[str, np.ndarray]:
        """Return the scores of every scenario of a batch [scenarios].

        All scores are infinite where the run ended in a state that is not finite.
        """
        contents = [result.state(s.name) for s in self.process.motion.contents]
        broken = ~np.all(np.isfinite(contents), axis=0)
        found = {}
        for name, (score, _) in self._scores.items():
            folds = [result.state(part) for part in self._folds[name]]
            values = np.array(score.finish(*folds) if score.finish else folds[0])
            values[broken | ~np.isfinite(values)] = np.inf
            found[name] = values
        return found

    def _following(self, name: str, score: Score, signal: str) -> dict[str, tuple[Signal, ca.SX]]:
        """Return the states of a score, and what they are after a sample."""
        sample = self._sample(score.of, signal)
        unit = _unit(score, self.process.signal(signal).unit)
        values = score.values(sample)
        names = [name] if len(values) == 1 else [f"{name}.{i}" for i in range(len(values))]
        self._folds[name] = names
        found = {}
        for part, value in zip(names, values, strict=True):
            states = [part, f"{part}.segment"][: len(score.fold.start)]
            symbols = tuple(self._symbol(state) for state in states)
            following = score.fold.following(symbols, value, sample)
            for state, start, after in zip(states, score.fold.start, following, strict=True):
                found[state] = Signal(state, unit, initial=start), ca.SX(after)
                self.starts[state] = start
        return found

    def _sample(self, of: Of, name: str) -> Sample:
        now, unit = self._symbol(name), self.process.signal(name).unit
        period = self.process.sampling_period
        told = ("of_setpoint", "of_load", "of_step", "of_noise", "begins", "load")
        fields: dict[str, Any] = {mark: self._input(_mark(mark), "") for mark in told}
        fields |= {"period": period, "held": period, "length": self._length}
        fields["elapsed"] = self._input(_mark("elapsed"), "s")
        fields |= {"now": now, "before": self._last(_before(name), unit, now)}
        if of is Of.CONTROLLED:
            fields["setpoint"] = self._input(_before(f"{name}.setpoint"), unit)
            fields["next_setpoint"] = self._symbol(f"{name}.setpoint")
            fields["per_step"] = self._input(_mark("per_step", name), f"1/{unit}")
        if of is Of.BAND:
            fields["band"] = self.process.bands[name]
        if of is Of.AVERAGING:
            flows = buffer_flows(self.process, name, self._all_symbols())
            for end, flow in zip(("inflow", "outflow"), flows, strict=True):
                fields[end] = self._held_flow(f"{end}[{name}]", flow)
        return Sample(**fields)

    def _held_flow(self, name: str, flow: ca.SX) -> Held:
        """Return a flow, with its value before the load that acts kept from sample to sample."""
        last = self._last(_before(name), "m^3/s", flow)
        state = f"scores.base.{name}"
        begins = self._input(_mark("load_begins"), "")
        base = ca.if_else(begins, last, self._symbol(state))
        self._memory[state] = Signal(state, "m^3/s"), base
        return Held(last, flow, base)

    def _last(self, state: str, unit: str, now: ca.SX) -> ca.SX:
        """Return what a value was at the sample before; at the first sample what it is."""
        self._memory[state] = Signal(state, unit), now
        return ca.if_else(self._length > 0, self._symbol(state), now)

    @property
    def _length(self) -> ca.SX:
        return self._input(_mark("length"), "s")

    def _input(self, name: str, unit: str) -> ca.SX:
        """Return a number of the scenario; without a unit it is 0 or 1."""
        kind = Signal(name, unit) if unit else Signal(name, kind="boolean", low=0.0, high=1.0)
        self._told.setdefault(name, kind)
        return self._symbol(name)

    def _symbol(self, name: str) -> ca.SX:
        return self._symbols.setdefault(name, ca.SX.sym(name))

    def _all_symbols(self) -> dict[str, ca.SX]:
        process = self.process
        groups = (process.state, process.motion.memories, process.inputs, process.disturbances)
        signals = [signal for group in (*groups, process.parameters) for signal in group]
        return {signal.name: self._symbol(signal.name) for signal in signals}


def _score(name: str, process: Process) -> tuple[Score, str]:
    """Return the score of a name and the signal that it is of."""
    key, signal = score_key(name)
    score = running_scores().get(key)
    known = score.of.signals(process) if score else ()
    if score is None or not known:
        raise InputError(
            "running scores", name, f"one of {', '.join(running_scores())}", "choose one"
        )
    if signal not in known:
        raise InputError(
            "running scores", name, f"{key} of one of {', '.join(known)}",
            f"write it as {key}[{known[0]}]",
        )  # fmt: skip
    return score, signal


def _leaves(following: Mapping[str, tuple[Signal, ca.SX]]) -> set[str]:
    """Return the names of what expressions are made of."""
    return {leaf.name() for _, after in following.values() for leaf in ca.symvar(after)}


def _unit(score: Score, unit: str) -> str:
    """Return the unit of a score as a signal has it, "V^2 s"."""
    if score.unit:
        return score.unit
    parts = zip((unit, "s"), score.powers, strict=True)
    return " ".join(f"{word}^{power}" if power > 1 else word for word, power in parts if power)


def _before(name: str) -> str:
    return f"scores.before.{name}"


def _mark(field: str, signal: str = "") -> str:
    return f"scores.{field}.{signal}" if signal else f"scores.{field}"
