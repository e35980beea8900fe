"""What a report carries to run its first loops again in the page, as values for JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from clepsydra.base.signal import path
from clepsydra.base.units import unit_text
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop, true_name
from clepsydra.loop.loop import Loop
from clepsydra.loop.plant_readings import RUNNING
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program
from clepsydra.report.live.law_programs import resting, slopes
from clepsydra.report.live.live_columns import keys_of, live_columns
from clepsydra.report.live.live_scores import LiveScores
from clepsydra.report.live.modules import Modules
from clepsydra.report.live.noise_apart import noise_apart
from clepsydra.report.live.packed import column
from clepsydra.report.live.sampled_plant import sampled_plant
from clepsydra.report.live.sliders import bolder, sliders
from clepsydra.report.overlay import EventWindow, ShownSignal
from clepsydra.report.quantities import display_factor
from clepsydra.scores.band import TIME_OUTSIDE
from clepsydra.scores.plant_flows import forced_flow_names
from clepsydra.studies.result import Candidate, StudyResult

#: Of what stands here; the page refuses another.
FORM = 1


def live_data(
    result: StudyResult,
    signals: Sequence[ShownSignal],
    windows: Sequence[EventWindow],
    first: Sequence[Candidate],
) -> dict[str, Any] | None:
    """Return what the page needs to run the first controllers with other settings.

    Parameters
    ----------
    signals, windows
        The rows of charts and the events that they show.
    first : sequence of Candidate
        The recommended controller and its rival.

    Returns
    -------
    dict or None
        None where no setting of theirs can be moved, and for a scenario that does not begin at
        rest.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.report.overlay import event_windows, shown_signals
    >>> result = cl.study("three-tanks")
    >>> signals, first = shown_signals(result), result.ranking[:2]
    >>> data = live_data(result, signals, event_windows(result, signals, first), first)
    >>> [each["name"] for each in data["controllers"]], len(data["inputs"][0])
    (['MPC', 'PI, SIMC, tuned'], 3)
    """
    if result.scenario.begin is not None:
        return None
    movable = [each for each in first if _is_movable(each)]
    if not movable:
        return None
    modules, scores = Modules(), LiveScores(result.process, keys_of(result))
    period = result.scenario.sampling_period
    model = linearise(result.point)
    controllers = [_Controller(each, result, model, scores, modules) for each in movable]
    return {
        "form": FORM,
        "period": period,
        "samples": result.scenario.samples,
        "inputs": controllers[0].inputs(),
        "columns": live_columns(result, scores),
        "starts": [round(window.segment.start / period) for window in windows],
        "controllers": [each.data(signals) for each in controllers],
        "modules": modules.held,
    }


def _is_movable(candidate: Candidate) -> bool:
    controller = candidate.controller
    if isinstance(controller.law, PythonLaw) or candidate.response is None:
        return False
    return bool(bolder(controller) or sliders(controller))


class _Controller:
    """A controller of the ranking as the page runs it."""

    def __init__(
        self,
        candidate: Candidate,
        result: StudyResult,
        model: LinearModel,
        scores: LiveScores,
        modules: Modules,
    ) -> None:
        self.candidate, self.result, self.scores, self.modules = candidate, result, scores, modules
        self.controller, self.scenario = candidate.controller, result.scenario
        self.model, self.loop = model, Loop(self.controller, model)
        self.program: Program = closed_loop(
            result.process, self.controller, substeps=candidate.run.substeps,
            constant=self.loop.fixed(self.scenario), scores=scores.running, readings=True,
        )  # fmt: skip
        self.outputs = [signal.name for signal in self.program.outputs]

    def inputs(self) -> list[dict[str, Any]]:
        """Return the inputs of its loop, which are those of every other."""
        quiet, noises = noise_apart(self.scenario, self.result.process)
        given = {**self.loop.inputs_of(quiet), **self.scores.running.inputs_of(quiet)}
        return [
            {**column(given[signal.name].copy()), "noise": noises.get(signal.name)}
            for signal in self.program.inputs
        ]

    def data(self, signals: Sequence[ShownSignal]) -> dict[str, Any]:
        """Return all that is its own."""
        candidate, controller = self.candidate, self.controller
        return {
            "controller": self.result.ranking.index(candidate),
            "name": controller.title,
            "values": [controller.values[each.name] for each in controller.law.parameters],
            "loop": self._loop(),
            "scores": self.scores.described(self.program, self.scenario),
            "signals": [self._shown(each) for each in signals],
            "limits": self._limits(),
            "spills": self._spills(),
            "bands": self._bands(),
            "law": resting(self.loop, self.modules),
            "slopes": slopes(controller, self.model, self.modules),
            "plant": sampled_plant(controller, self.model),
            "loops": sliders(controller),
            "bolder": bolder(controller),
        }

    def _loop(self) -> dict[str, Any]:
        program, initial = self.program, self.loop.initial_state()
        state = [signal_of(entry) for entry in program.state]
        own, sums = self.loop.law_parameters(), self.scores.running.state
        parameters = [own.get(each.name, each.initial) for each in program.parameters]
        return {
            "module": self.modules.add(program),
            "outputs": len(self.outputs),
            "state": [initial.get(entry.name, entry.initial) for entry in state],
            "law": len(state) - len(sums) - len(self.controller.law.state),
            "parameters": parameters,
            "first": len(self.result.process.parameters),
            "rings": [
                {"initial": initial[ring.name], "length": ring.length, "turns": turns}
                for ring, turns in rings_and_turns(program)
            ],
        }

    def _shown(self, shown: ShownSignal) -> dict[str, Any] | None:
        name = shown.signal.name
        if name == shown.measurement:
            name = true_name(shown.signal)
        elif shown.moved and name in forced_flow_names(self.result.process):
            name = path(name, RUNNING)  # its signal is the flow that is asked for
        if name not in self.outputs:
            return None
        return {"column": self.outputs.index(name), "factor": display_factor(shown.signal)}

    def _limits(self) -> list[dict[str, Any]]:
        found = []
        for signal in self.result.process.inputs:
            low, high = (
                end if math.isfinite(end) else None
                for end in self.candidate.run.limits(signal.name)
            )
            found.append({
                "name": signal.name, "column": self.outputs.index(signal.name),
                "low": low, "high": high,
            })  # fmt: skip
        return found

    def _bands(self) -> list[dict[str, Any]]:
        places = {
            name: self.scores.place(f"{TIME_OUTSIDE.key}[{name}]")
            for name in self.result.process.bands
        }
        return [
            {"name": name, "score": place} for name, place in places.items() if place is not None
        ]

    def _spills(self) -> list[dict[str, Any]]:
        totals = {signal.name: signal for signal in self.result.process.motion.totals}
        return [
            {
                "name": tank,
                "column": self.outputs.index(total),
                "factor": display_factor(totals[total]),
                "unit": unit_text(totals[total].shown_unit),
            }
            for tank, total in self.result.process.spilt.items()
            if total in self.outputs
        ]
