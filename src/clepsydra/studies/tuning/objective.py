"""What a tuning minimises, and what it must keep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import Literal

import numpy as np

from clepsydra.base.arguments import is_finite_number, require_type
from clepsydra.base.errors import InputError
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key

#: Above its limit by this share, a candidate still counts as one that stands on it.
ON_LIMIT = 1e-6


def judged() -> tuple[str, ...]:
    """Return the scores that a tuning can be for: a batch knows them, and they can be too large.

    Examples
    --------
    >>> judged()[:2]
    ('ie', 'iae')
    """
    return tuple(key for key, s in SCORES.items() if s.is_running and s.smaller_is_better)


@dataclass(frozen=True)
class Objective:
    """One number from several scores: the largest of them, or their sum; see the makers below.

    Parameters
    ----------
    kind : {"minimax", "weighted"}
    weights : dict
        "score[signal]" to its weight, above zero.
    relative : bool
        Whether each score is divided by its value at the start.

    Raises
    ------
    InputError
        There is no score, one cannot be tuned for, or a weight is not above zero.

    Examples
    --------
    >>> minimax("iae[level_1]", "iae[level_2]").words
    'the larger of IAE of level_1 and IAE of level_2, each relative to the start'
    >>> minimax("iae[a]", "iae[b]", "overshoot[a]", relative=False).words
    'the largest of IAE of a, IAE of b and overshoot of a'
    """

    kind: Literal["minimax", "weighted"]
    weights: dict[str, float]
    relative: bool = True

    def __post_init__(self) -> None:
        if not self.weights:
            raise InputError("tuning, objective", "none", "a score", 'name one: "iae[level_1]"')
        for name, weight in self.weights.items():
            key = score_key(name)
            if key.score not in judged() or not key.signal:
                raise InputError(
                    "tuning, objective",
                    name,
                    f"one of {', '.join(judged())}, of a signal",
                    'write as in "iae[level_1]"',
                )
            if not is_finite_number(weight) or not weight > 0.0:
                raise InputError(
                    f"tuning, objective, {name}", weight, "a weight above 0", "correct the weight"
                )

    @property
    def names(self) -> tuple[str, ...]:
        """The scores that it is made of."""
        return tuple(self.weights)

    def parts(self, scores: Mapping[str, np.ndarray], start: Mapping[str, float]) -> np.ndarray:
        """Return every score with its weight and scale [n, scores]."""
        columns = [
            weight * scores[name] / (start[name] if self.relative else 1.0)
            for name, weight in self.weights.items()
        ]
        return np.stack(columns, axis=1)

    def value(self, parts: np.ndarray) -> np.ndarray:
        """Return the objective [n] from the parts [n, scores]."""
        found = np.max(parts, axis=1) if self.kind == "minimax" else np.sum(parts, axis=1)
        return np.asarray(found)

    def check_start(self, start: Mapping[str, float]) -> None:
        """Refuse scores of the start that nothing can be related to.

        Raises
        ------
        InputError
        """
        for name in self.names:
            value = start[name]
            if self.relative and not (math.isfinite(value) and value != 0.0):
                raise InputError(
                    f"tuning, objective, {name}",
                    value,
                    "a finite score above 0 at the start",
                    "start from a controller that holds the loop, or take relative=False",
                )

    @property
    def words(self) -> str:
        """The objective as a phrase."""
        named = []
        for name, weight in self.weights.items():
            key = score_key(name)
            times = "" if weight == 1.0 else f"{weight:g} × "
            named.append(f"{times}{key.declared.words} of {key.signal}")
        if len(named) > 1:
            lead = {"minimax": f"the large{'r' if len(named) == 2 else 'st'} of ",
                    "weighted": "the sum of "}[self.kind]  # fmt: skip
        else:
            lead = ""
        joined = " and ".join([", ".join(named[:-1]), named[-1]] if len(named) > 1 else named)
        scale = ", each relative to the start" if len(named) > 1 else ", relative to the start"
        return f"{lead}{joined}{scale if self.relative else ''}"


_BY_NAMES = 'write as in minimax("iae[level_1]", "iae[level_2]")'


def minimax(*scores: str, relative: bool = True) -> Objective:
    """Return the objective "the largest of some scores".

    Examples
    --------
    >>> minimax("iae[level_1]", relative=False).value(np.array([[3.0, 5.0]])).tolist()
    [5.0]
    """
    for score in scores:
        require_type(score, str, "tuning, objective", "the name of a score", _BY_NAMES)
    return Objective("minimax", dict.fromkeys(scores, 1.0), relative)


def weighted_sum(weights: Mapping[str, float], *, relative: bool = True) -> Objective:
    """Return the objective "the sum of some scores, each by its weight".

    Examples
    --------
    >>> weighted_sum({"ise[level_1]": 1.0, "total_variation[pump_1]": 0.1}).words
    'the sum of ISE of level_1 and 0.1 × total variation of pump_1, each relative to the start'
    """
    _check_mapping(
        "tuning, objective", weights, "scores with their weights", '{"iae[level_1]": 1.0}'
    )
    return Objective("weighted", dict(weights), relative)


@dataclass(frozen=True)
class Limits:
    """What a tuned controller must keep.

    Parameters
    ----------
    maximum_sensitivity : float
        Largest max|S| of all loops together [1]; infinite for none.
    overshoot : float
        Largest overshoot of any setpoint step [% of the step]; infinite for none.
    total_variation : dict
        Manipulated variable to the largest total variation over the scenario [its unit].
    levels : dict
        "tank.level" to the lowest and the highest level that it may have at any time [m].

    Raises
    ------
    InputError
        A limit can be kept by no loop.

    Examples
    --------
    >>> Limits(maximum_sensitivity=0.9)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: tuning, limits, maximum_sensitivity: got 0.9, expected a \
