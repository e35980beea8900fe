"""What candidates of a tuning are judged by: a scenario, an objective, and limits to keep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key

if TYPE_CHECKING:
    from clepsydra.studies.tuning.draws import Draws

#: Above its limit by this share, a candidate still counts as one that stands on it.
ON_LIMIT = 1e-6


def judged() -> tuple[str, ...]:
    """Return the scores that a tuning can be for: a batch knows them, and they can be too large."""
    return tuple(key for key, s in SCORES.items() if s.is_running and s.smaller_is_better)


@dataclass(frozen=True)
class Objective:
    """One number from several scores: the largest, their sum or mean; see the makers below.

    Parameters
    ----------
    weights : dict
        "score[signal]" to its weight, above zero; of scores in `judged`.
    relative : bool
        Whether each score is divided by its value at the start.

    Examples
    --------
    >>> minimax("iae[level_1]", "iae[level_2]").words
    'the larger of IAE of level_1 and IAE of level_2, each relative to the start'
    """

    kind: Literal["minimax", "weighted", "mean"]
    weights: dict[str, float]
    relative: bool = True

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
        if self.kind == "minimax":
            return np.asarray(np.max(parts, axis=1))
        whole = sum(self.weights.values()) if self.kind == "mean" else 1.0
        return np.asarray(np.sum(parts, axis=1) / whole)

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
            times = "" if weight == 1.0 else f"{weight:.3g} × "
            named.append(f"{times}{key.declared.words} of {key.signal}")
        *others, last = named
        if not others:
            return f"{last}, relative to the start" if self.relative else last
        larger = "the larger of" if len(others) == 1 else "the largest of"
        lead = {"minimax": larger, "weighted": "the sum of", "mean": "the mean of"}[self.kind]
        scale = ", each relative to the start" if self.relative else ""
        return f"{lead} {', '.join(others)} and {last}{scale}"


def minimax(*scores: str, relative: bool = True) -> Objective:
    """Return the objective "the largest of some scores"."""
    return Objective("minimax", dict.fromkeys(scores, 1.0), relative)


def weighted_sum(weights: Mapping[str, float], *, relative: bool = True) -> Objective:
    """Return the objective "the sum of some scores, each by its weight"."""
    return Objective("weighted", dict(weights), relative)


def mean(weights: Mapping[str, float], *, relative: bool = True) -> Objective:
    """Return the objective "the mean of some scores", in which each has its weight."""
    return Objective("mean", dict(weights), relative)


@dataclass(frozen=True)
class Limits:
    """What a tuned controller must keep.

    Parameters
    ----------
    maximum_sensitivity : float
        Largest max|S| of all loops together [1], above 1; infinite for none.
    overshoot : float
        Largest overshoot of any setpoint step [% of the step]; infinite for none.
    overshoot_if_stepped : float
        The same, where the scenario steps a setpoint at all.
    noise_movement : float
        How far noise may throw a manipulated variable about, a share of its range [1]; infinite
        for as far as it will.
    damping : float
        Smallest damping ratio of what oscillates in the loops, 0 to 1 [1]; 0 for none.
    total_variation : dict
        Manipulated variable to the largest total variation over the scenario [its unit].
    levels : dict
        "tank.level" to the lowest and the highest level that it may have at any time [m].
    rest : float
        Longest time in which what is left of a change comes down to a hundredth [s]; infinite for
        none. Without it a level that averages never comes back: nothing else asks for that.
    """

    maximum_sensitivity: float = math.inf
    overshoot: float = math.inf
    overshoot_if_stepped: float = math.inf
    noise_movement: float = math.inf
    damping: float = 0.0
    total_variation: dict[str, float] = field(default_factory=dict)
    levels: dict[str, tuple[float, float]] = field(default_factory=dict)
    rest: float = math.inf


@dataclass(frozen=True, eq=False)
class Goal:
    """What is simulated of each candidate, what is to be small in it, and what must hold.

    Parameters
    ----------
    model : LinearModel
        Of the process at the operating point where the scenario begins, with every measurement
        that the controller reads.
    limits : Limits
        A tank that runs empty or over, a pump that runs dry and a trip are never let pass, unless
        they happen at the start as well, nor under load steps a level that leaves its band.
    draws : Draws, optional
        Drawn plants; what is to be small is then a quantile over them, and limits are those of
        the plant itself.
    """

    model: LinearModel
    scenario: Scenario
    objective: Objective
    limits: Limits = field(default_factory=Limits)
    draws: Draws | None = None
