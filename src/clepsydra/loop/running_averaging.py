"""Scores of averaging control that are added up while a loop runs."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.sensor import Sensor
from clepsydra.scores.plant import is_own_loss

AVERAGING_SCORES = ("outflow_rate", "variance_ratio")

# What the program is told of the scenario: whether a load acts in a sample, and begins there.
_ACTS, _BEGINS = "scores.load_acts", "scores.load_begins"
#: Flows of a tank whose values before the load are kept, with what they are summed up for.
_ENDS = ("inflow", "outflow")
_SECONDS_PER_HOUR = 3600.0


class RunningAveraging:
    """Outflow change and outflow variance of tanks that average, as states of a program.

    They follow the rule of `clepsydra.scores.averaging`: flows are held during a sample, and count
    while a load acts.

    Parameters
    ----------
    process : Process
    names : tuple of str
        Averaging measurements.

    Raises
    ------
    InputError
        What leaves or enters the tank of one comes out of a delay.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> averaging = RunningAveraging(load_process("equalisation-tank"), ("level",))
    >>> [signal.name for signal in averaging.state][:2]
    ['scores.inflow.now[level]', 'scores.inflow.before[level]']
    """

    def __init__(self, process: Process, names: tuple[str, ...]) -> None:
        self.process, self.names = process, names
        self._flows = {name: _buffer_flows(process, name) for name in names}

    @property
    def state(self) -> tuple[Signal, ...]:
        """Flows of the last sample, those before the load, and the sums of their squares."""
        found = []
        for name in self.names:
            for end in _ENDS:
                found += [
                    Signal(f"scores.{end}.now[{name}]", "m^3/s"),
                    Signal(f"scores.{end}.before[{name}]", "m^3/s"),
                    Signal(f"scores.{end}.squared[{name}]", "m^6/s^2"),
                ]
        return tuple(found)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        """What must be told of the scenario, see `inputs_of`."""
        if not self.names:
            return ()
        return tuple(Signal(name, kind="boolean", low=0.0, high=1.0) for name in (_ACTS, _BEGINS))

    @property
    def needed(self) -> tuple[str, ...]:
        """Names of the states, memories, inputs, disturbances and parameters that flows need."""
        if not self.names:
            return ()
        return tuple(signal.name for group in _groups(self.process) for signal in group)

    def inputs_of(self, scenario: Scenario) -> dict[str, np.ndarray]:
        """Return the values of `inputs` in a scenario by name [samples].

        Raises
        ------
        InputError
            No load acts in the scenario.
        """
        if not self.names:
            return {}
        period = scenario.sampling_period
        acts, begins = np.zeros(scenario.samples), np.zeros(scenario.samples)
        for part in scenario.segments:
            if part.kind == "load":
                start = round(part.start / period)
                acts[start : round(part.stop / period)] = 1.0
                begins[start] = 1.0
        if not begins.any():
            raise InputError(
                "running scores, scenario", "no load step",
                f"one, which {' and '.join(AVERAGING_SCORES)} judge",
                "give the scenario a step of an inflow, or choose other scores",
            )  # fmt: skip
        return {_ACTS: acts, _BEGINS: begins}

    def next_state(self, symbols: Mapping[str, ca.SX], counts: ca.SX) -> dict[str, ca.SX]:
        """Return the next values of `state` by name; `counts` is 0 in the first sample."""
        if not self.names:
            return {}
        groups = [
            ca.vertcat(*(symbols[signal.name] for signal in group))
            for group in _groups(self.process)
        ]
        found = {}
        for name in self.names:
            for end, flow in zip(_ENDS, self._flows[name](*groups), strict=True):
                now, before, squared = (
                    f"scores.{end}.{what}[{name}]" for what in ("now", "before", "squared")
                )
                last = ca.if_else(counts, symbols[now], flow)
                reference = ca.if_else(symbols[_BEGINS], last, symbols[before])
                change = flow - reference
                found[now], found[before] = flow, reference
                found[squared] = symbols[squared] + symbols[_ACTS] * (change * change)
        return found

    def score(
        self,
        score: str,
        name: str,
        so_far: ca.SX,
        symbols: Mapping[str, ca.SX],
        following: Mapping[str, ca.SX],
        counts: ca.SX,
        period: float,
    ) -> ca.SX:
        """Return the next value of a score of an averaging measurement."""
        if score == "variance_ratio":
            arrived, left = (following[f"scores.{end}.squared[{name}]"] for end in _ENDS)
            return ca.if_else(arrived > 0, left / arrived, 0)
        flow = f"scores.outflow.now[{name}]"
        rate = ca.fabs(following[flow] - symbols[flow]) * (_SECONDS_PER_HOUR**2 / period)
        return ca.fmax(so_far, symbols[_ACTS] * counts * rate)


def _groups(process: Process) -> tuple[tuple[Signal, ...], ...]:
    motion = process.motion
    return (
        process.state,
        motion.memories,
        process.inputs,
        process.disturbances,
        process.parameters,
    )


def _buffer_flows(process: Process, name: str) -> ca.Function:
    """Return (x, m, u, d, p) → what enters and what leaves the tank of a measurement [m³/s]."""
    motion = process.motion
    tank = next(e.tank for e in process.elements if isinstance(e, Sensor) and e.name == name)
    x, *held = (ca.SX.sym(f"a{place}", len(group)) for place, group in enumerate(_groups(process)))
    delayed = ca.SX.sym("z", len(motion.delays))
    flows = ca.vertsplit(motion.flows(motion.to_contents(x, held[-1]), delayed, *held))
    useful = [
        (path, flow)
        for path, flow in zip(motion.flow_paths, flows, strict=True)
        if not is_own_loss(path, tank)
    ]
    ends = ca.vertcat(
        sum((flow for path, flow in useful if path.destination == tank), ca.SX(0)),
        sum((flow for path, flow in useful if path.source == tank), ca.SX(0)),
    )
    if motion.delays and any(ca.which_depends(ends, delayed)):
        raise InputError(
            f"running scores, {name}", f"a flow of {tank} that comes out of a delay",
            f"{' and '.join(AVERAGING_SCORES)} of a tank without one",
            "choose other scores",
        )  # fmt: skip
    return ca.Function("buffer_flows", [x, *held], [ends[0], ends[1]])
