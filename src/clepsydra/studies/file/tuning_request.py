"""What a study file asks of a tuning by simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.process.errors_at import errors_at
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.law_parameters import law_parameters
from clepsydra.studies.file.tuning_bounds import (
    Bound,
    law_name,
    of_weights,
    tuned_parameter,
    tuned_weight,
)
from clepsydra.studies.tuning.goal import Goal
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.lqi_weights import LqiWeights, WeightedDesign
from clepsydra.studies.tuning.objective import Limits, Objective
from clepsydra.studies.tuning.parameters import gains_and_times
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search_space import SearchSpace
from clepsydra.studies.tuning.tune import Search, tune
from clepsydra.studies.tuning.weight_space import usual_wear, weight_space

#: Takes the controller that was designed, and the model with all measurements.
WeightedStart = Callable[[Controller, LinearModel], WeightedDesign]


@dataclass(frozen=True, eq=False)
class TuningRequest:
    """What is tuned of one controller, for what, and within which limits.

    Parameters
    ----------
    table : TableReader
        Of the tuning.
    objective : Objective
    limits : Limits
    bounds : tuple of Bound or None
        None where gains and integral times are tuned within a factor of ten, or weights.
    weighted : callable or None
        What makes the start of a design by weights, which are tuned unless `bounds` name
        parameters of the law.
    """

    table: TableReader
    objective: Objective
    limits: Limits
    bounds: tuple[Bound, ...] | None
    weighted: WeightedStart | None = None

    def space(self, controller: Controller, model: LinearModel) -> SearchSpace:
        """Return what may become of a controller, before anything is simulated.

        Raises
        ------
        InputError
            A parameter is unknown, its bounds are the wrong way round or beyond what the law
            takes, or the controller starts outside of them.
        NotApplicable
            Nothing is named, and the law has no gain and no integral time.
        """
        if self._weights is not None:
            start = self._weights(controller, model)
            known = LqiWeights(start).numbers
            named = [tuned_weight(bound, known) for bound in self.bounds or ()]
            with errors_at(self.table, self._places(controller)):
                return weight_space(start, named or None)
        if self.bounds is None:
            parameters = gains_and_times(controller)
        else:
            law = law_parameters(controller.law)
            parameters = tuple(tuned_parameter(bound, controller, law) for bound in self.bounds)
        with errors_at(self.table, self._places(controller)):
            return LawSpace(controller, parameters)

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        """Tune a controller as asked; raises as `clepsydra.studies.tuning.tune.tune`."""
        space, limits = self.space(controller, model), self.limits
        if self._weights is not None and not self.table.has("total_variation"):
            limits = replace(limits, total_variation=usual_wear(controller, model, scenario))
        with errors_at(self.table, self._places(controller)):
            return tune(space, Goal(model, scenario, self.objective, limits), search)

    @property
    def _weights(self) -> WeightedStart | None:
        """What makes the start of the weights that are tuned; None where none are."""
        named = self.bounds is None or of_weights(self.bounds)
        return self.weighted if self.weighted is not None and named else None

    def _places(self, controller: Controller) -> dict[str, str]:
        """Return where the bounds of each tuned number stand."""
        bounds = self.bounds or ()
        if self._weights is not None:
            return {bound.name: bound.place for bound in bounds}
        parameters = law_parameters(controller.law)
        return {law_name(bound, parameters): bound.place for bound in bounds}
