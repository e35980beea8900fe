"""The search for an equilibrium: Newton's method, damped, with exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.linear.equilibrium_request import EquilibriumRequest
from clepsydra.linear.linearise import Derivatives
from clepsydra.process.process import Process

# Singular values below this share of the largest count as zero.
RANK = 1e-12
_ITERATIONS = 200
_ROUNDING = 100.0 * float(np.finfo(float).eps)
# Newton's whole step, and where that gains nothing its half, a quarter and so on, down to 1e-10.
_WHOLE, _PARTS = np.ones(1), 0.5 ** np.arange(1, 34)
# So many numbers are found together, at points side by side.
_BLOCK = 2**18
# A ζ this close to zero is a level on its floor (ζ² = 1e-14 of the tank's height; so small a
# share of another unknown's span is a zero).
FLOOR = 1e-7
# An actuator beyond its range counts in a straight line from this share of it inside of its end,
# for at a stop there is no slope.
INSIDE = 1e-9
# The equations are continued in a straight line below this ζ; the floor has no derivative.
_CONTINUED = 1e-20


@dataclass(frozen=True)
class Iterate:
    """One step of the search, in scaled unknowns.

    Parameters
    ----------
    unknowns : ndarray [n + f]
        ζ of the states, then of the free inputs.
    residuals : ndarray [n + f]
        ẋ, then the asked outputs minus their targets, SI; no numbers where these, or their
        derivatives, have no value.
    jacobian : ndarray [n + f, n + f]
        Of the residuals by the unknowns.
    rounding_of : callable
        → what rounding alone may leave of each residual [n + f]: asked of what is followed, which
        few trials are.
    """

    unknowns: np.ndarray
    residuals: np.ndarray
    jacobian: np.ndarray
    rounding_of: Callable[[], np.ndarray]

    @cached_property
    def rounding(self) -> np.ndarray:
        """What rounding alone may leave of each residual [n + f]."""
        return self.rounding_of()

    @property
    def row_sizes(self) -> np.ndarray:
        """Largest entry of each row of the Jacobian, one for a row of zeros."""
        sizes = np.abs(self.jacobian).max(axis=1, initial=0.0)
        return np.where(sizes > 0.0, sizes, 1.0)

    @property
    def solved(self) -> bool:
        """Whether every residual is down to rounding."""
        return bool(np.all(np.abs(self.residuals) <= self.rounding))

    @property
    def finite(self) -> bool:
        """Whether the equations and their derivatives have values here."""
        return bool(np.isfinite(self.residuals).all())

    def newton_step(self) -> np.ndarray:
        """Return Newton's step; the shortest one where the Jacobian is singular."""
        sizes = self.row_sizes
        scaled = self.jacobian / sizes[:, None]
        step: np.ndarray = np.linalg.lstsq(scaled, -self.residuals / sizes, rcond=RANK)[0]
        return step


