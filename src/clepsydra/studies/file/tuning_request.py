"""What a study file asks of a tuning by simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from clepsydra.base.signal import path
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.studies.file.law_parameters import (
    GAINS,
    LawParameters,
    key_of,
    law_parameters,
    new_name,
    parameter_of,
)
from clepsydra.studies.file.law_range import check_law_range, in_written_unit
from clepsydra.studies.file.placed import placed
from clepsydra.studies.file.tuning_bound import Bound
from clepsydra.studies.file.weight_bounds import (
    WeightedStart,
    of_weights,
    places_of,
    weight_parameters,
)
from clepsydra.studies.tuning.lqi_weights import WeightedDesign
from clepsydra.studies.tuning.objective import Limits, Objective
from clepsydra.studies.tuning.parameters import ROUNDING, LawSpace, TunedParameter, around
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search import Progress
from clepsydra.studies.tuning.tune import tune
from clepsydra.studies.tuning.tuned_lqi import tuned_weights, usual_wear, weight_space
from clepsydra.studies.tuning.tuned_pid import gains_and_times


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

    Examples
    --------
    See `clepsydra.studies.file.tuning_reader.read_tuning`.
    """

    table: TableReader
    objective: Objective
    limits: Limits
    bounds: tuple[Bound, ...] | None
    weighted: WeightedStart | None = None

    def check(self, controller: Controller, model: LinearModel) -> None:
        """Refuse what cannot be tuned of a controller, before anything is simulated.

        Raises
        ------
        InputError
            A parameter is unknown, its bounds are the wrong way round or beyond what the law
            takes, or the controller starts outside of them.
        NotApplicable
            Nothing is named, and the law has no gain and no integral time.
        """
        start = self._weighted_start(controller, model)
        if start is not None:
            weights = weight_parameters(start, self.bounds)
            with placed(self.table, places_of(self.bounds)):
                weight_space(start, weights)
            return
        parameters = self.parameters_of(controller)
        with placed(self.table, self._places(controller)):
            LawSpace(controller, parameters)

    def run(
        self,
        controller: Controller,
        model: LinearModel,
        scenario: Scenario,
        *,
        seed: int = 1,
        front: Sequence[float] = (),
        progress: Callable[[Progress], None] | None = None,
        state_file: Path | None = None,
    ) -> TuningResult:
        """Tune a controller as asked; all as for `clepsydra.studies.tuning.tune.tune`."""
        start = self._weighted_start(controller, model)
        if start is not None:
            limits = self.limits
            if not self.table.has("total_variation"):
                limits = replace(limits, total_variation=usual_wear(controller, model, scenario))
            with placed(self.table, places_of(self.bounds)):
                return tuned_weights(
                    start,
                    scenario,
                    parameters=weight_parameters(start, self.bounds),
                    objective=self.objective,
                    limits=limits,
                    seed=seed,
                    front=front,
                    progress=progress,
                    state_file=state_file,
                )
        parameters = self.parameters_of(controller)
        with placed(self.table, self._places(controller)):
            return tune(
                controller,
                model,
                scenario,
                parameters,
                self.objective,
                limits=self.limits,
                seed=seed,
                front=front,
                progress=progress,
                state_file=state_file,
            )

    def parameters_of(self, controller: Controller) -> tuple[TunedParameter, ...]:
        """Return what is tuned of a controller, with its bounds in the law's units."""
        if self.bounds is None:
            return gains_and_times(controller)
        parameters = law_parameters(controller.law)
        return tuple(_tuned(bound, controller, parameters) for bound in self.bounds)

    def _weighted_start(self, controller: Controller, model: LinearModel) -> WeightedDesign | None:
        """Return the start of the weights that are tuned; None where none are."""
        if self.weighted is None or (self.bounds is not None and not of_weights(self.bounds)):
            return None
        return self.weighted(controller, model)

    def _places(self, controller: Controller) -> dict[str, str]:
        """Return where the bounds of each parameter of the law stand."""
        parameters = law_parameters(controller.law)
        return {
            _law_name(bound, parameters): bound.table.place(bound.key)
            for bound in self.bounds or ()
        }


def _tuned(bound: Bound, controller: Controller, parameters: LawParameters) -> TunedParameter:
    table, key = bound.table, bound.key
    name = _law_name(bound, parameters)
    written: Any = table.raw(key)
    ends = []
    for end in written:
        one = table.with_value(key, end)
        value = parameters.read(one, key, name, "a bound", "give both with their units")
        check_law_range(one, key, parameters.known[name], value)
        ends.append(value)
    low, high = ends
    start = controller.values[name]
    # The gain of a loop is written without its sign, which its action says.
    unsigned = bound.owner in parameters.loops and key in GAINS
    if unsigned and low < 0.0:
        raise table.refused(
            key,
            shown_value(written),
            "bounds that are not negative: the action of the loop gives the gain its sign",
            "leave the signs out",
        )
    bound.check_order(low, high)
    if unsigned and start < 0.0:
        low, high = -high, -low
    _check_start(table, key, ends, abs(start) if unsigned else start)
    with placed(table, {name: table.place(key)}):
        if controller.values[name] == 0.0 or low * high <= 0.0:
            return TunedParameter(name, low, high, logarithmic=False)
        # What follows the parameter, a tracking time the integral time, still does.
        return replace(around(controller, [name])[0], low=low, high=high)


def _check_start(table: TableReader, key: str, ends: list[float], start: float) -> None:
    """Refuse bounds that a parameter does not start within."""
    slack = ROUNDING * (ends[1] - ends[0])
    if ends[0] - slack <= start <= ends[1] + slack:
        return
    written: Any = table.raw(key)
    place = 0 if ends[0] else 1  # one that is not zero has a unit to tell
    shown = in_written_unit(table.with_value(key, written[place]), key, ends[place], start)
    raise table.refused(
        key,
        shown_value(written),
        f"bounds around where it starts, {shown}",
        "widen the bounds or start elsewhere",
    )


def _law_name(bound: Bound, parameters: LawParameters) -> str:
    """Return the parameter of the law that a bound is for."""
    written = bound.key if bound.owner is None else path(bound.owner, bound.key)
    loop = parameters.loops.get(bound.owner or "")
    name = written if loop is None else parameter_of(loop, bound.key)
    if name in parameters.known:
        return name
    if loop is not None:
        known = tuple(key_of(parameter) for parameter in loop.parameters())
    elif bound.owner is not None and parameters.loops:
        known = tuple(parameters.loops)
        raise bound.table.refused(
            bound.key, written, f"a loop of this controller ({', '.join(known)})",
            suggestion(bound.owner, known, "choose one of them"),
        )  # fmt: skip
    else:
        known = (*parameters.known, *parameters.loops)
    now = new_name(bound.key, parameters.known)
    raise bound.table.refused(
        bound.key,
        bound.key if loop is not None else written,
        f"a parameter that can be tuned: {', '.join(known)}",
        f"write {now}" if now else suggestion(bound.key, known, "choose one of them"),
    )
