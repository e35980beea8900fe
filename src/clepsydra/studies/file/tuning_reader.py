"""The table of a study file that asks for a tuning."""

from __future__ import annotations

import math
from collections.abc import Iterator

from clepsydra.base.signal import path
from clepsydra.base.suggestion import suggestion
from clepsydra.designs.loops.detuning import SENSITIVITY_LIMIT
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.scores.catalogue import SCORES
from clepsydra.studies.file.gains import read_value
from clepsydra.studies.file.placed import placed
from clepsydra.studies.file.tuning_bound import Bound
from clepsydra.studies.file.tuning_request import TuningRequest
from clepsydra.studies.file.weight_bounds import WeightedStart
from clepsydra.studies.tuning.lqi_weights import KINDS
from clepsydra.studies.tuning.objective import Limits, Objective, judged

TUNING_KEYS = (
    "objective",
    "method",
    "parameters",
    "maximum_sensitivity",
    "overshoot",
    "total_variation",
)
_WEIGHT_REMEDY = (
    'write as in inputs.pump = [1e-3, 1e3] or states."tank.level" = [1e-3, 1e3], in quotes where '
    "a name has a dot"
)
_NAMES = 'write as in objective = "iae", ["iae[level_1]", "ise[level_2]"] or { iae = 1.0 }'


def read_tuning(
    table: TableReader,
    process: Process,
    weighted: WeightedStart | None = None,
) -> TuningRequest:
    """Read what a controller is to be tuned for.

    Without an objective it is the largest IAE of the controlled measurements, each relative to
    the start. Without parameters the gains and integral times of all loops are tuned, each within
    a factor of ten; of a design by weights the weights, within a factor of a thousand. Without a
    limit max|S| is kept at 2.

    Parameters
    ----------
    table : TableReader
        With `TUNING_KEYS`.
    process : Process
    weighted : callable, optional
        What makes the start of a design by weights.

    Raises
    ------
    InputError
        A score cannot be tuned for, a weight or limit is wrong, or bounds are no two quantities
        in order.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b'''objective = "iae"
    ... maximum_sensitivity = 1.7'''
    >>> table = TableReader(parse(text, "study.toml"), (), TUNING_KEYS)
    >>> found = read_tuning(table, load_process("quadruple-tank"))
    >>> found.objective.words
    'the larger of IAE of level_1 and IAE of level_2, each relative to the start'
    """
    with placed(table):
        objective = _objective(table, process)
        limits = _limits(table, process)
    return TuningRequest(table, objective, limits, _bounds(table), weighted)


def _objective(table: TableReader, process: Process) -> Objective:
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
        raise table.refused("objective", shown_value(written), "a score, or several", _NAMES)
    weighted = "weighted" if isinstance(written, dict) else "minimax"
    method = table.choice("method", ("minimax", "weighted"), weighted)
    return Objective("minimax" if method == "minimax" else "weighted", weights)


def _scores(table: TableReader, name: str, process: Process) -> list[str]:
    """Return the scores of single signals that a name stands for."""
    score, bracket, rest = name.partition("[")
    if score not in judged() or (bracket and not rest.endswith("]")):
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
    if not bracket:
        return [f"{score}[{signal}]" for signal in known]
    if rest[:-1] not in known:
        raise table.refused(
            "objective",
            name[:60],
            f"{score} of one of {', '.join(known)}",
            suggestion(rest[:-1], known, "choose one of them"),
        )
    return [name]


def _limits(table: TableReader, process: Process) -> Limits:
    moved = {}
    if table.has("total_variation"):
        row = table.table(
            "total_variation",
            "manipulated variables with their largest total variation",
            f'write as in {{ {process.inputs[0].name} = "300 %" }}',
            [signal.name for signal in process.inputs],
        )
        for name in row.present:
            moved[name] = read_value(
                row,
                name,
                process.signal(name),
                "a total variation",
                "give the sum of all moves",
                change=True,
            )
            if not moved[name] > 0.0:
                raise row.refused(
                    name, row.written(name), "a total variation above 0", "give the sum of moves"
                )
    overshoot = math.inf
    if table.has("overshoot"):
        overshoot = 100.0 * table.quantity(
            "overshoot",
            "1",
            "an overshoot",
            'write as in "10 %" of the step',
            at_least=0.0,
            at_most=1.0,
        )
    return Limits(
        table.quantity(
            "maximum_sensitivity",
            "1",
            "a number",
            "1.4 to 2 is customary",
            above=1.0,
            default=SENSITIVITY_LIMIT,
        ),
        overshoot,
        moved,
    )


def _bounds(table: TableReader) -> tuple[Bound, ...] | None:
    """Return the bounds of each parameter: of a key of a loop, or of the law itself."""
    if not table.has("parameters"):
        return None
    remedy = 'write as in level.gain = ["0.1 %/%", "10 %/%"], or leave parameters out'
    rows = table.table("parameters", "parameters with their bounds", remedy)
    found = list(_bounds_below(rows, None, remedy))
    if not found:
        raise table.refused("parameters", "none", "at least one parameter", remedy)
    for bound in found:
        _check_pair(bound, _WEIGHT_REMEDY if bound.owner in KINDS else remedy)
    return tuple(found)


def _bounds_below(rows: TableReader, owner: str | None, remedy: str) -> Iterator[Bound]:
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
        raise bound.table.refused(
            bound.key, shown_value(value), "a list of a low and a high bound", remedy
        )
