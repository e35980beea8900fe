"""Which case of a study is the worst for a controller."""

from __future__ import annotations

import math
from typing import NamedTuple

from clepsydra.studies.result import Candidate


class Case(NamedTuple):
    """A case by its name, and the candidate there; None where it does not apply."""

    name: str
    candidate: Candidate | None


def worst_case(candidate: Candidate) -> Case:
    """Return where a controller has the largest error beside the best.

    Of several it is the one in which it can be trusted least.
    """
    return Case(*max(candidate.cases.items(), key=lambda item: (_error(item[1]), *_doubt(item[1]))))


def least_trusted_case(candidate: Candidate) -> Case:
    """Return where a controller can be trusted least, and has the thinnest margins there."""
    return Case(*max(candidate.cases.items(), key=lambda item: _doubt(item[1])))


def _error(candidate: Candidate | None) -> float:
    """Return the error to compare by: none does worse than what does not apply."""
    if candidate is None:
        return math.inf
    return min(candidate.mean_error, 1e300)


def _doubt(candidate: Candidate | None) -> tuple[float, float]:
    if candidate is None:
        return math.inf, 0.0
    peak = candidate.maximum_sensitivity
    return float(candidate.standing), 0.0 if math.isnan(peak) else peak
