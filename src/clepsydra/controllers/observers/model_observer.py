"""An observer that runs the equations of the process themselves, corrected by a constant gain."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.validity import time_step_of
from clepsydra.controllers.observers.observer import ESTIMATE, Observer, Values, surprises
from clepsydra.controllers.process_model import evaluated, function_in, models_in
from clepsydra.linear.process_equations import ProcessEquations
from clepsydra.program.step_law import Symbols


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
        self.equations, self.measurements = equations, measurements
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
