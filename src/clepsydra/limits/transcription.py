"""Direct transcription: the best input of an event as a nonlinear programme, solved by IPOPT."""

from __future__ import annotations

import casadi as ca
import numpy as np

from clepsydra.limits.course import Course
from clepsydra.limits.event import Event
from clepsydra.optimal_control.collocation import Collocation
from clepsydra.optimal_control.grid import Grid
from clepsydra.optimal_control.plant_model import PlantModel
from clepsydra.optimal_control.search import Search

#: What may be left of the rates at the end, as the way in another horizon [share of the range],
#: and of the errors [steps].
_REST = 1e-6
#: What it costs to hold an input a whole range away from where it rests at the end [1]: of several
#: inputs that do the same, and of many courses, it chooses the quiet one.
_QUIET = 1e-5


class Transcription:
    """The collocated process with the input of least error between its limits.

    The unknowns are the contents at the points, the inputs at both ends of each block (one value
    in a block of one sample, which holds it), what enters the delays at the points, and for each
    error a bound s with -s ≤ e ≤ s whose integral is minimised. What leaves a delay is the
    polynomial of what has entered it, one delay earlier. At the end everything that acts on the
    outputs rests, with every output at its setpoint.

    Parameters
    ----------
    event : Event
    model : PlantModel
        Of the event.
    grid : Grid
    """

    def __init__(self, event: Event, model: PlantModel, grid: Grid) -> None:
        self.event, self.model, self.grid = event, model, grid
        self.rule = Collocation(grid)
        contents, inputs, delays, _ = model.sizes
        blocks, columns = grid.blocks, self.rule.columns
        self._sloping = [b for b, length in enumerate(grid.lengths) if length > 1]
        weights, self._first_weight = self.rule.error_weights
        self._judged = np.flatnonzero(weights)
        self._shapes = [
            (contents, columns),
            (inputs, blocks),
            (inputs, len(self._sloping)),
            (delays, columns),
            (len(self.event.outputs), len(self._judged)),
        ]
        self._build(weights[self._judged])

    def _build(self, weights: np.ndarray) -> None:
        model, grid, event, rule = self.model, self.grid, self.event, self.rule
        names = ("contents", "first", "last", "sent", "bound")
        unknowns = [ca.MX.sym(n, *shape) for n, shape in zip(names, self._shapes, strict=True)]
        x, first, last, sent, bound = unknowns
        columns = rule.columns
        begin, delayed_before = model.start
        u = first @ rule.along(range(grid.blocks), 1.0 - rule.ramp)
        u += last @ rule.along(self._sloping, rule.ramp)
        z, loads = self._delayed(sent, delayed_before), self._loads().T
        held = x, u, z, loads
        rates = model.rates.map(columns)(*held)
        durations = ca.DM(np.tile(rule.durations, (model.sizes[0], 1)))
        rows: list[tuple[ca.MX, float, float]] = [
            (ca.horzcat(ca.DM(begin), x) @ rule.differences - rates * durations, 0.0, 0.0)
        ]
        if delayed_before.size:
            rows.append((sent - model.sent.map(columns)(*held), 0, 0))
        targets = self._setpoints()
        errors = model.errors_to.map(len(self._judged))(x[:, self._judged], targets[self._judged].T)
        rows += [(bound - errors, 0, np.inf), (bound + errors, 0, np.inf)]
        if not event.overshoot:
            stepped = event.outputs.index(event.segment.signal)
            way = np.sign(event.segment.size)
            rows.append((errors[stepped, :] * way, -np.inf, 1e-9))
        if model.guards.numel_out():
            rows.append((model.guards.map(columns)(*held), -np.inf, 0))
        final = model.errors_to(x[:, -1], targets[-1])
        rest = rates[model.acting, -1] * grid.horizon
        rows += [(final, -_REST, _REST), (rest, -_REST, _REST)]
        g = ca.vertcat(*(ca.vec(row) for row, _, _ in rows))
        self._g_bounds = tuple(
            np.concatenate([np.full(row[0].numel(), row[side], float) for row in rows])
            for side in (1, 2)
        )
        self._weights_of_bounds = np.tile(weights, (bound.shape[0], 1))
        parts_of_time = ca.DM(np.tile(rule.parts_of_time, (u.shape[0], 1)))
        away = ca.sumsqr((u - ca.DM(model.target_inputs)) * ca.sqrt(parts_of_time))
        objective = ca.dot(ca.DM(self._weights_of_bounds), bound) + _QUIET * away
        problem = {"x": ca.veccat(*unknowns), "f": objective, "g": g}
        self._search = Search(problem)
        start = np.abs(np.array(model.errors_to(begin, targets[0])))
        self._constant = self._first_weight * float(start.sum())

    def solve(self, guess: Course) -> Course:
        """Return the best course from a guess.

        Raises
        ------
        NoCourse
            None was found.
        KeyboardInterrupt
            It was interrupted.
        """
        low, high = (self._flat(side) for side in self._unknown_bounds())
        start = np.clip(self._guessed(guess), low, high)
        below, above = self._g_bounds
        found = self._search(x0=start, lbx=low, ubx=high, lbg=below, ubg=above)
        parts = self._parts(np.array(found["x"]).ravel())
        contents, first, sloping, _, bound = parts
        last = first.copy()
        last[:, self._sloping] = sloping
        index = float(np.sum(self._weights_of_bounds * bound)) + self._constant
        return Course(self.grid, self.rule.shares, contents, first, last, index)

    def resting(self, contents: np.ndarray, inputs: np.ndarray) -> Course:
        """Return the course that stays at contents and inputs, as a guess."""
        columns, blocks = self.rule.columns, self.grid.blocks
        still = np.tile(inputs[:, None], (1, blocks))
        shown = np.tile(contents[:, None], (1, columns))
        return Course(self.grid, self.rule.shares, shown, still, still, np.inf)

    def _guessed(self, guess: Course) -> np.ndarray:
        model, columns = self.model, self.rule.columns
        errors = model.errors_to.map(columns)(guess.contents, self._setpoints().T)
        bound = np.abs(np.array(errors)[:, self._judged]) + 1e-2
        sent = np.tile(model.target[1][:, None], (1, columns))
        parts = [guess.contents, guess.first, guess.last[:, self._sloping], sent, bound]
        return self._flat(parts)

    def _unknown_bounds(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        low, high = self.model.bounds
        ends = ((low, 0.0, 0.0, -np.inf, 0.0), (high, 1.0, 1.0, np.inf, np.inf))
        below, above = (
            [
                np.broadcast_to(np.reshape(np.asarray(end, float), (-1, 1)), shape)
                for end, shape in zip(side, self._shapes, strict=True)
            ]
            for side in ends
        )
        return below, above

    def _flat(self, parts: list[np.ndarray]) -> np.ndarray:
        return np.concatenate([np.ravel(part, order="F") for part in parts])

    def _parts(self, values: np.ndarray) -> list[np.ndarray]:
        found, place = [], 0
        for rows, columns in self._shapes:
            part = values[place : place + rows * columns]
            found.append(part.reshape(rows, columns, order="F"))
            place += rows * columns
        return found

    def _delayed(self, sent: ca.MX, before: np.ndarray) -> ca.MX | ca.DM:
        """Return what comes out of the delays at the points, from what entered them."""
        delays = self.event.process.motion.delays
        if not delays:
            return ca.DM(0, self.rule.columns)
        rows = []
        for row, delay in enumerate(delays):
            taken, still = self.rule.earlier(delay.time)
            rows.append(sent[row, :] @ taken + ca.DM(still * before[row]).T)
        return ca.vertcat(*rows)

    def _setpoints(self) -> np.ndarray:
        """Return the setpoints at the points [3 blocks, outputs]."""
        held = self.event.held(self.event.setpoints, self.grid.samples)
        return held[self.rule.samples]

    def _loads(self) -> np.ndarray:
        held = self.event.held(self.event.disturbances, self.grid.samples)
        return held[self.rule.samples]
