"""An observer that runs the equations of the process themselves, corrected by a constant gain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import called, port, truth, with_used_inputs
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.linear.lie_derivatives import InputAffineEquations
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True, eq=False)
class ModelObserver:
    """x̂c = x̂ + M (y − h(x̂)) now, and x̂ in the next sample by dx/dt = f(x, u).

    Unlike a linear observer it holds away from the operating point too, in an empty tank for
    one; only its gain is that of the operating point.

    Parameters
    ----------
    equations : InputAffineEquations
    estimated : tuple of str [N]
        States that act on each other and on nothing else that is not constant.
    measurements : tuple of str [p]
    corrected : ndarray of bool [N, p]
        Where M has numbers.

    Raises
    ------
    InputError
        An estimated state depends on one that is not estimated.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.lie_derivatives import input_affine_equations
    >>> equations = input_affine_equations(cl.load("quadruple-tank").linear)
    >>> observer = ModelObserver(equations, equations.states, ("level_1", "level_2"),
    ...                          np.ones((4, 2), bool))
    >>> [signal.name for signal in observer.state()][:2]
    ['tank_1.level.estimate', 'tank_2.level.estimate']
    """

    equations: InputAffineEquations
    estimated: tuple[str, ...]
    measurements: tuple[str, ...]
    corrected: np.ndarray

    def __post_init__(self) -> None:
        others = [name for name in self.equations.states if name not in self.estimated]
        for name in others:
            place = self.equations.states.index(name)
            if ca.depends_on(self._rates, self.equations.state[place]):
                raise InputError(
                    "observer, estimated",
                    ", ".join(self.estimated),
                    f"{name} too, which acts on them",
                    "estimate it as well",
                )

    @property
    def _places(self) -> list[int]:
        return [self.equations.states.index(name) for name in self.estimated]

    @property
    def _rates(self) -> ca.SX:
        return self.equations.rates[self._places]

    @property
    def expressions(self) -> list[ca.SX]:
        """What it computes with: whoever writes the law gives it the constants in them."""
        return [self._rates, *(self.equations.reading(name) for name in self.measurements)]

    def parameters(self) -> list[Signal]:
        """Return correction of each estimated state by the measurements."""
        process, words = self.equations.point.process, "not as estimated does to"
        return [
            signals.number_of(
                "correction",
                process.signal(x),
                process.signal(y),
                f"what {y} {words} {x}",
                digits=9,
            )
            for x, y in ((self.estimated[j], self.measurements[k]) for j, k in self._used)
        ]

    @property
    def _used(self) -> np.ndarray:
        """The places of the numbers of M."""
        return np.argwhere(self.corrected)

    def values(self, correction: np.ndarray) -> dict[str, float]:
        """Return the values of the parameters from M."""
        numbers = [float(correction[j, k]) for j, k in self._used]
        return {p.name: number for p, number in zip(self.parameters(), numbers, strict=True)}

    def state(self) -> list[Signal]:
        """Return estimate of each estimated state, expected in the next sample."""
        process = self.equations.point.process
        return [
            signals.like(process.signal(name), path(name, "estimate"), f"expected {name}")
            for name in self.estimated
        ]

    def estimate(
        self,
        symbols: Symbols,
        measured: Sequence[ca.SX],
        known: ca.SX,
        models: Sequence[Signal],
        read: Callable[[Sequence[ca.SX], Symbols], list[ca.SX]],
    ) -> list[ca.SX]:
        """Return x̂ with the measurements of this sample, or as expected where these are unusable.

        It is the block observer_correction.

        Parameters
        ----------
        symbols : mapping
            Estimates, correction and model.*.
        measured : sequence of casadi.SX [p]
        known : casadi.SX
            Whether they are numbers from sound sensors.
        models : sequence of Signal
            The constants of the process.
        read : callable
            h: takes x̂ and model.* and returns what the sensors would show.
        """
        process = self.equations.point.process
        shown = [
            port(replace(process.signal(name), name=path(name, "measured")))
            for name in self.measurements
        ]

        def equations(s: Symbols) -> Equations:
            expected = [s[signal.name] for signal in self.state()]
            surprise = [
                ca.if_else(s["known"], s[signal.name] - reading, 0)
                for signal, reading in zip(shown, read(expected, s), strict=True)
            ]
            found = {}
            for x, value, used in zip(self.estimated, expected, self.corrected, strict=True):
                for k in np.flatnonzero(used).tolist():
                    value = value + s[effect(x, "correction", self.measurements[k])] * surprise[k]
                found[path(x, "corrected")] = value
            return Equations({}, found)

        block = with_used_inputs(
            Block(
                "observer_correction",
                (
                    *shown,
                    truth("known", "the measurements are numbers from sound sensors"),
                    *map(port, self.state()),
                    *self.parameters(),
                    *models,
                ),
                (),
                tuple(self._estimates()),
                equations,
                ("The estimate with the measurements: x + M (y - h(x)).",),
            )
        )
        values = {signal.name: value for signal, value in zip(shown, measured, strict=True)}
        found = called(block, "observer_correction", {**symbols, **values, "known": known})
        return list(found.outputs.values())

    def _estimates(self) -> list[Signal]:
        return [
            port(replace(signal, name=path(x, "corrected"), description="with the measurements"))
            for x, signal in zip(self.estimated, self.state(), strict=True)
        ]

    def predicted(
        self,
        symbols: Symbols,
        estimate: Sequence[ca.SX],
        applied: Sequence[ca.SX],
        models: Sequence[Signal],
        rates: Callable[[Sequence[ca.SX], Sequence[ca.SX], Symbols], list[ca.SX]],
    ) -> dict[str, ca.SX]:
        """Return the estimates of the next sample by one step of the classical Runge-Kutta method.

        It is the block observer_prediction.

        Parameters
        ----------
        symbols : mapping
            Estimates, model.* and time_step.
        estimate : sequence of casadi.SX [N]
            Corrected.
        applied : sequence of casadi.SX [m]
            The inputs that were really given out.
        models : sequence of Signal
            The constants of the process.
        rates : callable
            f: takes x̂, u and model.* and returns dx̂/dt.
        """
        process = self.equations.point.process
        moved = [
            port(replace(process.signal(name), name=path(name, "applied")))
            for name in self.equations.inputs
        ]
        before = self._estimates()

        def equations(s: Symbols) -> Equations:
            x, u = ([s[signal.name] for signal in ports] for ports in (before, moved))
            ends, good = _runge_kutta(s, x, lambda x: rates(x, u, s))
            following = {}
            for signal, end in zip(self.state(), ends, strict=True):
                usable = ca.logic_and(good, is_number(end))
                following[signal.name] = ca.if_else(usable, end, s[signal.name])
            return Equations(following, {})

        block = with_used_inputs(
            Block(
                "observer_prediction",
                (*before, *moved, Signal("time_step", "s"), *models),
                tuple(self.state()),
                (),
                equations,
                ("The estimate of the next sample, by the equations of the process.",),
            )
        )
        ports = [*before, *moved]
        values = {p.name: value for p, value in zip(ports, [*estimate, *applied], strict=True)}
        return dict(called(block, "observer_prediction", {**symbols, **values}).next_state)


def _runge_kutta(
    s: Symbols, estimate: Sequence[ca.SX], rates: Callable[[Sequence[ca.SX]], list[ca.SX]]
) -> tuple[list[ca.SX], ca.SX]:
    """Return the state after a step, and whether the time step is one."""
    good = is_time_step(s["time_step"])
    step = ca.if_else(good, s["time_step"], 1)

    def moved(slopes: Sequence[ca.SX], time: ca.SX) -> list[ca.SX]:
        return [x + time * slope for x, slope in zip(estimate, slopes, strict=True)]

    half = 0.5 * step
    first = rates(estimate)
    second = rates(moved(first, half))
    third = rates(moved(second, half))
    fourth = rates(moved(third, step))
    slopes = [
        (a + 2 * (b + c) + d) / 6 for a, b, c, d in zip(first, second, third, fourth, strict=True)
    ]
    return moved(slopes, step), good
