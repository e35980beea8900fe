"""One sample of a nonlinear process: what outputs gain in it, and what inputs make them gain it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.ports import with_used_inputs
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.shared_limits import shared_moves
from clepsydra.controllers.blocks.validity import time_step_of
from clepsydra.controllers.observers.observer import at_ports
from clepsydra.controllers.process_model import evaluated, function_in, models_in
from clepsydra.engine.runge_kutta import runge_kutta
from clepsydra.linear.process_equations import ProcessEquations
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: From one linear model of the sample to the next, until the curves of the process no longer
#: matter: where it is linear in its inputs only the equations within the sample are curved.
_TURNS, _TURNS_LINEAR = 4, 2
_TIME_STEP = Signal("time_step", "s", description="time since the last sample")

Values = Sequence[ca.SX]


class OneStepModel:
    """Δy(x, u), what the outputs gain in a sample, and its inverse within the limits of u.

    Parameters
    ----------
    equations : ProcessEquations
        With as many outputs as inputs.
    substeps : int
        Of the classical Runge-Kutta method in a sample.
    """

    def __init__(self, equations: ProcessEquations, substeps: int) -> None:
        self.equations, self._substeps = equations, substeps
        signal = equations.point.process.signal
        self.outputs = [signal(name) for name in equations.outputs]
        self.inputs = [signal(name) for name in equations.inputs]
        self._shown = ca.vertcat(*map(equations.reading, equations.outputs))
        self._rates = ca.densify(equations.rates)
        rates = ca.jacobian(self._shown, equations.state) @ equations.rates
        self._slopes = ca.densify(ca.jacobian(rates, equations.moved))
        bent = ca.depends_on(self._slopes, equations.moved)
        self._turns = _TURNS if bent else _TURNS_LINEAR
        #: The constants of the process that it computes with, parameters of a law.
        self.constants = models_in(equations, [self._rates, self._shown, self._slopes])
        states = equations.signals_of_states()
        self._x = _ports(states, "present", "in this sample")
        self._u = _ports(self.inputs, "tried", "as it is tried")
        self._gained = _ports(self.outputs, "gained", "what it gains in the sample with them")
        self._wanted = _ports(self.outputs, "wanted", "what it is to gain")
        self._largest = _ports(self.outputs, "largest_error", "largest acceptable error")
        self._low = _ports(self.inputs, "low", "low limit")
        self._high = _ports(self.inputs, "high", "high limit")
        self._better = _ports(self.inputs, "better", "better than as tried")
        self._told = (
            *(self._x, self._u, self._gained, self._wanted),
            *(self._low, self._high, self._largest),
        )
        self._prediction, self._improvement = map(
            with_used_inputs, (self._prediction_block(), self._improvement_block())
        )

    def gained(self, sample: Sample, instance: str, x: Values, u: Values) -> list[ca.SX]:
        """Return Δy of each output.

        `x`, `u`: the state now, and the inputs throughout the sample.
        """
        given = at_ports([*self._x, *self._u], [*x, *u])
        found = sample.call(self._prediction, instance, **given)
        return [found[port.name] for port in self._gained]

    def inverse(
        self,
        sample: Sample,
        x: Values,
        wanted: Values,
        limits: tuple[Values, Values],
        largest: Values,
        start: Values,
    ) -> list[ca.SX]:
        """Return the inputs with which the outputs gain what is wanted.

        Where the limits do not allow it, Σ_j |wanted_j − Δy_j|/ē_j is the least that they do.

        `x`: the state now; `wanted`: of each output; `limits`: low and high ones of each input;
        `largest`: ē of each output; `start`: inputs from which the search goes out; inputs at which
        another one has no effect, a flow of zero say, hide how it could be used.
        """
        u = start
        for turn in range(1, self._turns + 1):
            gained = self.gained(sample, f"turn_{turn}.prediction", x, u)
            values = x, u, gained, wanted, *limits, largest
            called = at_ports(chain(*self._told), chain(*values))
            found = sample.call(self._improvement, f"turn_{turn}.inputs", **called)
            u = [found[port.name] for port in self._better]
        return list(u)

    def _prediction_block(self) -> Block:
        def equations(s: Symbols) -> Equations:
            x, u = (ca.vertcat(*_values(s, ports)) for ports in (self._x, self._u))
            time, _ = time_step_of(s)
            rates, rate_constants = function_in(self.equations, [self._rates], s)
            shown, constants = function_in(self.equations, [self._shown], s)
            end = runge_kutta(rates, self._substeps)(time, x, u, rate_constants)
            gained = shown(end, u, constants) - shown(x, u, constants)
            return Equations({}, at_ports(self._gained, ca.vertsplit(gained)))

        return Block(
            "one_step_prediction",
            (*self._x, *self._u, _TIME_STEP, *self.constants),
            (),
            tuple(self._gained),
            equations,
            ("What the outputs gain in a sample, by the equations of the process.",),
        )

    def _improvement_block(self) -> Block:
        def equations(s: Symbols) -> Equations:
            x, u, gained, wanted, low, high, largest = (_values(s, ports) for ports in self._told)
            time, _ = time_step_of(s)
            at = ca.vertcat(*x), ca.vertcat(*u)
            (slopes,) = evaluated(self.equations, [self._slopes], s, *at)
            moves = shared_moves(
                _differences(wanted, gained),
                [ca.horzsplit(row) for row in ca.vertsplit(time * slopes)],
                _differences(low, u),
                _differences(high, u),
                [ca.if_else(size > 0, size, 1) for size in largest],
            )
            better = [at + move for at, move in zip(u, moves, strict=True)]
            return Equations({}, at_ports(self._better, better))

        return Block(
            "one_step_inputs",
            (*chain(*self._told), _TIME_STEP, *self.constants),
            (),
            tuple(self._better),
            equations,
            (
                "The inputs that bring the outputs nearest to what they are to gain, by the slopes "
                "of the process here.",
            ),
        )


def _ports(of: Sequence[Signal], part: str, words: str) -> list[Signal]:
    return [Signal(path(s, part), s.unit, description=f"{s.name}, {words}") for s in of]


def _values(s: Symbols, ports: Sequence[Signal]) -> list[ca.SX]:
    return [s[port.name] for port in ports]


def _differences(first: Values, second: Values) -> list[ca.SX]:
    return [a - b for a, b in zip(first, second, strict=True)]
