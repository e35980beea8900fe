"""The scores of a run in a page: added up by the loop's own program, or found over its record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from clepsydra.base.signal import path
from clepsydra.loop.closed_loop import true_name
from clepsydra.loop.plant_readings import FILLING, INFLOW, OUTFLOW
from clepsydra.loop.running_scores import RunningScores, running_scores
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.program.program import Program
from clepsydra.scores.averaging import ratio
from clepsydra.scores.effort import deviation_of_moves
from clepsydra.scores.marks import samples_of
from clepsydra.scores.score import Of
from clepsydra.scores.score_key import score_key
from clepsydra.scores.step_response import BAND, SETTLING_TIME

#: What a page calls what makes a score of its sums.
_FINISHES = {None: "", ratio: "ratio", deviation_of_moves: "deviation"}
#: Scores of what averages to what they are found over.
_OF_BUFFERS = {
    "outflow_overshoot": (OUTFLOW, INFLOW),
    "outflow_swings": (OUTFLOW, INFLOW),
    "volume_used": (FILLING,),
}


class LiveScores:
    """Some scores of the runs of a page.

    Parameters
    ----------
    process : Process
    keys : sequence of str
        "iae[level_1]"; those that a page cannot find are left out.

    Attributes
    ----------
    running : RunningScores
        What a loop's program adds up.
    """

    def __init__(self, process: Process, keys: Sequence[str]) -> None:
        known = running_scores()
        if process.motion.delays:  # what comes out of one, no program adds up
            known = {key: each for key, each in known.items() if each.of is not Of.AVERAGING}
        summed = [key for key in keys if score_key(key).score in known]
        self.running = RunningScores(process, tuple(summed))
        found = {SETTLING_TIME.key} | ({} if process.motion.delays else _OF_BUFFERS).keys()
        over = [key for key in keys if score_key(key).score in found]
        self._keys = [*summed, *over]
        self._summed = len(summed)

    def place(self, key: str) -> int | None:
        """Return the number of a score; None where a page has none."""
        return self._keys.index(key) if key in self._keys else None

    def described(self, program: Program, scenario: Scenario) -> list[dict[str, Any]]:
        """Return how a page finds each score of a run.

        Parameters
        ----------
        program : Program
            Of the loop, with the sums of `running` and with readings.
        """
        states = [entry.name for entry in program.state]
        outputs = [signal.name for signal in program.outputs]
        found: list[dict[str, Any]] = []
        for key in self._keys[: self._summed]:
            places = [states.index(name) for name in self.running.folds(key)]
            finish = _FINISHES[score_key(key).declared.finish]
            found.append({"key": key, "kind": "fold", "states": places, "finish": finish})
        for key in self._keys[self._summed :]:
            found.append({"key": key, **self._over_record(key, outputs, scenario)})
        return found

    def _over_record(self, key: str, outputs: Sequence[str], scenario: Scenario) -> dict[str, Any]:
        """Return how a score is found over the outputs of a run."""
        (score, name), process = score_key(key), self.running.process
        if score in _OF_BUFFERS:
            columns = [outputs.index(path(name, part)) for part in _OF_BUFFERS[score]]
            return {"kind": score, "columns": columns, "loads": _loads(scenario)}
        return {
            "kind": "settling",
            "column": outputs.index(true_name(process.signal(name))),
            "band": BAND,
            "steps": _steps(process, scenario, name),
        }


def _loads(scenario: Scenario) -> list[tuple[int, int]]:
    """Return first and last sample, that not included, in which each load acts."""
    acting = (
        samples_of(scenario.time, each, with_stop=False)
        for each in scenario.segments
        if each.kind == "load"
    )
    return [(samples.start, samples.stop) for samples in acting]


def _steps(process: Process, scenario: Scenario, name: str) -> list[tuple[int, int, float, float]]:
    """Return first sample, stop, start and target [SI] of each setpoint step of a measurement."""
    setpoint = scenario.setpoints[:, process.controlled.index(name)]
    found = []
    for segment in scenario.segments:
        if (segment.kind, segment.signal) == ("setpoint", name):
            samples = samples_of(scenario.time, segment)
            target = float(setpoint[samples.start])
            found.append((samples.start, samples.stop, target - segment.size, target))
    return found
