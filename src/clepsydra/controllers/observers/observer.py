"""An observer as two blocks: corrected by the measurements of a sample, then moved on."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence

import casadi as ca
import numpy as np

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.ports import truth, with_used_inputs
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import is_number, is_time_step, time_step_of
from clepsydra.controllers.process_model import evaluated, function_in, models_in
from clepsydra.linear.process_equations import ProcessEquations
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

Values = list[ca.SX]
_WORDS = {
    "deviation": "less its value at the operating point",
    "move": "less its value at the operating point",
    "measured": "as measured",
    "applied": "as it was applied",
    "corrected": "with the measurements of the sample",
    "surprise": "less what was expected",
}
ESTIMATE = Key("estimate", "{x}", "expected {x}", like="x")
KNOWN = truth("known", "the measurements are numbers from sound sensors")


def parts(signals: Iterable[Signal], part: str) -> list[Signal]:
    """Return the ports of an observer's block for some signals."""
    return [
        Signal(path(signal, part), signal.unit, description=f"{signal.name}, {_WORDS[part]}")
        for signal in signals
    ]


def at_ports(ports: Iterable[Signal], values: Iterable[ca.SX]) -> dict[str, ca.SX]:
    """Return values by the names of their ports."""
    return {port.name: value for port, value in zip(ports, values, strict=True)}


class Observer(ABC):
    """x̂c = x̂ + M (y − h(x̂)) now, and x̂ of the next sample by a model of the process.

    Where a measurement is unusable there is no surprise, and the observer goes on with what the
    inputs do: as they were really given out, after mode, limits and hold, so that neither an
    operator's hand nor saturation misleads it. In a sample whose time step is unusable, or where
    numbers run over, the estimate stays.

    `estimated`, `measured`, `moved`: what its state is of, and the measurements and inputs that it
    hears of; `model`: the parameters that it computes with.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 4.
    """

    #: How its blocks are called, and what they take of measurements and of inputs.
    _kind, _reads, _hears = "observer", "measured", "applied"

    def __init__(
        self,
        estimated: Sequence[Signal],
        measured: Sequence[Signal],
        moved: Sequence[Signal],
        model: Sequence[Signal],
    ) -> None:
        self._estimates, self._model = parts(estimated, "corrected"), model
        self._shown, self._surprises = parts(measured, self._reads), parts(measured, "surprise")
        self._moved = parts(moved, self._hears)

    @abstractmethod
    def state(self) -> list[Signal]:
        """Return its state, as expected in the next sample."""

    @abstractmethod
    def _corrected(self, s: Symbols, before: Values, shown: Values) -> tuple[Values, Values]:
        """Return x̂c and y − h(x̂)."""

    @abstractmethod
    def _following(self, s: Symbols, estimate: Values, inputs: Values) -> Values:
        """Return x̂ of the next sample."""

    def _taken(self, goes_on: ca.SX, ends: Values) -> Values:
        """Return which of the next estimates are taken, in a sample with a time step."""
        return [ca.logic_and(goes_on, is_number(end)) for end in ends]

    def correct(self, sample: Sample, measured: Iterable[ca.SX], known: ca.SX) -> list[ca.SX]:
        """Write an instance of its block of correction, and return x̂c.

        `measured`: what the measurements show [p]; zero in the place of what is no number; `known`:
        whether all are numbers from sound sensors.
        """
        state, results = self.state(), (*self._estimates, *self._surprises)

        def equations(s: Symbols) -> Equations:
            x, y = ([s[port.name] for port in ports] for ports in (state, self._shown))
            corrected, surprise = self._corrected(s, x, y)
            return Equations({}, at_ports(results, [*corrected, *surprise]))

        inputs = (*(each.port for each in state), *self._shown, KNOWN, *self._model)
        words = ("The estimate with the measurements: x + M (y - h(x)).",)
        block = Block(f"{self._kind}_correction", inputs, (), results, equations, words)
        sample.parameters(*self._model)
        sample.memory(*state)
        given = at_ports([*self._shown, KNOWN], [*measured, known])
        found = sample.call(with_used_inputs(block), block.name, **given)
        sample.name("", {port.name: found[port.name] for port in self._surprises})
        return [found[port.name] for port in self._estimates]

    def predict(self, sample: Sample, estimate: Sequence[ca.SX], inputs: Sequence[ca.SX]) -> None:
        """Write an instance of its block of prediction.

        `estimate`: x̂c; `inputs`: as they were applied [m].
        """
        state = tuple(self.state())

        def equations(s: Symbols) -> Equations:
            x, u = ([s[port.name] for port in ports] for ports in (self._estimates, self._moved))
            ends = self._following(s, x, u)
            taken = self._taken(is_time_step(s["time_step"]), ends)
            following = {
                entry.name: ca.if_else(holds, end, s[entry.name])
                for entry, holds, end in zip(state, taken, ends, strict=True)
            }
            return Equations(following, {})

        ports = (*self._estimates, *self._moved)
        words = ("The estimate of the next sample, under the inputs as they were applied.",)
        whole = (*ports, Signal("time_step", "s"), *self._model)
        block = with_used_inputs(
            Block(f"{self._kind}_prediction", whole, state, (), equations, words)
        )
        sample.call(block, block.name, **at_ports(ports, [*estimate, *inputs]))


