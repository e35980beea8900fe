"""A score as it is declared: once, in the file that computes it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.registry import Registry
from clepsydra.scores.marks import along, elapsed
from clepsydra.scores.sample import Expression, Fold, Sample
from clepsydra.scores.trajectory import read_trajectories

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.scores.scored_run import ScoredRun


class Of(Enum):
    """What a score is of, in the order of tables."""

    CONTROLLED = "controlled measurement"
    AVERAGING = "averaging measurement"
    BAND = "averaging measurement with a band"
    MANIPULATED = "manipulated variable"
    PUMP = "pump"
    TANK = "tank"
    INNER_LOOP = "inner loop"
    LEVEL = "level"

    def signals(self, process: Process) -> tuple[str, ...]:
        """Return the signals of a process that a batch can judge."""
        if self is Of.CONTROLLED:
            return tuple(process.controlled)
        if self is Of.AVERAGING:
            return tuple(process.averaging)
        if self is Of.BAND:
            return tuple(process.bands)
        if self is Of.MANIPULATED:
            return tuple(signal.name for signal in process.inputs)
        if self is Of.LEVEL:
            return tuple(x.name for x in process.state if x.name in process.levels)
        return ()


class Ranks(Enum):
    """What controllers are ranked for by a score, where a study asks for no scores."""

    HELD = "levels that are held at their setpoints"
    AVERAGING = "levels that average a flow"
    AVERAGING_FREELY = "levels that average a flow and have no band"
    MOVEMENT = "what the manipulated variables move"


@dataclass(frozen=True, eq=False)
class Score:
    """What a run was worth in one respect, for one signal.

    A score with an `integrand` is made sample by sample. The same function is part of the kernel in
    a batch, which stores no trajectories, and runs along the trajectories of a stored run; a tuning
    can be for it. Any other score is found `over` a stored run.

    Parameters
    ----------
    key : str
        Its name in results; a score of one signal has the key "key[signal]".
    title : str
        As in the head of a table.
    description : str
        One sentence, with the definition.
    powers : tuple of int
        Of the signal's unit and of seconds, of which its unit is made.
    unit : str
        Its unit where it is another: that of the value as it stands.
    phrase : str
        What a sentence calls it, where that is not the title.
    wants : {"", "setpoint", "load", "noise", "own step", "head"}
        Without what there is no such score: a kind of segment, a step of the signal's own setpoint
        that the controller follows, or a head of the pump that is known.
    ranks : Ranks, optional
        What controllers are ranked for by it.
    negligible : float, optional
        What counts as nothing where controllers are compared, in `unit`; of one in the unit of its
        signal a share of the signal's range.
    integrand : callable, optional
        Sample to the value that is folded, or to several where `finish` makes one of their folds.
    finish : callable, optional
        Folds to the score, which is left out where that is not a number.
    over : callable, optional
        Run and signal to the score; None where the run does not tell.

    Examples
    --------
    >>> from clepsydra.scores.score import SCORES
    >>> SCORES["iae"].title, SCORES["iae"].unit_rule
    ('IAE', 'signal unit × s')
    >>> SCORES["iae"].along([0.0, 2.0, 4.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0])
    1.0
    """

    key: str
    title: str
    description: str
    of: Of = Of.CONTROLLED
    powers: tuple[int, int] = (0, 0)
    unit: str = ""
    phrase: str = ""
    smaller_is_better: bool = True
    wants: str = ""
    ranks: Ranks | None = None
    negligible: float | None = None
    integrand: Callable[[Sample], Any] | None = None
    fold: Fold = Fold.INTEGRAL
    finish: Callable[..., Any] | None = None
    over: Callable[[ScoredRun, str], float | None] | None = None

    @property
    def is_running(self) -> bool:
        """Whether a batch can add it up while its loops run."""
        return self.integrand is not None and self.of not in (Of.PUMP, Of.TANK, Of.INNER_LOOP)

    @property
    def words(self) -> str:
        """Its name within a sentence."""
        return self.phrase or in_sentence(self.title)

    @property
    def unit_rule(self) -> str:
        """Its unit in words, from the unit of the signal that it judges."""
        parts = zip(("signal unit", "s"), self.powers, strict=True)
        words = [f"{word}{'²' if power == 2 else ''}" for word, power in parts if power]
        return self.unit or " × ".join(words)

    def registered(self) -> Score:
        """Make it known to runs, batches, tunings, study files and reports, and return it.

        Raises
        ------
        InputError
            Another one has its key.
        """
        return SCORES.add(self.key, self)

    def values(self, sample: Sample) -> tuple[Expression, ...]:
        """Return what is folded of a sample."""
        assert self.integrand is not None
        found = self.integrand(sample)
        return found if isinstance(found, tuple) else (found,)

    def folded(self, sample: Sample) -> float:
        """Return the score of all samples of a run, whose fields are arrays."""
        # A square beyond the largest number is rightly infinite, and 0/0 is chosen nowhere.
        with np.errstate(all="ignore"):
            shape = np.shape(sample.length)
            values = [np.broadcast_to(value, shape) for value in self.values(sample)]
            folds = [self.fold.over(value, sample) for value in values]
        folds = [math.inf if math.isnan(fold) else fold for fold in folds]
        return float(self.finish(*folds)) if self.finish else folds[0]

    def along(self, time: ArrayLike, *signals: ArrayLike, steps: ArrayLike = ()) -> float:
        """Return the score of one response, without segments.

        The signals are setpoint and output without measurement noise, or a manipulated variable
        [n] [signal unit], of samples that start at `time` [s]; time begins to count anew at the
        `steps` [s]. The score is infinite where a value is not finite.

        Examples
        --------
        A constant error of 1 costs 2² / 2 in two seconds, and as much again after a step:

        >>> from clepsydra.scores.iae import ITAE
        >>> ITAE.along([0.0, 2.0, 4.0], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0], steps=[2.0])
        4.0
        """
        clock, (*setpoint, judged), complete = read_trajectories(time, *signals)
        counted = elapsed(clock, steps)
        if not complete:
            return float("inf")
        reference = setpoint[0] if setpoint else np.zeros(clock.size)
        sample = along(clock, {"elapsed": counted}, now=judged, next_setpoint=reference)
        return self.folded(sample)


#: Score by key, in the order of tables: by what it is of, then as the files build on each other.
SCORES = Registry[Score]("clepsydra.scores", order=lambda score: list(Of).index(score.of))


def in_sentence(title: str) -> str:
    """Return a title as it stands within a sentence; an abbreviation stays.

    Examples
    --------
    >>> in_sentence("Total variation"), in_sentence("IAE, load"), in_sentence("load error")
    ('total variation', 'IAE, load', 'load error')
    """
    return title if title[:2].isupper() else f"{title[:1].lower()}{title[1:]}"
