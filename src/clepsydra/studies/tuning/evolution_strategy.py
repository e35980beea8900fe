"""The search around a good candidate: an evolution strategy that learns the shape of the valley."""

from __future__ import annotations

import numpy as np

from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.standing import standings

#: Candidates a round, which the kernel runs side by side, and rounds at most.
_LANES, _ROUNDS = 16, 60
#: How far apart the first ones lie, and where they have come together, shares of the way between
#: the bounds.
_WIDTH, _TOGETHER = 0.03, 1e-4
#: So many rounds that bring less than this share of the objective are the last.
_STILL, _WORTH = 20, 1e-3


def search_around(problem: TuningProblem, point: np.ndarray, *, seed: int) -> None:
    """Look for better candidates around a point [p]; the problem keeps the best.

    Errors and overshoots have kinks, along which the best candidates lie in narrow valleys: a
    local search by slopes comes to a stop at their edge, and a population that is spread over
    all bounds seldom meets them. The covariance matrix adaptation strategy takes on their shape.
    It only compares candidates, by `standing.standings`.

    References
    ----------
    N. Hansen, The CMA Evolution Strategy: A Tutorial, 2016, arXiv:1604.00772, figure 6 and table 1.
    """
    generator = np.random.Generator(np.random.PCG64(seed))
    n, parents = len(point), _LANES // 2
    weights = np.log(parents + 0.5) - np.log(np.arange(1, parents + 1))
    weights /= np.sum(weights)
    mass = 1.0 / float(np.sum(weights**2))  # µ_eff
    c_c = (4.0 + mass / n) / (n + 4.0 + 2.0 * mass / n)
    c_sigma = (mass + 2.0) / (n + mass + 5.0)
    c_1 = 2.0 / ((n + 1.3) ** 2 + mass)
    c_mu = min(1.0 - c_1, 2.0 * (mass - 2.0 + 1.0 / mass) / ((n + 2.0) ** 2 + mass))
    d_sigma = 1.0 + 2.0 * max(0.0, np.sqrt((mass - 1.0) / (n + 1.0)) - 1.0) + c_sigma
    usual = np.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))  # E‖N(0, I)‖
    centre, sigma, C = point.copy(), _WIDTH, np.eye(n)
    p_c, p_sigma = np.zeros(n), np.zeros(n)
    reached: list[float] = []
    for turn in range(1, _ROUNDS + 1):
        squares, B = np.linalg.eigh(C)
        D = np.sqrt(np.maximum(squares, np.finfo(float).tiny))
        drawn = sigma * (generator.standard_normal((_LANES, n)) * D) @ B.T
        points = np.clip(centre + drawn, 0.0, 1.0)
        order = np.argsort(standings(problem, points), kind="stable")[:parents]
        steps = (points[order] - centre) / sigma
        mean = weights @ steps
        centre = np.clip(centre + sigma * mean, 0.0, 1.0)
        whitened = B @ ((B.T @ mean) / D)
        p_sigma = (1.0 - c_sigma) * p_sigma + np.sqrt(c_sigma * (2.0 - c_sigma) * mass) * whitened
        length = float(np.linalg.norm(p_sigma))
        settled = length / np.sqrt(1.0 - (1.0 - c_sigma) ** (2 * turn))
        goes_on = settled < (1.4 + 2.0 / (n + 1.0)) * usual
        p_c = (1.0 - c_c) * p_c + goes_on * np.sqrt(c_c * (2.0 - c_c) * mass) * mean
        spread = (steps.T * weights) @ steps
        C = (1.0 - c_1 - c_mu) * C + c_1 * np.outer(p_c, p_c) + c_mu * spread
        sigma *= np.exp(c_sigma / d_sigma * (length / usual - 1.0))
        reached.append(problem.best.objective if problem.best else np.inf)
        still = turn > _STILL and not reached[-1] < (1.0 - _WORTH) * reached[-1 - _STILL]
        if still or sigma * np.sqrt(np.max(np.diag(C))) < _TOGETHER:
            return
