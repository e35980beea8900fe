"""The weights of LQI as numbers to tune, and the law's parameters that follow from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.designs.designed_values import applicable_values
from clepsydra.designs.states.linear_quadratic import LqiGains, lqi_gains
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.search_space import NumberWords

KINDS = ("states", "inputs", "integrals")
#: A lowest weight this near counts as reached, a share of it.
_BINDS = 1e-2


class WeightedDesign(NamedTuple):
    """An LQI controller with the weights that made it.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Whose states, inputs and outputs are weighed.
    weights : QuadraticWeights
        With those of the integrals.
    horizon : float
        About how long a response takes [s].
    tracking_times : callable
        (feedback [m, measurements], gains) → one for each input [s].
    """

    controller: Controller
    model: LinearModel
    weights: QuadraticWeights
    horizon: float
    tracking_times: Callable[[np.ndarray, LqiGains], list[float]]


class LqiWeights:
    """Weights of squares of states, inputs and integrals by "states.tank_1.level" and so on.

    A number is an element of the diagonal of its matrix. What stands beside the diagonal keeps
    its correlation, w_ij / √(w_ii w_jj), so that the matrix stays definite. A weight of zero is
    no number to tune, and stays.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.tuning.weighted_designs import lqi_by_bryson
    >>> start = lqi_by_bryson(cl.load("three-tanks").linear)
    >>> weights = LqiWeights(start)
    >>> list(weights.numbers)
    ['states.tank_3.level', 'inputs.feed', 'integrals.level_3']
    >>> found, own = weights.values(weights.numbers), start.controller.values
    >>> name = "feed.feedback.level_3"
    >>> round(found[name] / own[name], 5)  # it runs with six digits
    1.0
    """

    def __init__(self, start: WeightedDesign) -> None:
        self._start = start
        model, controller = start.model, start.controller
        self._shown = with_outputs(model, controller.measurements).C
        self._period = operating_point_of(model).process.sampling_period
        self._names = {
            "states": model.states, "inputs": model.inputs, "integrals": model.outputs
        }  # fmt: skip

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The weights of the start that are not zero, by name."""
        return {
            f"{kind}.{name}": float(value)
            for kind in KINDS
            for name, value in zip(self._names[kind], np.diag(self._matrix(kind)), strict=True)
            if value > 0.0
        }

    def weights(self, numbers: Mapping[str, float]) -> QuadraticWeights:
        """Return the weights with these numbers on their diagonals."""
        matrices = {}
        for kind in KINDS:
            sizes = [
                np.sqrt(numbers[key] / self.numbers[key]) if key in self.numbers else 1.0
                for key in (f"{kind}.{name}" for name in self._names[kind])
            ]
            matrices[kind] = self._matrix(kind) * np.outer(sizes, sizes)
        return QuadraticWeights(**matrices)

    def values(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Return feedback, integral gains and tracking times of the law, not rounded.

        Raises
        ------
        NotApplicable
            There are no stabilising gains, or one is outside of what the law takes.
        """
        start = self._start
        gains = lqi_gains(start.model, self.weights(numbers), self._period, start.horizon)
        # The law sees measurements: F x = (F M⁻¹) y where y = M x.
        feedback = np.linalg.solve(self._shown.T, gains.feedback.T).T
        controller = start.controller
        moved, own = controller.manipulated, controller.values
        found = {
            path(path(u, part), y): float(value)
            for part, matrix, columns in (
                ("feedback", feedback, controller.measurements),
                ("integral_gain", gains.integral, controller.setpoints),
            )
            for u, row in zip(moved, matrix, strict=True)
            for y, value in zip(columns, row, strict=True)
        }
        times = start.tracking_times(feedback, gains)
        found |= {
            name: time
            for u, time in zip(moved, times, strict=True)
            if (name := path(u, "tracking_time")) in own
        }
        applicable_values(controller.law, {**own, **found})
        return found

    @property
    def words(self) -> WeightWords:
        """The weights in words."""
        return WeightWords()

    def notes(
        self, parameters: Sequence[TunedParameter], tuned: Mapping[str, float]
    ) -> tuple[str, ...]:
        """Return which weights were kept, and which lowest ones chose the result."""
        notes = []
        others = ((name, value) for name, value in self.numbers.items() if name not in tuned)
        kept = [f"{name} = {value:.4g}" for name, value in others]
        if kept:
            why = ", since only ratios of weights count" if len(kept) == 1 else ""
            notes.append(f"Kept as it was: weight of {', '.join(kept)}{why}.")
        cheapest = [
            p.name
            for p in parameters
            if p.name.startswith("inputs.") and tuned[p.name] <= p.low * (1.0 + _BINDS)
        ]
        if cheapest:
            notes.append(
                f"The lowest weight allowed of {' and '.join(cheapest)} chose how fast it moves, "
                "not the objective, which cheaper moves lower further: limit the total variation."
            )
        return tuple(notes)

    def _matrix(self, kind: str) -> np.ndarray:
        matrix = getattr(self._start.weights, kind)
        assert isinstance(matrix, np.ndarray)
        return matrix


class WeightWords(NumberWords):
    """Weights in words: numbers per SI unit squared, as in a study file.

    Examples
    --------
    >>> WeightWords().name("inputs.pump_1"), WeightWords().value("inputs.pump_1", 0.04)
    ('weight of inputs.pump_1', '0.04')
    """

    def name(self, parameter: str) -> str:
        """Return what the reader calls a weight."""
        return f"weight of {parameter}"
