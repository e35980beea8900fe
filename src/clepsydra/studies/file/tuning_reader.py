"""The table of a study file that asks for a tuning."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import path
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.designs.lqi import WeighedLqi
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.process import told
from clepsydra.process.declared import part, read_fields
from clepsydra.process.errors_at import errors_at
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_value
from clepsydra.process.table_reader import TableReader
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import ScoreKey, score_key
from clepsydra.studies.file.law_parameters import law_parameters
from clepsydra.studies.file.tuning_bounds import Bound, of_weights, tuned_parameter, tuned_weight
from clepsydra.studies.file.tuning_draws import draws_key, quantile_key
from clepsydra.studies.tuning.draws import draws_at
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.memory import UnusableState
from clepsydra.studies.tuning.objective import Limits, Objective, judged
from clepsydra.studies.tuning.parameters import TunedParameter, settings_of
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search_space import SearchSpace
from clepsydra.studies.tuning.tune import Search, tune
from clepsydra.studies.tuning.weight_space import KINDS, usual_wear, weight_space
from clepsydra.studies.usual_goal import (
    DAMPING,
    NOISE_MOVEMENT,
    usual_goal,
    usual_limits,
)
from clepsydra.studies.warnings.overshooting import OVERSHOOT

#: Takes the controller that was designed, and the model with all measurements.
WeightedStart = Callable[[Controller, LinearModel], WeighedLqi]
METHODS = ("minimax", "weighted")
_WEIGHT_REMEDY = (
    'write as in inputs.pump = [1e-3, 1e3] or states."tank.level" = [1e-3, 1e3], in quotes where '
    "a name has a dot"
)
_NAMES = 'write as in objective = "iae", ["iae[level_1]", "ise[level_2]"] or { iae = 1.0 }'


@dataclass(frozen=True)
class Tuning:
    """What a study file says of a tuning.

    Parameters
    ----------
    weighted : callable or None
        What makes the start of a design by weights, which are tuned unless `bounds` name
        parameters of the law.
    asked : object
        What its file says of the controller, by which it is known again.
    objective : Objective or None
        None for what ranks a study.
    bounds : tuple of Bound or None
        None where all settings of the loops are tuned, or weights.
    total_variation : dict
        Manipulated variable to its limit [its unit].
    maximum_sensitivity, overshoot, noise_movement, damping : float
        Limits [1]; infinite where the usual one holds.
    draws : int or None
        How many drawn plants a quantile is taken over; None for the plant itself.
    quantile : float
        The share of them that are to be at least as good.
    """

    table: TableReader
    process: Process
    weighted: WeightedStart | None
    asked: object
    objective: Objective | None = part(
        lambda table, key, known: _objective(table, known["process"]),
        {
            "objective": {
                "description": "a score, a list of scores, or a table of scores with weights; a "
                "score is of all its signals or of one; left out, the mean of what ranks a study",
                "type": ["string", "array", "object"],
            },
            "method": told.choice(
                '`"minimax"`: the largest score counts; `"weighted"`: their sum. Each is taken '
                "relative to the start",
                METHODS,
            ),
        },
    )
    bounds: tuple[Bound, ...] | None = part(
        lambda table, key, known: _bounds(table),
        {
            "parameters": {
                "description": "what may change, each with a low and a high bound: a key of a "
                "loop, `level.gain`, or a parameter of the law, `level.integral_time`. Loops that "
                "a design makes are called by their measurement",
                "type": "object",
            }
        },
    )
    total_variation: dict[str, float] = part(
        lambda table, key, known: _total_variation(table, known["process"]),
        **told.by_name("table of manipulated variables with their limits"),
    )
    maximum_sensitivity: float = quantity(
        "1",
        "a limit of max|S| of all loops together",
        above=1.0,
        default=SENSITIVITY_LIMIT,
        remedy="1.4 to 2 is customary",
    )
    overshoot: float = quantity(
        "1",
        f"a limit of the overshoot of every setpoint step, {OVERSHOOT:g} % if left out, a share of "
        "the step",
        at_least=0.0,
        at_most=1.0,
        default=math.inf,
        absent=math.inf,
        remedy='write as in "10 %" of the step',
    )
    noise_movement: float = quantity(
        "1",
        "a limit of how far noise may throw an input about, a share of its range",
        above=0.0,
        default=NOISE_MOVEMENT,
        remedy='write as in "5 %" of the range',
    )
    damping: float = quantity(
        "1",
        f"a limit of the damping ratio of the loops, {DAMPING:g} where a level averages if left "
        "out, 0 for none, a ratio",
        at_least=0.0,
        at_most=1.0,
        default=math.inf,
        absent=math.inf,
        remedy="0.7 to 1 is customary",
    )
    draws: int | None = draws_key()
    quantile: float = quantile_key()

    @property
    def limits(self) -> Limits:
        """What a candidate must keep, the overshoot in percent."""
        usual = usual_limits(self.process)
        asked = math.isfinite(self.overshoot)
        return Limits(
            self.maximum_sensitivity,
            100.0 * self.overshoot,
            math.inf if asked else usual.overshoot_if_stepped,
            self.noise_movement,
            self.damping if math.isfinite(self.damping) else usual.damping,
            self.total_variation,
        )

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
        if self._start is not None:
            weights = weight_space(self._start(controller, model))
            if self.bounds is None:
                return weights
            parameters = [tuned_weight(bound, weights.numbers) for bound in self.bounds]
            with self._errors_of(parameters):
                return replace(weights, parameters=parameters)
        if self.bounds is None:
            return LawSpace(controller, settings_of(controller))
        law = law_parameters(controller.law)
        parameters = [tuned_parameter(bound, controller, law) for bound in self.bounds]
        with self._errors_of(parameters):
            return LawSpace(controller, parameters)

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        """Tune a controller as asked; raises as `clepsydra.studies.tuning.tune.tune`.

        The seed of the search is that of the draws.
        """
        space, limits = self.space(controller, model), self.limits
        if self._start is not None and not self.table.has("total_variation"):
            limits = replace(limits, total_variation=usual_wear(controller, model, scenario))
        with errors_at(self.table, but=(UnusableState,)):
            goal = usual_goal(controller, model, scenario, limits, self.objective)
            if self.draws is not None:
                draws = draws_at(model, self.draws, self.quantile, search.seed)
                goal = replace(goal, draws=draws)
            return tune(space, goal, search)

    @property
    def _start(self) -> WeightedStart | None:
        """What makes the start of the weights that are tuned; None where none are."""
        named = self.bounds is None or of_weights(self.bounds)
        return self.weighted if self.weighted is not None and named else None

    def _errors_of(self, parameters: list[TunedParameter]) -> AbstractContextManager[None]:
        """Tell what is wrong with a parameter where its bounds stand."""
        named = zip(parameters, self.bounds or (), strict=True)
        return errors_at(self.table, {p.name: bound.table.place(bound.key) for p, bound in named})


def read_tuning(
    table: TableReader,
    process: Process,
    weighted: WeightedStart | None = None,
    asked: object = None,
) -> Tuning:
    """Read what a controller is to be tuned for, from a table with the keys of `Tuning`.

    Without an objective it is the mean of what a study ranks by. Without parameters all settings
    of the loops are tuned, each within a factor of ten and setpoint weights between 0 and 1; of a
    design by weights the weights, within a factor of a thousand. Without limits they are those of
    `clepsydra.studies.usual_goal`.

    Raises
    ------
    InputError
        A score cannot be tuned for, a weight or limit is wrong, or bounds are no two quantities
        in order.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> table = TableReader(parse(b'maximum_sensitivity = 1.7', "study.toml"), (), None)
    >>> read_tuning(table, load_process("quadruple-tank")).maximum_sensitivity
    1.7
    """
    with errors_at(table):
        return Tuning(
            table, process, weighted, asked, **read_fields(Tuning, table, process=process)
        )


def _objective(table: TableReader, process: Process) -> Objective | None:
    if not (table.has("objective") or table.has("method")):
        return None
    written = table.raw("objective") if table.has("objective") else "iae"
    weights: dict[str, float]
    if isinstance(written, str):
        weights = dict.fromkeys(_scores(table, written, process), 1.0)
    elif isinstance(written, list):
        names = table.names("objective", "a list of scores", _NAMES)
        weights = {score: 1.0 for name in names for score in _scores(table, name, process)}
    elif isinstance(written, dict):
        row = table.table("objective", "scores with their weights", _NAMES)
        weights = {
            score: row.quantity(name, "1", "a weight", "give a number above 0", above=0.0)
            for name in row.present
            for score in _scores(table, name, process)
        }
    else:
        raise table.wrong("objective", "a score, or several", _NAMES)
    weighted = "weighted" if isinstance(written, dict) else "minimax"
    method = table.choice("method", METHODS, weighted)
    if not weights:
        raise table.refused("objective", "none", "a score", 'name one: "iae[level_1]"')
    return Objective("minimax" if method == "minimax" else "weighted", weights)


def _scores(table: TableReader, name: str, process: Process) -> list[str]:
    """Return the scores of single signals that a name stands for."""
    score, wanted = score_key(name)
    if score not in judged():
        raise table.refused(
            "objective",
            name[:60],
            f"a score that can be tuned for ({', '.join(judged())}), of all its signals or of one, "
            'as in "iae[level_1]"',
            suggestion(score, judged(), "choose one of them"),
        )
    known = SCORES[score].of.signals(process)
    if not known:
        raise table.refused(
            "objective",
            name[:60],
            f"a score that {process.name} has: it has no level that averages",
            "choose another, or name averaging in the process file",
        )
    if not wanted:
        return [str(ScoreKey(score, signal)) for signal in known]
    if wanted not in known:
        raise table.refused(
            "objective",
            name[:60],
            f"{score} of one of {', '.join(known)}",
            suggestion(wanted, known, "choose one of them"),
        )
    return [name]


def _total_variation(table: TableReader, process: Process) -> dict[str, float]:
    """Return the limit of each manipulated variable that has one."""
    if not table.has("total_variation"):
        return {}
    row = table.table(
        "total_variation",
        "manipulated variables with their largest total variation",
        f'write as in {{ {process.inputs[0].name} = "300 %" }}',
        [signal.name for signal in process.inputs],
    )
    what, remedy = "a total variation", "give the sum of all moves"
    found = {
        name: read_value(row, name, process.signal(name), what, remedy, change=True)
        for name in row.present
    }
    for name, limit in found.items():
        if not limit > 0.0:
            raise row.wrong(name, f"{what} above 0", remedy)
    return found


def _bounds(table: TableReader) -> tuple[Bound, ...] | None:
    """Return the bounds of each parameter: of a key of a loop, or of the law itself."""
    if not table.has("parameters"):
        return None
    remedy = 'write as in level.gain = ["0.1 %/%", "10 %/%"], or leave parameters out'
    rows = table.table("parameters", "parameters with their bounds", remedy)
    found = list(_bounds_below(rows, "", remedy))
    if not found:
        raise table.refused("parameters", "none", "at least one parameter", remedy)
    for bound in found:
        _check_pair(bound, _WEIGHT_REMEDY if bound.owner in KINDS else remedy)
    return tuple(found)


def _bounds_below(rows: TableReader, owner: str, remedy: str) -> Iterator[Bound]:
    """Yield the bounds of a table, and of those below it; a weight's name is one key."""
    for name in rows.present:
        if isinstance(rows.raw(name), dict) and owner not in KINDS:
            below = rows.table(name, "a loop", remedy)
            yield from _bounds_below(below, path(owner, name) if owner else name, remedy)
        else:
            yield Bound(rows, name, owner)


def _check_pair(bound: Bound, remedy: str) -> None:
    value = bound.table.raw(bound.key)
    if not isinstance(value, list) or len(value) != 2:
        raise bound.table.wrong(bound.key, "a list of a low and a high bound", remedy)
