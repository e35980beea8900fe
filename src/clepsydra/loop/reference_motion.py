"""The motion of a process by other means than the kernel: CVODES, and SciPy where it switches."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from clepsydra.base.errors import InputError
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.delay_content import delay_content
from clepsydra.loop.motion_block import CLOCK, motion_at_rest, ring_name
from clepsydra.process.hybrid import Delay

Array = NDArray[np.float64]

_RELATIVE, _ABSOLUTE = 1e-12, 1e-14
#: What a ring keeps of a delayed quantity for each step: values and slopes at both ends, its mean.
_PARTS = ("start", "rising", "end", "leaving", "mean")
#: What repeats a step: where it switches, and where CVODES gives up.
_EXPLICIT = {"method": "DOP853", "rtol": _RELATIVE}
_IMPLICIT = {"method": "BDF", "rtol": 1e-10}
#: Share of a step after which a slope at its start is taken.
_LATER = 1e-6


class ReferenceMotion:
    """A process that is carried from sample to sample, with its delays and switches.

    Between switches it is CVODES, variable-order BDF with exact Jacobians (Hindmarsh et al.,
    SUNDIALS, ACM TOMS 31(3), 2005, doi 10.1145/1089014.1089020). A step in which a guard becomes
    zero or positive is repeated by SciPy's DOP853 (Hairer, Nørsett & Wanner, Solving Ordinary
    Differential Equations I, 1993), whose dense output finds the moment, and one in which CVODES
    gives up by its BDF. What enters a delay is
    kept as value and slope at both ends of a step and as its integral over it, and comes out as
    the polynomial of degree four that has all five: nothing is lost where a flow jumps.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts, at rest.
    substeps : int
        Steps in a sampling period, of which every delay is a multiple.
    totals : tuple of str
        Those totals that are integrated.
    start : mapping, optional
        Contents, memories and constant contents of delays by name where it does not start at rest.
    rings : mapping, optional
        What delays hold where that differs along them, as `rings` returns it or as the rings of
        the kernel, see `clepsydra.loop.motion_block`.
    """

    def __init__(
        self,
        point: OperatingPoint,
        substeps: int,
        totals: tuple[str, ...],
        *,
        start: Mapping[str, float] | None = None,
        rings: Mapping[str, Array] | None = None,
    ) -> None:
        process, motion = point.process, point.process.motion
        # Without delays and memories a sampling period is one smooth step.
        steps = substeps if motion.delays or motion.memories else 1
        self._steps, self._step = steps, process.sampling_period / steps
        self._process, self._motion = process, motion
        self._parameters = process.parameter_values
        rest = motion_at_rest(point) | dict(start or {})
        self._chosen = [i for i, s in enumerate(motion.totals) if s.name in totals]
        self._total_names = [motion.totals[i].name for i in self._chosen]
        contents = np.array([rest[signal.name] for signal in motion.contents])
        self._integral = np.array([*contents, *np.zeros(len(self._chosen) + len(motion.delays))])
        self._memories = np.array([rest[signal.name] for signal in motion.memories])
        self._counts = np.zeros(len(motion.events))
        self._times = np.zeros(len(motion.events))
        self._clock = 0
        self._rings = [
            self._ring(delay, rest[ring_name(delay.name, "start")], rings or {})
            for delay in motion.delays
        ]
        self._build()

    def state(self) -> Array:
        """Return the states of the process [n]."""
        contents = self._integral[: len(self._motion.contents)]
        return np.array(self._motion.to_state(contents, self._parameters)).ravel()

    def recorded(self) -> dict[str, float]:
        """Return contents, totals, memories, and counts and times of events by name."""
        motion = self._motion
        names = [*(s.name for s in motion.contents), *self._total_names]
        values = dict(zip(names, self._integral[: len(names)], strict=True))
        values |= {s.name: v for s, v in zip(motion.memories, self._memories, strict=True)}
        for event, count, time in zip(motion.events, self._counts, self._times, strict=True):
            values |= {event.counted: count, event.dated: time}
        if motion.events:
            values[CLOCK] = self._clock
        return {name: float(value) for name, value in values.items()}

    def rings(self) -> dict[str, Array]:
        """Return what the delays hold by name and part, the oldest first [steps]."""
        found: dict[str, Array] = {}
        for delay, ring in zip(self._motion.delays, self._rings, strict=True):
            columns = zip(_PARTS, np.array(ring).T, strict=True)
            found |= {ring_name(delay.name, part): column for part, column in columns}
        return found

    def _ring(
        self, delay: Delay, constant: float, rings: Mapping[str, Array]
    ) -> deque[list[float]]:
        steps = round(delay.time / self._step)
        content = delay_content(delay.name, rings)
        if content is None:
            return deque([_constant(constant)] * steps)
        start, mean, end = kept = content.over(steps)
        rising, leaving = kept.slopes(self._step)
        if len(content.start) == steps and ring_name(delay.name, "rising") in rings:
            rising, leaving = (rings[ring_name(delay.name, part)] for part in ("rising", "leaving"))
        return deque(np.column_stack([start, rising, end, leaving, mean]).tolist())

    def advance(self, inputs: Array, disturbances: Array) -> None:
        """Carry the process to the next sample with everything from outside held."""
        outside = np.concatenate([inputs, disturbances, self._parameters])
        for _ in range(self._steps):
            self._advance_step(outside)
            self._clock += 1

    def _build(self) -> None:
        motion = self._motion
        t, h = ca.SX.sym("t"), self._step
        integral = ca.SX.sym("integral", len(self._integral))
        ring = ca.SX.sym("ring", 5 * len(motion.delays))
        sizes = [motion.rates.numel_in(index) for index in range(2, 6)]
        held = [ca.SX.sym(name, size) for name, size in zip("mudp", sizes, strict=True)]
        z = _passing(ring, t / h, h)
        contents, entering, totals = motion.rates(integral[: len(motion.contents)], z, *held)
        rates = ca.densify(ca.vertcat(contents, *(totals[i] for i in self._chosen), entering))
        slope = ca.jtimes(entering, ca.vertcat(integral, t), ca.vertcat(rates, 1))
        given = ca.vertcat(ring, *held)
        guards = motion.guards(integral[: len(motion.contents)], z, *held)
        arguments = [t, integral, given]
        self._rates = ca.Function("rates", arguments, [rates])
        self._guards = ca.Function("guards", arguments, [ca.densify(guards)])
        self._sent = ca.Function("sent", arguments, [ca.densify(entering), ca.densify(slope)])
        fired = ca.SX.sym("fired", len(motion.events))
        state = integral[: len(motion.contents)]
        self._resets = ca.Function(
            "resets", [fired, *arguments], [motion.resets(fired, state, z, *held)]
        )
        self._updates = ca.Function("updates", arguments, [motion.updates(state, z, *held)])
        system = {"t": t, "x": integral, "p": given, "ode": rates}
        scale = max((abs(s.high) for s in motion.contents if np.isfinite(s.high)), default=1.0)
        options = {
            "reltol": _RELATIVE, "abstol": _ABSOLUTE * scale, "max_num_steps": 100_000,
            "disable_internal_warnings": True,  # what it gives up is repeated by other means
        }  # fmt: skip
        self._solver = ca.integrator("reference", "cvodes", system, 0.0, h, options)
        self._absolute = _ABSOLUTE * scale

    def _advance_step(self, outside: Array) -> None:
        leaving = [value for ring in self._rings for value in ring.popleft()]
        delays = len(self._rings)
        self._integral[len(self._integral) - delays :] = 0.0
        given = np.concatenate([leaving, self._memories, outside])
        first = self._sent_first(given)
        after = self._smooth(given)
        if after is None:
            after, given = self._with_events(np.array(leaving), outside, _IMPLICIT)
        elif self._switches(self._step, after, given).max(initial=-1.0) >= 0.0:
            after, given = self._with_events(np.array(leaving), outside, _EXPLICIT)
        self._integral = after
        last = self._sent(self._step, after, given)
        mean = after[len(after) - delays :] / self._step
        entered = [np.array(part).ravel() for part in (*first, *last, mean)]
        for ring, *values in zip(self._rings, *entered, strict=True):
            ring.append([float(value) for value in values])
        if self._motion.memories:
            self._memories = np.array(self._updates(self._step, after, given)).ravel()

    def _sent_first(self, given: Array) -> tuple[Array, Array]:
        """Return what enters the delays at the start of a step, and how fast it changes.

        The slope is taken a little later: where a maximum is a tie at first, as that of play
        which is just used up, its derivative there is neither of the two slopes.
        """
        value, _ = self._sent(0.0, self._integral, given)
        later = _LATER * self._step
        rates = np.array(self._rates(0.0, self._integral, given)).ravel()
        _, slope = self._sent(later, self._integral + later * rates, given)
        return np.array(value).ravel(), np.array(slope).ravel()

    def _smooth(self, given: Array) -> Array | None:
        """Return where a step without a switch ends.

        None where CVODES gives up: beyond a switch that it does not know, as below the floor of
        a tank, the equations may have no solution; and near the tip of a cone the level follows
        the volume with a slope that has no bound, which its exact Jacobian then has.
        """
        try:
            result = self._solver(x0=self._integral, p=given)
        except RuntimeError:
            return None
        return np.array(result["xf"]).ravel()

    def _switches(self, time: float, integral: Array, given: Array) -> Array:
        return np.array(self._guards(time, integral, given)).ravel()

    def _with_events(
        self, leaving: Array, outside: Array, method: dict[str, Any]
    ) -> tuple[Array, Array]:
        """Repeat a step from switch to switch; return where it ends and what is held there."""
        from scipy.integrate import solve_ivp

        start, integral = 0.0, self._integral
        while True:
            given = np.concatenate([leaving, self._memories, outside])
            now = self._switches(start, integral, given)
            if now.max(initial=-1.0) < 0.0:
                if start >= self._step:
                    return integral, given
                events = [self._guard(index, given) for index in range(len(now))]
                found = solve_ivp(
                    lambda t, y, given=given: np.array(self._rates(t, y, given)).ravel(),
                    (start, self._step),
                    integral,
                    atol=self._absolute,
                    events=events,
                    **method,
                )
                if not found.success:
                    raise self._stuck(start)
                start, integral = float(found.t[-1]), found.y[:, -1]
                now = self._switches(start, integral, given)
                for index, times in enumerate(found.t_events):
                    if len(times):
                        now[index] = 0.0
            fired = now >= 0.0
            if fired.any():
                self._memories = np.array(self._resets(fired, start, integral, given)).ravel()
                self._counts += fired
                self._times[fired] = self._clock * self._step + start

    def _stuck(self, start: float) -> InputError:
        process = self._process
        return InputError(
            f"{process.name}, reference solver", f"{self._clock * self._step + start:g} s",
            "a time beyond which the equations can be integrated",
            "end the run before, or use the kernel, which estimates its error",
        )  # fmt: skip

    def _guard(self, index: int, given: Array):  # type: ignore[no-untyped-def]
        def guard(time: float, integral: Array) -> float:
            return float(self._guards(time, integral, given)[index])

        guard.terminal = True  # type: ignore[attr-defined]
        guard.direction = 1.0  # type: ignore[attr-defined]
        return guard


def _constant(value: float) -> list[float]:
    """Return what a ring keeps of a step in which a value does not change."""
    return [value, 0.0, value, 0.0, value]


def _passing(ring: ca.SX, s: ca.SX, h: float) -> ca.SX:
    """Return the quartic with value and slope at both ends of a step and its mean, at fraction s.

    It is Hermite's cubic and a multiple of s² (1 - s)², whose mean is 1/30.
    """
    parts = []
    for index in range(ring.numel() // 5):
        start, rising, end, leaving, mean = (ring[5 * index + part] for part in range(5))
        missing = mean - (start + end) / 2 - h * (rising - leaving) / 12
        parts.append(
            start * (1 + 2 * s) * (1 - s) ** 2
            + h * rising * s * (1 - s) ** 2
            + end * s**2 * (3 - 2 * s)
            + h * leaving * s**2 * (s - 1)
            + missing * (30 * s**2 * (1 - s) ** 2)
        )
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)