number above 1; 1.4 to 2 is customary.
    """

    maximum_sensitivity: float = math.inf
    overshoot: float = math.inf
    total_variation: dict[str, float] = field(default_factory=dict)
    levels: dict[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        place = "tuning, limits"
        for name in ("maximum_sensitivity", "overshoot"):
            require_type(
                getattr(self, name), Real, f"{place}, {name}", "a number", "give it without quotes"
            )
        _check_mapping(
            f"{place}, total_variation", self.total_variation,
            "manipulated variables with their limits", '{"pump_1": 5.0}',
        )  # fmt: skip
        if not self.maximum_sensitivity > 1.0:
            raise InputError(
                f"{place}, maximum_sensitivity", self.maximum_sensitivity,
                "a number above 1", "1.4 to 2 is customary",
            )  # fmt: skip
        if not self.overshoot >= 0.0:
            raise InputError(
                f"{place}, overshoot", self.overshoot, "0 % or more", "correct the limit"
            )
        for name, limit in self.total_variation.items():
            if not isinstance(limit, Real) or not limit > 0.0:
                raise InputError(
                    f"{place}, total_variation, {name}",
                    limit,
                    "a number above 0",
                    f"give it in the unit of {name}",
                )
        _check_mapping(
            f"{place}, levels", self.levels, "levels with their lowest and highest value",
            '{"tank_1.level": (0.1, 0.9)}',
        )  # fmt: skip
        for name, ends in self.levels.items():
            pair = isinstance(ends, tuple | list) and len(ends) == 2
            if not pair or not all(map(is_finite_number, ends)) or not ends[0] < ends[1]:
                raise InputError(
                    f"{place}, levels, {name}",
                    ends if pair else "no pair of numbers",
                    "a lowest level below a highest one",
                    "give both in m",
                )


def _check_mapping(place: str, value: object, expected: str, example: str) -> None:
    remedy = f"write as in {example}"
    require_type(value, Mapping, place, expected, remedy)
    assert isinstance(value, Mapping)
    for name in value:
        require_type(name, str, place, expected, remedy)
