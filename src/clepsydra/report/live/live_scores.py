"""The scores of a run in a page: added up by the loop's own program, or found over its record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from clepsydra.controllers.controller import Controller
from clepsydra.loop.closed_loop import true_name
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
        settling = [key for key in keys if score_key(key).score == SETTLING_TIME.key]
        self._keys = [*summed, *settling]
        self._summed = len(summed)

    def place(self, key: str) -> int | None:
        """Return the number of a score; None where a page has none."""
        return self._keys.index(key) if key in self._keys else None

    def described(
        self, program: Program, controller: Controller, scenario: Scenario
    ) -> list[dict[str, Any]]:
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
            name = score_key(key).signal
            measurement = self.running.process.signal(name)
            found.append({
                "key": key,
                "kind": "settling",
                "column": outputs.index(true_name(measurement)),
                "band": BAND,
                "steps": _steps(self.running.process, scenario, name),
            })  # fmt: skip
        return found


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
