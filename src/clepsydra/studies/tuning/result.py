"""What a tuning found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.studies.tuning.pareto import ParetoFront


@dataclass(frozen=True, eq=False)
class TuningResult:
    """The best controller of a tuning, and how it was found.

    Parameters
    ----------
    controller : Controller
        With the values found; its design sentence and notes say how.
    objective, start_objective : float
    scores, start_scores : dict
        "score[signal]" to value, of everything that was minimised or limited.
    maximum_sensitivity, start_maximum_sensitivity : float
        max|S| of all loops together [1].
    binding : tuple of str
        In words: the limits and bounds that the best candidate stands on.
    evaluations : int
        Different candidates simulated, probes for derivatives included.
    history : ndarray [steps, 2]
        Number of evaluations and the best objective by then, whenever it fell; the last is that
        of the controller, whose values are rounded.
    front : ParetoFront
        Objective against max|S|.
    seed : int
    interrupted : bool
        Whether it was stopped before its end; the controller is then the best so far.
    tuned : dict
        What was tuned to the value found: parameters of the law, or design numbers.
    """

    controller: Controller
    objective: float
    start_objective: float
    scores: dict[str, float]
    start_scores: dict[str, float]
    maximum_sensitivity: float
    start_maximum_sensitivity: float
    binding: tuple[str, ...]
    evaluations: int
    history: np.ndarray
    front: ParetoFront
    seed: int
    interrupted: bool
    tuned: dict[str, float]
