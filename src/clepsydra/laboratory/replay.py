"""A session of a laboratory run again: the same programs, the same touches, the same bits."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any

import numpy as np

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import InputError
from clepsydra.laboratory.input_columns import input_columns
from clepsydra.laboratory.player import Player, Stretch
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import Session
from clepsydra.laboratory.touch import (
    DriftTouch,
    InputTouch,
    ParameterTouch,
    SettingTouch,
    TakeoverTouch,
    Touch,
)
from clepsydra.loop.alarm_times import alarms_as_dict
from clepsydra.loop.closed_loop import true_name
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

    @property
    def samples(self) -> int:
        """How many sampling periods it lasts."""
        return self.session.samples

    @property
    def time(self) -> np.ndarray:
        """Start of each sample [s]."""
        return self.process.sampling_period * np.arange(self.samples, dtype=np.float64)

    def as_dict(self) -> dict[str, Any]:
        """Return where it ended and its scores as values for JSON, in SI."""
        return {
            "process": self.session.process,
            "controllers": list(self.session.controllers),
            "samples": self.session.samples,
            "levels": self.levels,
            "scores": self.scores,
            **alarms_as_dict(self),
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
            "give the process file and the controllers that the page was written with; if one of "
            "them was tuned on another machine, give the page too, --page FILE.html",
        )  # fmt: skip
    for number, touch in enumerate(session.touches):
        _check(touch, rig, f"{place}, touches[{number}]")
    return _Replay(rig, session).run()


def _check(touch: Touch, rig: Rig, place: str) -> None:
    """Refuse a touch of what the rig does not have."""
    stations = {station.controller.name: station for station in rig.stations}
    match touch:
        case InputTouch():
            require_known(f"{place}.input", touch.input, list(rig.inputs))
        case ParameterTouch():
            known = [signal.name for signal in rig.process.parameters]
            for name in touch.values:
                require_known(f"{place}.parameters", name, known)
        case SettingTouch():
            require_known(f"{place}.of", touch.controller, list(stations))
            for name in touch.values:
                known = stations[touch.controller].settings
                require_known(f"{place}.settings", name, known)
        case TakeoverTouch():
            require_known(f"{place}.controller", touch.controller, list(stations))
        case DriftTouch():
            known = [signal.name for signal in rig.process.measurements]
            require_known(f"{place}.drift", touch.measurement, known)


class _Replay:
    """The hands on a rig, from one touch that changes who moves it, or what, to the next."""

    def __init__(self, rig: Rig, session: Session) -> None:
        self.rig, self.session = rig, session
        self.players = {
            station.controller.name: Player(station, session.start) for station in rig.stations
        }
        self.leading = rig.stations[0].controller.name
        self.inputs = input_columns(rig, session)
        self.parameters: dict[str, float] = {}
        self.stretches: list[Stretch] = []

    def run(self) -> Replayed:
        changes = [
            touch
            for touch in self.session.touches
            if isinstance(touch, ParameterTouch | SettingTouch | TakeoverTouch)
        ]
        by_sample = {
            # A controller takes over with the numbers that it gets in the same sample.
            sample: sorted(each, key=lambda touch: isinstance(touch, TakeoverTouch))
            for sample, each in groupby(changes, lambda touch: touch.sample)
        }
        cuts = sorted({0, *by_sample, self.session.samples})
        parts = []
        for first, last in pairwise(cuts):
            for touch in by_sample.get(first, ()):
                self._change(touch)
            parts.append(self._part(first, last))
        values = {
            name: np.concatenate([part[name] for part in parts])
            for name in parts[0]
            if all(name in part for part in parts)
        }
        state = self.players[self.leading].standing.state
        return Replayed(
            self.rig.process, self.session, values, state, self._levels(state),
            self._scores(values),
        )  # fmt: skip

    def _change(self, touch: Touch) -> None:
        match touch:
            case ParameterTouch():
                self.parameters = {**self.parameters, **touch.values}
            case SettingTouch():
                player = self.players[touch.controller]
                # Up to here it has followed with those that it had.
                player.follow(self.stretches)
                player.settings = {**player.settings, **touch.values}
            case TakeoverTouch():
                player, before = self.players[touch.controller], self.players[self.leading]
                if player is not before:
                    player.follow(self.stretches)
                    player.take_process(before.standing)
                if touch.start == "settled":
                    player.settle(self._now(touch.sample), self.parameters)
                if touch.start == "zero":
                    player.forget()
                self.leading = touch.controller

    def _now(self, sample: int) -> dict[str, float]:
        """Return the inputs of a sample, manual values where the process had them before it."""
        now = {name: float(column[sample]) for name, column in self.inputs.items()}
        last = self.stretches[-1].moved if self.stretches else {}
        return now | {f"{name}.manual": float(column[-1]) for name, column in last.items()}

    def _part(self, first: int, last: int) -> dict[str, np.ndarray]:
        given = {name: column[first:last] for name, column in self.inputs.items()}
        recorded = self.players[self.leading].lead(given, self.parameters, last - first)
        moved = {u.name: recorded[u.name] for u in self.rig.process.inputs}
        self.stretches.append(Stretch(last - first, given, moved, self.parameters))
        self.players[self.leading].done = len(self.stretches)
        setpoints = {f"{y}.setpoint": given[f"{y}.setpoint"] for y in self.rig.process.controlled}
        return recorded | setpoints

    def _levels(self, state: dict[str, float]) -> dict[str, float]:
        process = self.rig.process
        values = process.parameter_values.copy()
        for place, parameter in enumerate(process.parameters):
            values[place] = self.parameters.get(parameter.name, values[place])
        contents = [state[signal.name] for signal in process.motion.contents]
        found = np.array(process.motion.to_state(contents, values)).ravel()
        return dict(zip((x.name for x in process.state), found.tolist(), strict=True))

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