def surprises(known: ca.SX, shown: Iterable[ca.SX], expected: Iterable[ca.SX]) -> list[ca.SX]:
    """Return what measurements show beyond what was expected; nothing where they are not known."""
    return [ca.if_else(known, y - h, 0) for y, h in zip(shown, expected, strict=True)]


class ModelObserver(Observer):
    """x̂c = x̂ + M (y − h(x̂)) now, and x̂ in the next sample by dx/dt = f(x, u).

    One step of the classical Runge-Kutta method moves it on. Unlike a linear observer it holds
    away from the operating point too, in an empty tank for one; only its gain is that of the
    operating point.

    Parameters
    ----------
    equations : ProcessEquations
        Of the states that are estimated.
    corrected : ndarray of bool [N, p]
        Where M has numbers.
    """

    def __init__(
        self, equations: ProcessEquations, measurements: Sequence[str], corrected: np.ndarray
    ) -> None:
        self.equations, self.states, self.measurements = equations, equations.states, measurements
        x = equations.signals_of_states()
        y, u = (
            [equations.point.process.signal(name) for name in names]
            for names in (measurements, equations.inputs)
        )
        words = "what {by} not as estimated does to {to}"
        self.correction = Matrix("correction", x, y, words, used=corrected, digits=9)
        #: What it computes with: whoever writes the law gives it the constants in them.
        self.expressions = equations.rates, ca.vertcat(*map(equations.reading, measurements))
        models = models_in(equations, self.expressions)
        super().__init__(x, y, u, [*models, *self.correction.signals()])

    def state(self) -> list[Signal]:
        """Return estimate of each estimated state, expected in the next sample."""
        return [ESTIMATE.of(x, x=x) for x in self.correction.rows]

    def _corrected(self, s: Symbols, before: Values, shown: Values) -> tuple[Values, Values]:
        (expected,) = evaluated(self.equations, self.expressions[1:], s, ca.vertcat(*before))
        surprise = surprises(s["known"], shown, ca.vertsplit(expected))
        return self.correction.times(s, surprise, before), surprise

    def _following(self, s: Symbols, estimate: Values, inputs: Values) -> Values:
        x, u = ca.vertcat(*estimate), ca.vertcat(*inputs)
        rates, constants = function_in(self.equations, [ca.densify(self.expressions[0])], s)
        step, _ = time_step_of(s)
        half = 0.5 * step
        first = rates(x, u, constants)
        second = rates(x + half * first, u, constants)
        third = rates(x + half * second, u, constants)
        fourth = rates(x + step * third, u, constants)
        return ca.vertsplit(x + step * ((first + 2 * (second + third) + fourth) / 6))
