"""Which of two candidates is better, and what is said where none keeps its limits."""

from types import SimpleNamespace

import numpy as np

from clepsydra.studies.tuning.objective import Limits
from clepsydra.studies.tuning.result import why_none
from clepsydra.studies.tuning.standing import standings


def problem_of(violation, rooms):
    evaluated = SimpleNamespace(objective=np.full(len(rooms), 0.5), violation=np.array(violation))
    by_point = np.array(rooms)
    return SimpleNamespace(
        evaluate=lambda points: evaluated,
        consider=lambda points, found: None,
        loops=SimpleNamespace(rooms=lambda points, limit: by_point[points.astype(int)]),
        limits=Limits(2.0),
    )


def test_the_farther_beyond_its_limits_the_worse_and_unstable_worst_of_all():
    rooms = [0.1, -0.01, -0.5, -3.0, -np.inf]
    found = standings(problem_of([0.0] * 5, rooms), np.arange(5.0)[:, None])
    assert np.all(np.diff(found) > 0.0) and found[0] < 1.0 < found[1] and found[-1] == 2.0


def test_a_limit_of_coming_to_rest_is_named_where_nothing_keeps_it():
    loop = SimpleNamespace(process=None)
    problem = SimpleNamespace(
        limits=Limits(rest=7200.0), evaluations=9, limited={}, batch=SimpleNamespace(loop=loop)
    )
    assert "none of 9 candidates keeps rest within 120 min of a change" in why_none(problem)
