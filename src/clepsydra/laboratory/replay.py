"""A session of a laboratory run again: the same programs, the same touches, the same bits."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.controllers.blocks.status import Mode
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.white_noise import stream_of, white_noise
from clepsydra.laboratory.rig import Rig, Standing, Station
from clepsydra.laboratory.session import Session, Touch
from clepsydra.loop.closed_loop import loop_inputs, true_name
from clepsydra.process.process import Process
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.scored_run import ScoredRun


@dataclass(frozen=True)
class Replayed:
    """What a session did.

    Attributes
    ----------
    process : Process
    session : Session
    values : dict
        What the controller that had the rig recorded, and its setpoints, by name [samples, SI].
    state : dict
        State of the program of who had the rig at last to its value after the last sample.
    levels : dict
        State of the process to its value after the last sample [SI].
    scores : dict
        "score[signal]" to its value [SI].
    """

    process: Process
    session: Session
    values: dict[str, np.ndarray]
    state: dict[str, float]
    levels: dict[str, float]
    scores: dict[str, float]

    def as_dict(self) -> dict[str, Any]:
        """Return where it ended and its scores as values for JSON, in SI."""
        return {
            "process": self.session.process,
            "controllers": list(self.session.controllers),
            "samples": self.session.samples,
            "levels": self.levels,
            "scores": self.scores,
        }


def replayed(rig: Rig, session: Session, place: str) -> Replayed:
    """Run a session of a rig again.

    Parameters
    ----------
    place : str
        What messages call the session.

    Raises
    ------
    InputError
        The session is of another rig, or touches what this one does not have.
    """
    names = tuple(station.controller.name for station in rig.stations)
    if session.digest != rig.digest:
        raise InputError(
            f"{place}, digest", session.digest,
            f"{rig.digest}, that of {rig.process.name} under {', '.join(names)}",
            "give the process file and the controllers that the page was written with",
        )  # fmt: skip
    known = [signal.name for signal in loop_inputs(rig.process)]
    for number, touch in enumerate(session.touches):
        where = f"{place}, touches[{number}]"
        if touch.controller:
            require_known(f"{where}.controller", touch.controller, names)
        elif touch.input:
            require_known(f"{where}.input", touch.input, known)
    return _Replay(rig, session).run()


class _Replay:
    """The hands on a rig, sample by sample, between two takeovers at once."""

    def __init__(self, rig: Rig, session: Session) -> None:
        self.rig, self.session = rig, session
        self.stations = {station.controller.name: station for station in rig.stations}
        self.kernels = {
            name: Kernel(station.program, fuse=False) for name, station in self.stations.items()
        }
        self.standing = {
            name: station.starts[session.start] for name, station in self.stations.items()
        }
        self.inputs = _columns(rig, session)

    def run(self) -> Replayed:
        leading = self.rig.stations[0].controller.name
        parts: list[dict[str, np.ndarray]] = []
        chosen = [touch for touch in self.session.touches if touch.controller]
        cuts = [Touch(0, controller=leading), *chosen]
        ends = [*(touch.sample for touch in cuts), self.session.samples]
        for touch, (first, last) in zip(cuts, pairwise(ends), strict=True):
            self._take_over(leading, touch.controller)
            leading = touch.controller
            if last > first:
                parts.append(self._part(leading, first, last))
        values = {
            name: np.concatenate([part[name] for part in parts])
            for name in parts[0]
            if all(name in part for part in parts)
        }
        state = self.standing[leading].state
        return Replayed(
            self.rig.process, self.session, values, state,
            _levels(self.stations[leading], state), self._scores(values),
        )  # fmt: skip

    def _take_over(self, before: str, after: str) -> None:
        """Let a controller stand where another one has moved the process."""
        old, new, station = self.standing[before], self.standing[after], self.stations[after]
        own = [entry.name for entry in station.program.state[: station.moving]]
        rings = {name: old.rings[name] for name in station.process_rings}
        self.standing[after] = Standing(
            {**new.state, **{name: old.state[name] for name in own}}, {**new.rings, **rings}
        )

    def _part(self, leading: str, first: int, last: int) -> dict[str, np.ndarray]:
        given = {name: column[first:last] for name, column in self.inputs.items()}
        recorded = self._run(leading, given, last - first)
        by_hand = {}
        for u in self.rig.process.inputs:
            by_hand[f"{u.name}.mode"] = np.full(last - first, float(Mode.MANUAL))
            by_hand[f"{u.name}.manual"] = recorded[u.name]
        for name in self.stations:
            if name != leading:
                self._run(name, given | by_hand, last - first)
        setpoints = {f"{y}.setpoint": given[f"{y}.setpoint"] for y in self.rig.process.controlled}
        return recorded | setpoints

    def _run(self, name: str, given: dict[str, np.ndarray], samples: int) -> dict[str, np.ndarray]:
        station, stood = self.stations[name], self.standing[name]
        result = self.kernels[name].run(
            samples, inputs={**station.at_rest, **given}, parameters=station.parameters,
            state=stood.state, rings=stood.rings,
        )  # fmt: skip
        final = zip(stood.state, result.final_state[:, 0].tolist(), strict=True)
        rings = {ring: content[0] for ring, content in result.rings().items()}
        self.standing[name] = Standing(dict(final), {n: rings[n] for n in stood.rings})
        rows = np.ascontiguousarray(result.record_of(0).T)
        return dict(zip((each.name for each in station.program.outputs), rows, strict=True))

    def _scores(self, values: dict[str, np.ndarray]) -> dict[str, float]:
        process = self.rig.process
        time = np.arange(self.session.samples, dtype=np.float64) * process.sampling_period
        inputs = {u.name: values[u.name] for u in process.inputs}
        limits = {u.name: (u.low, u.high) for u in process.inputs}
        controlled = [process.signal(name) for name in process.controlled]
        run = ScoredRun(
            time, {y.name: values[f"{y.name}.setpoint"] for y in controlled},
            {y.name: values[true_name(y)] for y in controlled}, inputs, limits,
        )  # fmt: skip
        return score_run(run)


def _columns(rig: Rig, session: Session) -> dict[str, np.ndarray]:
    """Return the inputs of a rig as hands set them by name [samples]."""
    own = [signal.name for signal in loop_inputs(rig.process)]
    at_rest = rig.stations[0].at_rest
    given = {name: [(0, at_rest[name])] for name in own}
    for touch in session.touches:
        if touch.input:
            given[touch.input].append((touch.sample, touch.value))
    columns = {}
    for name, changes in given.items():
        samples, values = zip(*changes, strict=True)
        held = np.diff([*samples, session.samples])
        columns[name] = np.repeat(np.array(values), held)
    return columns | _noises(rig, session)


def _noises(rig: Rig, session: Session) -> dict[str, np.ndarray]:
    """Return the noise of each sensor [samples]: none where it is switched off."""
    noisy = np.zeros(session.samples, bool)
    for touch in session.touches:
        if touch.noise is not None:
            noisy[touch.sample :] = touch.noise
    return {
        path(name, "noise"): np.where(
            noisy,
            deviation * white_noise(session.seed, stream_of(name), 0, session.samples),
            0.0,
        )
        for name, deviation in rig.noises.items()
        if noisy.any()
    }


def _levels(station: Station, state: dict[str, float]) -> dict[str, float]:
    process = station.loop.process
    contents = [state[signal.name] for signal in process.motion.contents]
    found = np.array(process.motion.to_state(contents, process.parameter_values)).ravel()
    return dict(zip((x.name for x in process.state), found.tolist(), strict=True))
