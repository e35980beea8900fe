"""The optimal control problem that a controller solves in every sample, from where the plant is."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from clepsydra.optimal_control.acting_model import ActingModel
from clepsydra.optimal_control.collocation import Collocation
from clepsydra.optimal_control.grid import Grid
from clepsydra.optimal_control.search import NoCourse, Search

#: An error below this share of its size counts by its square, so that noise moves little.
_SMALL = 0.05
#: What it costs to be beyond a limit of the plant by its range, in times of the largest error.
_BEYOND = 100.0
#: Where the bounds of errors stand in a guess.
_GUESSED = 0.1


class Now(NamedTuple):
    """Where a plant is, and where it is to go.

    Parameters
    ----------
    contents : ndarray [n]
        Scaled.
    load, last, low, high : ndarray [m]
        What is added to the inputs, what they were last, and their limits, shares of their range.
    setpoints : ndarray [q]
        [SI]
    """

    contents: np.ndarray
    load: np.ndarray
    last: np.ndarray
    low: np.ndarray
    high: np.ndarray
    setpoints: np.ndarray


class RecedingHorizon:
    """min Σ ∫ h(e/ē) dt + w Δt Σ (Δu/ū)² over the inputs, on the collocated process.

    h is Huber's: e/ē, but its square over twice a twentieth below a twentieth. In the programme
    it is v²/0.1 + s with -s ≤ e/ē - v ≤ s, so that no kink is left. The inputs are held in
    blocks of one sample and then run on straight lines, which join. What an optimum leaves at the
    end of the horizon counts as if it lasted for as long again, and so do the rates: it ends near
    rest. Limits of contents, and what would trip or run dry, may be passed at a price.

    P. J. Huber, Annals of Mathematical Statistics 35, 1964, doi 10.1214/aoms/1177703732.

    Parameters
    ----------
    model : ActingModel
    grid : Grid
    move_sizes : ndarray [m]
        ū, shares of the range.
    move_weight : float
        w [1]
    """

    def __init__(
        self, model: ActingModel, grid: Grid, move_sizes: np.ndarray, move_weight: float
    ) -> None:
        self.model, self.grid, self.rule = model, grid, Collocation(grid)
        weights, _ = self.rule.error_weights
        self._judged = np.flatnonzero(weights)
        self._weights = np.append(weights[self._judged], grid.horizon)
        contents, outputs = len(model.rest), len(model.plant.outputs)
        inputs, guards = len(model.moved), model.guards.numel_out()
        errors = outputs, len(self._weights)
        self._shapes = {
            "contents": (contents, self.rule.columns),
            "plan": (inputs, grid.blocks + 1),
            "square": errors,
            "beyond": errors,
            "passed": (contents, 1),
            "tripped": (guards, 1),
        }
        self._build(move_sizes, move_weight)

    def _build(self, move_sizes: np.ndarray, move_weight: float) -> None:
        model, grid, rule = self.model, self.grid, self.rule
        unknowns = {name: ca.MX.sym(name, *shape) for name, shape in self._shapes.items()}
        x, plan, square, beyond, passed, tripped = unknowns.values()
        start, load, last = (ca.MX.sym("p", size) for size in (x.size1(), *2 * [plan.size1()]))
        setpoints = ca.MX.sym("r", square.size1())
        columns, judged = rule.columns, square.size2()
        blocks = range(grid.blocks)
        u = plan[:, :-1] @ rule.along(blocks, 1.0 - rule.ramp)
        u += plan[:, 1:] @ rule.along(blocks, rule.ramp)
        held = x, u, ca.repmat(load, 1, columns)
        rates = model.rates.map(columns)(*held)
        durations = ca.DM(np.tile(rule.durations, (x.size1(), 1)))
        defects = ca.horzcat(start, x) @ rule.differences - rates * durations
        ends = ca.horzcat(x[:, self._judged.tolist()], x[:, -1])
        errors = model.errors.map(judged)(ends, ca.repmat(setpoints, 1, judged)) - square
        low, high = (np.reshape(end, (-1, 1)) for end in model.bounds)
        rows: list[tuple[ca.MX, ArrayLike, ArrayLike]] = [
            (defects, 0.0, 0.0),
            (beyond - errors, 0.0, np.inf),
            (beyond + errors, 0.0, np.inf),
            (x + ca.repmat(passed, 1, columns), np.tile(low, (1, columns)), np.inf),
            (x - ca.repmat(passed, 1, columns), -np.inf, np.tile(high, (1, columns))),
        ]
        if tripped.numel():
            guards = model.guards.map(columns)(*held) - ca.repmat(tripped, 1, columns)
            rows.append((guards, -np.inf, 0.0))
        shapes, below, above = zip(*((row.shape, *ends) for row, *ends in rows), strict=True)
        self._g_bounds = [
            np.concatenate(
                [np.broadcast_to(e, s).ravel(order="F") for e, s in zip(ends, shapes, strict=True)]
            )
            for ends in (below, above)
        ]
        slopes = ca.DM(np.sqrt(1.0 / np.array(grid.lengths, float)))
        moves = ca.horzcat(plan[:, 0] - last, (plan[:, 1:] - plan[:, :-1]) @ ca.diag(slopes))
        each = ca.DM(np.tile(self._weights, (square.size1(), 1)))
        rest = rates[:, -1] * grid.horizon
        objective = (
            ca.dot(each, square**2 / (2.0 * _SMALL) + beyond)
            + move_weight * grid.period * ca.sumsqr(moves / ca.DM(move_sizes))
            + grid.horizon * (ca.sumsqr(rest) + _BEYOND * (ca.sum1(passed) + ca.sum1(tripped)))
        )
        problem = {
            "x": ca.veccat(*unknowns.values()),
            "f": objective,
            "g": ca.vertcat(*(ca.vec(row) for row, _, _ in rows)),
            "p": ca.vertcat(start, load, last, setpoints),
        }
        self._search = Search(problem, expand=True)

    def solve(self, now: Now, plan: np.ndarray) -> np.ndarray:
        """Return the best inputs at the ends of the blocks [m, blocks + 1].

        Parameters
        ----------
        now : Now
        plan : ndarray [m, blocks + 1]
            Where the search begins; a second one begins at rest.

        Raises
        ------
        NoCourse
            None was found.
        KeyboardInterrupt
            It was interrupted.
        """
        still = np.tile(self.model.inputs_at_rest[:, None], (1, plan.shape[1]))
        try:
            return self._solved(now, now.contents, plan)
        except NoCourse:
            return self._solved(now, self.model.rest, still)

    def _solved(self, now: Now, contents: np.ndarray, plan: np.ndarray) -> np.ndarray:
        below, above = self._bounds(now)
        guess = {
            name: np.full(shape, _GUESSED if name == "beyond" else 0.0)
            for name, shape in self._shapes.items()
        }
        guess["contents"] = np.tile(contents[:, None], (1, self.rule.columns))
        guess["plan"] = plan
        given = np.concatenate([now.contents, now.load, now.last, now.setpoints])
        low, high = self._g_bounds
        found = self._search(
            x0=np.clip(_flat(guess), below, above), p=given,
            lbx=below, ubx=above, lbg=low, ubg=high,
        )  # fmt: skip
        first = self._shapes["contents"][0] * self._shapes["contents"][1]
        values = np.array(found["x"]).ravel()[first : first + plan.size]
        return values.reshape(plan.shape, order="F")

    def _bounds(self, now: Now) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends between which the unknowns may be."""
        shapes = self._shapes
        below = {name: np.full(shape, -np.inf) for name, shape in shapes.items()}
        above = {name: np.full(shape, np.inf) for name, shape in shapes.items()}
        for name in ("beyond", "passed", "tripped"):
            below[name] = np.zeros(shapes[name])
        below["plan"], above["plan"] = (
            np.broadcast_to(end[:, None], shapes["plan"]) for end in (now.low, now.high)
        )
        return _flat(below), _flat(above)

    def shifted(self, plan: np.ndarray) -> np.ndarray:
        """Return a plan as it is one sample later: each line goes on, and the end stays."""
        times = np.append(self.grid.starts, self.grid.horizon)
        later = times + self.grid.period
        return np.stack([np.interp(later, times, row) for row in plan])


def _flat(parts: dict[str, np.ndarray]) -> np.ndarray:
    return np.concatenate([np.ravel(part, order="F") for part in parts.values()])
