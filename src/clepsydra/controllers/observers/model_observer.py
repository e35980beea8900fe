"""An observer that runs the equations of the process themselves, corrected by a constant gain."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.validity import time_step_of
from clepsydra.controllers.observers.observer import ESTIMATE, Observer, Values, surprises
from clepsydra.controllers.process_equations import evaluated, models_in
from clepsydra.linear.lie_derivatives import InputAffineEquations
from clepsydra.program.step_law import Symbols


class ModelObserver(Observer):
    """x̂c = x̂ + M (y − h(x̂)) now, and x̂ in the next sample by dx/dt = f(x, u).

    One step of the classical Runge-Kutta method moves it on. Unlike a linear observer it holds
    away from the operating point too, in an empty tank for one; only its gain is that of the
    operating point.

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

    def __init__(
        self,
        equations: InputAffineEquations,
        estimated: Sequence[str],
        measurements: Sequence[str],
        corrected: np.ndarray,
    ) -> None:
        self.equations, self.estimated, self.measurements = equations, estimated, measurements
        self._places = [equations.states.index(name) for name in estimated]
        self._rates = equations.rates[self._places]
        self._readings = ca.vertcat(*map(equations.reading, measurements))
        for name, symbol in zip(equations.states, ca.vertsplit(equations.state), strict=True):
            if name not in estimated and ca.depends_on(self._rates, symbol):
                raise InputError(
                    "observer, estimated",
                    ", ".join(estimated),
                    f"{name} too, which acts on them",
                    "estimate it as well",
                )
        x, y, u = (
            [equations.point.process.signal(name) for name in names]
            for names in (estimated, measurements, equations.inputs)
        )
        words = "what {by} not as estimated does to {to}"
        self.correction = Matrix("correction", x, y, words, used=corrected, digits=9)
        models = models_in(equations, self.expressions)
        super().__init__(x, y, u, [*models, *self.correction.signals()])

    @property
    def expressions(self) -> list[ca.SX]:
        """What it computes with: whoever writes the law gives it the constants in them."""
        return [self._rates, self._readings]

    def values(self, correction: np.ndarray) -> dict[str, float]:
        """Return the values of the parameters from M."""
        return {name: float(value) for name, value in self.correction.named(correction).items()}

    def state(self) -> list[Signal]:
        """Return estimate of each estimated state, expected in the next sample."""
        return [ESTIMATE.of(x, x=x) for x in self.correction.rows]

    def whole(self, estimate: ca.SX) -> ca.SX:
        """Return x with an estimate in it; the other states stand at the operating point."""
        state = ca.SX(self.equations.point.state)
        state[self._places] = estimate
        return state

    def _corrected(self, s: Symbols, before: Values, shown: Values) -> tuple[Values, Values]:
        expected = ca.vertsplit(self._at(self._readings, s, ca.vertcat(*before)))
        surprise = surprises(s["known"], shown, expected)
        return self.correction.times(s, surprise, before), surprise

    def _following(self, s: Symbols, estimate: Values, inputs: Values) -> Values:
        x, u = ca.vertcat(*estimate), ca.vertcat(*inputs)
        step, _ = time_step_of(s)
        half = 0.5 * step
        first = self._at(self._rates, s, x, u)
        second = self._at(self._rates, s, x + half * first, u)
        third = self._at(self._rates, s, x + half * second, u)
        fourth = self._at(self._rates, s, x + step * third, u)
        return ca.vertsplit(x + step * ((first + 2 * (second + third) + fourth) / 6))

    def _at(
        self, expression: ca.SX, s: Symbols, estimate: ca.SX, inputs: ca.SX | float = 0.0
    ) -> ca.SX:
        (found,) = evaluated(self.equations, [expression], s, self.whole(estimate), inputs)
        return ca.densify(found)
