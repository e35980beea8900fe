"""The table of a study file that asks for a tuning."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import path
from clepsydra.base.suggestion import suggestion
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.process import told
from clepsydra.process.declared import part, read_fields
from clepsydra.process.errors_at import errors_at
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_value
from clepsydra.process.table_reader import TableReader
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import ScoreKey, score_key
from clepsydra.studies.file.tuning_bounds import Bound
from clepsydra.studies.file.tuning_request import TuningRequest, WeightedStart
from clepsydra.studies.tuning.lqi_weights import KINDS
from clepsydra.studies.tuning.objective import Limits, Objective, judged

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
    objective : Objective
    bounds : tuple of Bound or None
    total_variation : dict
        Manipulated variable to its limit [its unit].
    maximum_sensitivity, overshoot : float
        Limits [1]
    """

    objective: Objective = part(
        lambda table, key, known: _objective(table, known["process"]),
        {
            "objective": {
                "description": "a score, a list of scores, or a table of scores with weights; a "
                "score is of all its signals or of one",
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
        "a limit of the overshoot of every setpoint step, a share of the step",
        at_least=0.0,
        at_most=1.0,
        default=math.inf,
        absent=math.inf,
        remedy='write as in "10 %" of the step',
    )


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
        With the keys of `Tuning`.
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
    >>> table = TableReader(parse(text, "study.toml"), (), None)
    >>> found = read_tuning(table, load_process("quadruple-tank"))
    >>> found.objective.words
    'the larger of IAE of level_1 and IAE of level_2, each relative to the start'
    """
    with errors_at(table):
        read = Tuning(**read_fields(Tuning, table, process=process))
        limits = Limits(read.maximum_sensitivity, 100.0 * read.overshoot, read.total_variation)
    return TuningRequest(table, read.objective, limits, read.bounds, weighted)


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
        raise table.wrong("objective", "a score, or several", _NAMES)
    weighted = "weighted" if isinstance(written, dict) else "minimax"
    method = table.choice("method", METHODS, weighted)
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
