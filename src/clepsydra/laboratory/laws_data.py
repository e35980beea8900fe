"""What a page carries to let its reader bring numbers for laws: where they go, and what they do."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.laboratory.free_laws import STATES, FreeLaw, LoadedMatrices, TypedLoops
from clepsydra.laboratory.other_units import other_units
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.loop import Loop
from clepsydra.report.live.law_programs import resting, slopes
from clepsydra.report.live.modules import Modules
from clepsydra.report.live.sampled_plant import sampled_plant
from clepsydra.report.live.sliders import bolder, sliders


def laws_data(
    model: LinearModel, given: Sequence[Controller], free: Sequence[FreeLaw], modules: Modules
) -> dict[str, Any]:
    """Return the laws that take a reader's numbers, and which settings of the others move.

    Parameters
    ----------
    given : sequence of Controller
        The first ones of the page.
    free : sequence of FreeLaw
        Those behind them.
    """
    found = _Laws(model, modules)
    return {
        "percent": {
            signal.name: signal.percent_span / 100.0
            for signal in (*found.process.measurements, *found.process.inputs)
            if signal.has_range
        },
        "units": other_units(found.process),
        "given": [{"loops": sliders(each), "bolder": bolder(each)} for each in given],
        "free": [
            {"controller": place, **found.of(each)} for place, each in enumerate(free, len(given))
        ],
        "plants": found.plants,
    }


class _Laws:
    """What margins of a free law are found from; what several have in common is held once."""

    def __init__(self, model: LinearModel, modules: Modules) -> None:
        self.model, self.modules = model, modules
        self.process = operating_point_of(model).process
        self.plants: list[dict[str, Any]] = []

    def of(self, free: FreeLaw) -> dict[str, Any]:
        """Return what is told of one kind of law."""
        shared = {"plant": self._plant(free.controller)}
        match free:
            case LoadedMatrices():
                return {"kind": "matrices", **shared, **_matrices(free.controller)}
            case TypedLoops():
                return {"kind": "pid", **shared, **self._loops(free)}

    def _plant(self, controller: Controller) -> int | None:
        """Return the number of the process as its sampled loop has it; None where it has none."""
        with suppress(NotApplicable, InputError):
            plant = sampled_plant(controller, self.model)
            if plant not in self.plants:
                self.plants.append(plant)
            return self.plants.index(plant)
        return None

    def _loops(self, free: TypedLoops) -> dict[str, Any]:
        controller = free.controller
        parameters = controller.law.parameters
        return {
            "form": free.form.algorithm,
            "law": resting(Loop(controller, self.model), self.modules),
            "slopes": slopes(controller, self.model, self.modules),
            "pairs": [
                {
                    "output": output,
                    "input": moved,
                    "places": {
                        each.part: place
                        for place, each in enumerate(parameters)
                        if each.owner == output
                    },
                }
                for output, moved in free.pairs
            ],
        }


def _matrices(controller: Controller) -> dict[str, Any]:
    """Return where the numbers of each matrix go, row by row."""
    parameters = controller.law.parameters
    matrices = [each.matrix for each in parameters if each.matrix]
    return {
        "states": STATES,
        "places": {
            matrix: [place for place, each in enumerate(parameters) if each.matrix == matrix]
            for matrix in dict.fromkeys(matrices)
        },
        "fading": [place for place, each in enumerate(parameters) if each.part == "fading_time"],
    }