class EquilibriumSearch:
    """Newton's method for ẋ = 0 and y = target over the states and the free inputs.

    A level is written as x = floor + span ζ²: Torricelli's outflow is linear in ζ, so that a
    network of tanks takes a step or two. Below the floor the equations are continued
    in a straight line, so that an impossible request ends with ζ < 0 where a flow would have to
    be negative, and with the input that it would take. Other unknowns are span ζ; the inputs
    searched, and their actuators, are continued in a straight line beyond their ranges.
    """

    def __init__(self, process: Process, request: EquilibriumRequest) -> None:
        self.process = process
        self.request = request
        self.derivatives = Derivatives(process)
        self._rows, self._columns = list(request.outputs), list(request.free_inputs)
        free = [process.inputs[place] for place in request.free_inputs]
        self._signals = [*process.state, *free]
        asked = [process.measurements[place] for place in request.outputs]
        self.unknown_names = [signal.name for signal in self._signals]
        self.row_names = [signal.name for signal in (*process.state, *asked)]
        self.spans = np.array([_span(signal) for signal in self._signals])
        self.floors = np.array([signal.low for signal in process.state])
        # Only what drains by a root has a floor: a concentration, a speed or a valve position
        # may pass through zero on the way and stand there.
        metres = np.array([signal.unit == "m" for signal in process.state], bool)
        floored = np.isfinite(self.floors) & metres
        self.floored = np.concatenate([floored, np.zeros(len(free), bool)])
        names = {signal.name for signal in free}
        ends = [
            (s.low, s.high) if {s.name, s.owner} & names else (-np.inf, np.inf)
            for s in self._signals
        ]
        self.least, self.most = np.reshape(ends, (-1, 2)).T / self.spans
        self.origins = np.where(floored, self.floors, 0.0)
        self.continued = np.where(self.floored, _CONTINUED, -np.inf)

    def start(self, share: float | None) -> np.ndarray:
        """Return unknowns with every level at a share of its height, or at its initial value.

        An input that is searched for, and its actuator, stand at the same share of their range: a
        pump that lifts nothing where it begins has no slope there.
        """
        shares = np.zeros(len(self._signals))
        ranged = np.isfinite(self.least) & np.isfinite(self.most)
        for place, (signal, span) in enumerate(zip(self._signals, self.spans, strict=True)):
            inside = signal.low < signal.initial < signal.high
            if self.floored[place]:
                above = (signal.initial - signal.low) / span if inside else 0.5
                shares[place] = np.sqrt(above if share is None else share)
            elif share is not None and ranged[place]:
                low, high = self.least[place], self.most[place]
                shares[place] = low + share * (high - low)
            elif inside or not np.isfinite(signal.low + signal.high):
                shares[place] = signal.initial / span
            else:
                shares[place] = (signal.low + signal.high) / 2.0 / span
        return shares

    def values(self, unknowns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return state [..., n] and inputs [..., m], SI, of which these are the unknowns."""
        states = len(self.process.state)
        floored, scaled = self.floored[:states], unknowns[..., :states]
        straight = self._straight(unknowns)
        risen = np.where(scaled <= FLOOR, 0.0, scaled) ** 2
        levels = self.origins + self.spans[:states] * risen
        state = np.where(floored, levels, straight[..., :states])
        return state, self._inputs(unknowns)

    def _inputs(self, unknowns: np.ndarray) -> np.ndarray:
        inputs = np.empty((*unknowns.shape[:-1], len(self.request.inputs)))
        inputs[...] = self.request.inputs
        if self._columns:
            inputs[..., self._columns] = self._straight(unknowns)[..., len(self.origins) :]
        return inputs

    def _straight(self, unknowns: np.ndarray) -> np.ndarray:
        # Of a zero a processor leaves nothing, and another one a share of its own.
        return np.asarray(self.spans * np.where(np.abs(unknowns) <= FLOOR**2, 0.0, unknowns))

    def unknowns_at(self, state: np.ndarray, inputs: np.ndarray) -> np.ndarray:
        """Return the unknowns that stand for a state [n] and inputs [m], SI."""
        states = len(self.process.state)
        floored, spans = self.floored[:states], self.spans[:states]
        shares = (state - self.origins) / spans
        scaled = np.where(floored, np.sqrt(np.maximum(shares, 0.0)), shares)
        free = inputs[list(self.request.free_inputs)] / self.spans[states:]
        return np.concatenate([scaled, free])

    def state_slopes(self, unknowns: np.ndarray) -> np.ndarray:
        """Return dx/dζ of each state [..., n], SI."""
        states = len(self.origins)
        scaled, spans = unknowns[..., :states], self.spans[:states]
        return np.where(self.floored[:states], 2.0 * spans * scaled, spans)

    def run(self, share: float | None) -> Iterate:
        """Search from one start and return the last iterate, solved or not."""
        return self.run_from(self.start(share))

    def run_from(self, unknowns: np.ndarray) -> Iterate:
        """Search from given unknowns [n + f] and return the last iterate, solved or not."""
        ((_, first),) = self._evaluated(unknowns[None])
        current = first()
        for _ in range(_ITERATIONS):
            following = self._improved(current) if current.finite else None
            if following is None:
                return current
            finished = current.solved
            current = following
            if finished:  # one more step than needed, for the last digit
                return current
        return current

    def below_floor(self, unknowns: np.ndarray) -> np.ndarray:
        """Return which unknowns [..., n + f] are levels below their floor."""
        return np.asarray(self.floored & (unknowns < -FLOOR))

    def _improved(self, current: Iterate) -> Iterate | None:
        step, sizes = current.newton_step(), current.row_sizes
        merit = float(np.linalg.norm(current.residuals / sizes))
        for lengths in (_WHOLE, _PARTS):
            trials = self._evaluated(current.unknowns + lengths[:, None] * step)
            for length, (residuals, trial) in zip(lengths, trials, strict=True):
                if np.linalg.norm(residuals / sizes) < (1.0 - 1e-4 * length) * merit:
                    return trial()
            if current.solved:  # only rounding is left, which no shorter step lessens
                return None
        return None

    def _evaluated(
        self, unknowns: np.ndarray
    ) -> Iterator[tuple[np.ndarray, Callable[[], Iterate]]]:
        """Return the residuals for each row of unknowns, and the iterate where it is followed.

        Many are found at once, since each takes no time.
        """
        size = max(1, _BLOCK // self.derivatives.size)
        for first in range(0, len(unknowns), size):
            block = unknowns[first : first + size]
            residuals, iterate = self._together(block)
            for place, row in enumerate(residuals):
                yield row, partial(iterate, place)

    def _together(self, unknowns: np.ndarray) -> tuple[np.ndarray, Callable[[int], Iterate]]:
        request, states = self.request, len(self.origins)
        rows, columns = self._rows, self._columns
        above = np.maximum(unknowns, self.continued)
        beyond = (above < self.least) | (above > self.most)
        if beyond.any():
            inside = np.clip(above, self.least + INSIDE, self.most - INSIDE)
            above = np.where(beyond, inside, above)
        scaled, spans = above[:, :states], self.spans[:states]
        risen = self.origins + spans * np.where(self.floored[:states], scaled**2, scaled)
        inputs = self._inputs(above)
        local = self.derivatives.at_each(risen, inputs, request.disturbances)
        slopes = self.state_slopes(above)[:, None]
        jacobians = np.zeros((len(above), states + len(rows), states + len(columns)))
        jacobians[:, :states, :states] = local.rates_by_state * slopes
        jacobians[:, :states, states:] = local.rates_by_input[..., columns] * self.spans[states:]
        jacobians[:, states:, :states] = local.measured_by_state[:, rows] * slopes
        shown = local.measured[:, rows] - request.targets
        residuals = np.concatenate([local.rates, shown], axis=1)
        known = np.isfinite(jacobians).all(axis=(1, 2)) & np.isfinite(residuals).all(axis=1)
        apart = unknowns - above
        for place in np.flatnonzero(known & apart.any(axis=1)):
            residuals[place] += jacobians[place] @ apart[place]
        # There is no number to judge or to follow a trial by, as where 1/A has none.
        residuals[~known] = np.nan

        def rounding(place: int) -> np.ndarray:
            # Each term of a sum may be off by its own rounding, so the terms' sizes are added.
            terms = (
                _size(local.rates_by_state[place], risen[place])
                + _size(local.rates_by_input[place], inputs[place])
                + _size(local.rates_by_disturbance[place], request.disturbances)
                + _size(local.rates_by_parameter[place], self.process.parameter_values)
            )
            measured = _size(local.measured_by_state[place, rows], risen[place])
            every = np.concatenate([terms, measured + np.abs(request.targets)])
            return np.asarray(
                _ROUNDING * (every + np.abs(jacobians[place]).max(axis=1, initial=0.0))
            )

        def iterate(place: int) -> Iterate:
            found = unknowns[place], residuals[place], jacobians[place]
            return Iterate(*found, partial(rounding, place))

        return residuals, iterate


def _size(slopes: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return Σ |slope · value| of each row; a slope that is no number tells nothing of rounding."""
    known = np.where(np.isfinite(slopes), slopes, 0.0)
    return np.asarray(np.abs(known) @ np.abs(values))


def _span(signal: Signal) -> float:
    if np.isfinite(signal.span):
        return signal.span
    if np.isfinite(signal.low):
        return max(abs(signal.initial - signal.low), 1.0)
    return max(abs(signal.initial), 1.0)
