"""A process as an optimisation sees it: scaled, smooth, without its switches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.pickled_fields import PickledFields
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.ways import in_any_steps
from clepsydra.optimal_control.smooth import Smoothed, smoothed
from clepsydra.process.process import Process

#: Width of the rounding of kinks, as a share of the largest difference.
SMOOTHING = 1e-5

#: How far a level stays from the end of its range, where a root may have no slope [share].
_INSIDE = 1e-6
#: How far a path stays from a trip [share of the distance at the start].
_CLEAR = 1e-4


@dataclass(frozen=True, eq=False)
class PlantModel(PickledFields):
    """ẋ = f(x, u, z, d), w(x, u, z, d), y(x) and the guards of what must not happen.

    Contents x and delayed quantities z are shares of a scale, inputs u of the way between their
    bounds; memories stand as they do at first, since an event that would change one is forbidden.

    Parameters
    ----------
    before, after : OperatingPoint
        Where the plant rests at first and where it is to rest; one where it is to stay.
    outputs : tuple of str
        Measurements whose error counts.
    sizes_of_errors : ndarray [outputs]
        What each error is divided by [its unit].
    input_bounds : (ndarray, ndarray)
        Between which ends the inputs may move [SI].
    loads : ndarray [k, disturbances]
        Those that come up [SI].
    smoothing : float
        Width of the rounding of kinks, see `clepsydra.optimal_control.smooth`.
    """

    before: OperatingPoint
    after: OperatingPoint
    outputs: tuple[str, ...]
    sizes_of_errors: np.ndarray
    input_bounds: tuple[np.ndarray, np.ndarray]
    loads: np.ndarray
    smoothing: float = SMOOTHING

    @property
    def process(self) -> Process:
        """The process."""
        return self.before.process

    @property
    def sizes(self) -> tuple[int, int, int, int]:
        """How many contents, inputs, delayed quantities and disturbances there are."""
        motion, process = self.process.motion, self.process
        return (
            len(motion.contents), len(process.inputs), len(motion.delays),
            len(process.disturbances),
        )  # fmt: skip

    @cached_property
    def _rests(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """(c, z, m, u, d, p) at rest before and after."""
        process = self.process
        found = [
            process.motion.at_rest(p.state, p.inputs, p.disturbances, process.parameter_values)
            for p in (self.before, self.after)
        ]
        return found[0], found[1]

    @cached_property
    def scales(self) -> tuple[np.ndarray, np.ndarray]:
        """What contents [SI] and delayed quantities [SI] are divided by."""
        first, last = self._rests
        spans = np.array([c.span for c in self.process.motion.contents], float)
        reached = np.maximum(np.abs(first[0]), np.abs(last[0]))
        contents = np.where(np.isfinite(spans), spans, np.where(reached > 0, reached, 1.0))
        delayed = np.maximum(np.abs(first[1]), np.abs(last[1]))
        return contents, np.where(delayed > 0, delayed, 1.0)

    @cached_property
    def start(self) -> tuple[np.ndarray, np.ndarray]:
        """Contents and delayed quantities at rest before, scaled."""
        return self._scaled(0)

    @cached_property
    def target(self) -> tuple[np.ndarray, np.ndarray]:
        """The same at rest after it."""
        return self._scaled(1)

    @cached_property
    def target_inputs(self) -> np.ndarray:
        """The inputs at rest after it, scaled."""
        return self.input_shares(self.after.inputs)

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Between which ends the contents may move, scaled."""
        contents = self.process.motion.contents
        scale, (start, _) = self.scales[0], self.start
        low = np.array([c.low for c in contents], float) / scale
        high = np.array([c.high for c in contents], float) / scale
        inside = np.where(np.isfinite(high - low), _INSIDE, 0.0)
        # A plant that begins at an end may stay there.
        return np.minimum(low + inside, start), np.maximum(high - inside, start)

    def input_shares(self, values: np.ndarray) -> np.ndarray:
        """Return inputs as shares of their range."""
        low, high = self.input_bounds
        return (values - low) / (high - low)

    def inputs_from(self, shares: np.ndarray) -> np.ndarray:
        """Return inputs [inputs, n] in SI from shares of their range."""
        low, high = self.input_bounds
        return low[:, None] + (high - low)[:, None] * shares

    @cached_property
    def kinks(self) -> int:
        """How many kinks were rounded."""
        return self._smooth.kinks

    @cached_property
    def rates(self) -> ca.Function:
        """(x, u, z, d) → dx/dt [scale/s]."""
        return self._function("rates", 0)

    @cached_property
    def sent(self) -> ca.Function:
        """(x, u, z, d) → w [scale]."""
        return self._function("sent", 1)

    @cached_property
    def errors_to(self) -> ca.Function:
        """(x, r) → (y - r)/size of the outputs that count."""
        x, u, z, d = self._symbols
        r = ca.SX.sym("r", len(self.outputs))
        # A reading depends on contents alone.
        shown = self._smooth.function(ca.vertcat(x, u, z, d))[2]
        return ca.Function("errors", [x, r], [ca.cse((shown - r) / self.sizes_of_errors)])

    @cached_property
    def guards(self) -> ca.Function:
        """(x, u, z, d) → guards of what must not happen, at most 0 where it is far enough."""
        return self._function("guards", 3)

    @cached_property
    def acting(self) -> list[int]:
        """Places of the contents that act on the outputs, at once or through others."""
        x, u, z, d = self._symbols
        rates, sent, shown, _ = self._smooth.function(ca.vertcat(x, u, z, d))
        zs, xs = ca.vertcat(x, z), ca.vertcat(rates, sent)
        acts = np.array(ca.DM(ca.jacobian_sparsity(xs, zs), 1)) != 0.0
        seen = np.array(ca.DM(ca.jacobian_sparsity(shown, zs), 1)) != 0.0
        reached = (seen @ in_any_steps(acts)).any(axis=0)[: self.sizes[0]]
        return [int(place) for place in np.flatnonzero(reached)]

    @cached_property
    def _symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        x, u, z, d = (ca.SX.sym(n, size) for n, size in zip("xuzd", self.sizes, strict=True))
        return x, u, z, d

    @cached_property
    def _smooth(self) -> Smoothed:
        process, motion = self.process, self.process.motion
        x, u, z, d = self._symbols
        contents, delayed = self.scales
        low, high = self.input_bounds
        memories, p = self._rests[0][2], process.parameter_values
        c = x * contents
        held = c, z * delayed, memories, low + u * (high - low), d, p
        rates, sent, _ = motion.rates(*held)
        places = [[y.name for y in process.measurements].index(n) for n in self.outputs]
        shown = process.measure(motion.to_state(c, p), p)[places]
        guards = self._forbidden(motion.guards(*held))
        whole = ca.Function(
            "whole", [ca.vertcat(x, u, z, d)],
            [ca.densify(each) for each in (rates / contents, sent / delayed, shown, guards)],
        )  # fmt: skip
        return smoothed(whole, *self._box(), self.smoothing)

    def _box(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of all x, u, z, d that come up; open ones are twice those at rest."""
        _, inputs, delays, _ = self.sizes
        low, high = self.bounds
        loads = self.loads
        return (
            np.concatenate([np.maximum(low, -2.0), np.zeros(inputs + delays), loads.min(axis=0)]),
            np.concatenate(
                [np.minimum(high, 2.0), np.ones(inputs), np.full(delays, 2.0), loads.max(axis=0)]
            ),
        )

    def _forbidden(self, guards: ca.SX) -> ca.SX:
        """Return the guards that do harm and can fire, over their size at the start."""
        motion, first = self.process.motion, self._rests[0]
        now = np.array(motion.guards(*first)).ravel()
        rows = [
            guards[row] / max(abs(now[row]), 1e-9) + _CLEAR
            for row, happening in enumerate(motion.events)
            if happening.harm and not guards[row].is_constant()
        ]
        return ca.vertcat(*rows) if rows else ca.SX(0, 1)

    def _scaled(self, which: int) -> tuple[np.ndarray, np.ndarray]:
        c, z, *_ = self._rests[which]
        contents, delayed = self.scales
        return c / contents, z / delayed

    def _function(self, name: str, place: int) -> ca.Function:
        x, u, z, d = self._symbols
        value = self._smooth.function(ca.vertcat(x, u, z, d))[place]
        return ca.Function(name, [x, u, z, d], [ca.cse(value)])
