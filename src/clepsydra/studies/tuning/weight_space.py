"""The space of the weights of LQI: the gains follow from them by the Riccati equation.

M. Kolankowski and R. Piotrowski, Design of Three Control Algorithms for an Averaging Tank with
Variable Filling, 2022, equations (99) to (101).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.designed_values import applicable_values
from clepsydra.designs.lqi import WeighedLqi, weighed_lqi
from clepsydra.designs.lqi_by_weights import design_lqi_by_weights
from clepsydra.designs.states.bryson_rule import acceptable_deviations
from clepsydra.designs.states.linear_quadratic import LqiGains, lqi_gains, slowest_time_constant
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.batch import BatchEvaluation
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.search_space import SearchSpace

KINDS = ("states", "inputs", "integrals")
#: How far a weight may move from where it starts, up and down.
_FACTOR = 1e3
#: A lowest weight this near counts as reached, a share of it.
_BINDS = 1e-2
#: Without other limits an input may move so many times as much as at the start.
_WEAR = 2.0


@dataclass(frozen=True, eq=False)
class WeightSpace(SearchSpace):
    """Weights of squares of states, inputs and integrals by "states.tank_1.level" and so on.

    A number is an element of the diagonal of its matrix [1/SI unit²]. What stands beside the
    diagonal keeps its correlation, w_ij / √(w_ii w_jj), so that the matrix stays definite. A
    weight of zero is no number to tune, and stays.
    """

    weighted: WeighedLqi

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The weights of the start that are not zero, by name."""
        return {
            name: float(value)
            for kind, names in self._names.items()
            for name, value in zip(names, np.diag(self._matrix(kind)), strict=True)
            if value > 0.0
        }

    def weights(self, numbers: Mapping[str, float]) -> QuadraticWeights:
        """Return the weights with these numbers on their diagonals."""
        matrices = {}
        for kind, names in self._names.items():
            own = self.numbers
            sizes = [np.sqrt(numbers[name] / own[name]) if name in own else 1.0 for name in names]
            matrices[kind] = self._matrix(kind) * np.outer(sizes, sizes)
        return QuadraticWeights(**matrices)

    def law_values(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Return feedback, integral gains and tracking times of the law, not rounded.

        Raises
        ------
        NotApplicable
            There are no stabilising gains, or one is outside of what the law takes.
        """
        controller, model = self.controller, self.weighted.model
        period = operating_point_of(model).process.sampling_period
        gains = lqi_gains(model, self.weights(numbers), period, self.weighted.horizon)
        # The law sees measurements: F x = (F M⁻¹) y where y = M x.
        feedback = np.linalg.solve(self._measured.T, gains.feedback.T).T
        found = {
            path(path(u, part), y): float(value)
            for part, matrix, columns in (
                ("feedback", feedback, controller.measurements),
                ("integral_gain", gains.integral, controller.setpoints),
            )
            for u, row in zip(controller.manipulated, matrix, strict=True)
            for y, value in zip(columns, row, strict=True)
        }
        times = self.weighted.tracking_times(feedback, gains)
        for u, time in zip(controller.manipulated, times, strict=True):
            if path(u, "tracking_time") in controller.values:
                found[path(u, "tracking_time")] = time
        applicable_values(controller.law, {**controller.values, **found})
        return found

    def name_of(self, number: str) -> str:
        """Return what the reader calls a weight."""
        return f"weight of {number}"

    def notes(self, tuned: Mapping[str, float]) -> tuple[str, ...]:
        """Return which weights were kept, and which lowest ones chose the result."""
        notes = []
        others = ((name, value) for name, value in self.numbers.items() if name not in tuned)
        kept = [f"{name} = {value:.4g}" for name, value in others]
        if kept:
            why = ", since only ratios of weights count" if len(kept) == 1 else ""
            notes.append(f"Kept as it was: weight of {', '.join(kept)}{why}.")
        cheapest = [
            p.name
            for p in self.parameters
            if p.name.startswith("inputs.") and tuned[p.name] <= p.low * (1.0 + _BINDS)
        ]
        if cheapest:
            notes.append(
                f"The lowest weight allowed of {' and '.join(cheapest)} chose how fast it moves, "
                "not the objective, which cheaper moves lower further: limit the total variation."
            )
        return tuple(notes)

    @property
    def _names(self) -> dict[str, list[str]]:
        """The weights of each matrix, in the order of its diagonal."""
        model = self.weighted.model
        sides = zip(KINDS, (model.states, model.inputs, model.outputs), strict=True)
        return {kind: [f"{kind}.{name}" for name in names] for kind, names in sides}

    def _matrix(self, kind: str) -> np.ndarray:
        return np.asarray(getattr(self.weighted.weights, kind))

    @cached_property
    def _measured(self) -> np.ndarray:
        return with_outputs(self.weighted.model, self.controller.measurements).C


def weight_space(
    start: WeighedLqi, parameters: Sequence[TunedParameter] | None = None
) -> WeightSpace:
    """Return the space of some weights of a design, or of all but the first integral's.

    Each may become a thousand times as large or as small where no bounds are given.

    Raises
    ------
    InputError
        As `SearchSpace`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> space = weight_space(weighed_lqi(cl.load("three-tanks").linear))
    >>> [parameter.name for parameter in space.parameters]
    ['states.tank_3.level', 'inputs.feed']
    """
    if parameters is None:
        kept = f"integrals.{start.model.outputs[0]}"
        numbers = WeightSpace(start.controller, (), start).numbers
        parameters = [
            TunedParameter(name, value / _FACTOR, value * _FACTOR)
            for name, value in numbers.items()
            if name != kept
        ]
    return WeightSpace(start.controller, parameters, start)


def usual_wear(controller: Controller, model: LinearModel, scenario: Scenario) -> dict[str, float]:
    """Return twice the total variation that a controller makes of each input in a scenario.

    An input that does not move at all has no limit.
    """
    names = [f"total_variation[{name}]" for name in controller.manipulated]
    found = BatchEvaluation(controller, model, scenario, names).run({})
    moved = (float(found.scores[name][0]) for name in names)
    wear = zip(controller.manipulated, moved, strict=True)
    return {name: _WEAR * value for name, value in wear if value > 0.0}


def lqi_of_weights(
    model: LinearModel,
    weights: QuadraticWeights,
    *,
    anti_windup: AntiWindup = "back_calculation",
) -> WeighedLqi:
    """Return LQI by given weights; all as for `designs.lqi_by_weights.design_lqi_by_weights`."""
    controller = design_lqi_by_weights(model, weights, anti_windup=anti_windup)
    horizon = acceptable_deviations(model, None, None).horizon
    period = operating_point_of(model).process.sampling_period

    def times(feedback: np.ndarray, gains: LqiGains) -> list[float]:
        slowest = max(slowest_time_constant(gains.eigenvalues, period), period)
        return [slowest] * len(model.inputs)

    return WeighedLqi(controller, model, weights, horizon, times)


#: By the names of the designs in a study file; arguments as those of the designs.
WEIGHTED_DESIGNS: dict[str, Callable[..., WeighedLqi]] = {
    "lqi": weighed_lqi,
    "lqi_by_weights": lqi_of_weights,
}
