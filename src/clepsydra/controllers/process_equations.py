"""The equations of a process as a step law computes with them, however its inputs act."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.linear.lie_derivatives import (
    Constant,
    InputAffineEquations,
    ProcessSymbols,
    process_symbols,
)
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.program.step_law import Symbols

#: A number of the model may be changed by this factor at run time, so never to zero.
_FACTOR = 10.0
#: An outlet's slope grows without bound as its tank empties: below this share of the height the
#: linear model is that of this share.
NEARLY_EMPTY = 0.02


@dataclass(frozen=True, eq=False)
class ProcessEquations(ProcessSymbols):
    """ẋ = f(x, u) and y = h(x) with the linear model at any x and u, as expressions.

    Of the states it has those that act on the controlled outputs, at once or through others.

    Parameters
    ----------
    point, inputs, moved, constants
        As in `ProcessSymbols`.
    outputs, states : tuple of str
    state : casadi.SX [n]
        The symbol of x.
    rates : casadi.SX [n]
        f

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = process_equations(cl.load("averaging-tank").linear)
    >>> equations.states
    ('tank.level', 'tank.impurity')
    """

    outputs: tuple[str, ...]
    states: tuple[str, ...]
    state: ca.SX
    rates: ca.SX

    @cached_property
    def A(self) -> ca.SX:
        """∂f/∂x [n, n]."""
        return ca.jacobian(self.rates, self.state)

    @cached_property
    def B(self) -> ca.SX:
        """∂f/∂u [n, m]."""
        return ca.jacobian(self.rates, self.moved)

    def by_constant(self, names: Sequence[str]) -> ca.SX:
        """Return ∂f/∂c of some constants [n, k]."""
        known = {each.signal.name: each.symbol for each in self.constants}
        return ca.jacobian(self.rates, ca.vertcat(*(known[name] for name in names)))

    def reading(self, measurement: str) -> ca.SX:
        """Return h of any measurement of the process [measurement unit].

        A state that does not act on the controlled outputs stands at the operating point.
        """
        at = self.point.as_dict() | dict(zip(self.states, ca.vertsplit(self.state), strict=True))
        state = ca.vertcat(*(at[signal.name] for signal in self.point.process.state))
        return self.readings_in(state, [measurement])

    def signals_of_states(self) -> list[Signal]:
        """Return the signals of the states."""
        return [self.point.process.signal(name) for name in self.states]

    def bounded(self, state: ca.SX, floor: float = 0.0) -> ca.SX:
        """Return the state within the ranges of its signals, levels above a share of theirs."""
        found = []
        for signal, value in zip(self.signals_of_states(), ca.vertsplit(state), strict=True):
            low, high = signal.low, signal.high
            if signal.name in self.point.process.levels and np.isfinite(signal.span):
                low = low + floor * signal.span
            if np.isfinite(low):
                value = ca.fmax(value, low)
            found.append(ca.fmin(value, high) if np.isfinite(high) else value)
        return ca.vertcat(*found)

    def values(
        self, expressions: Sequence[ca.SX]
    ) -> Callable[[np.ndarray, np.ndarray], list[np.ndarray]]:
        """Return a function of x and u that gives the values of expressions."""
        constants = ca.vertcat(*(each.symbol for each in self.constants))
        dense = [ca.densify(each) for each in expressions]
        function = ca.Function("values", [self.state, self.moved, constants], dense)
        given = [each.value for each in self.constants]

        return lambda state, moved: [
            np.array(each, float) for each in function.call([state, moved, given])
        ]


def process_equations(model: LinearModel) -> ProcessEquations:
    """Return the equations of a process, with the states that act on the model's outputs.

    Switches stand as at first.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point: it says which outputs and inputs are meant.

    Raises
    ------
    InputError
        The model has no operating point, or the process has dead time.

    Examples
    --------
    The standby pump acts on the level too, though it is left alone:

    >>> import clepsydra as cl
    >>> process_equations(cl.load("wet-well").linear).states
    ('well.level', 'duty.actual', 'standby.actual')
    """
    point = operating_point_of(model)
    process = point.process
    if process.motion.delays:
        raise InputError(
            f"{process.name}, transport delays",
            ", ".join(delay.name for delay in process.motion.delays),
            "a process without dead time",
            "control it by a method that holds for dead time",
        )
    whole = {signal.name: ca.SX.sym(signal.identifier) for signal in process.state}
    symbols = process_symbols(point, model.inputs)
    x = ca.vertcat(*whole.values())
    rates = symbols.rates_in(x)
    kept = _acting(rates, symbols.readings_in(x, model.outputs), x)
    names = tuple(process.state[place].name for place in kept)
    return ProcessEquations(
        **vars(symbols),
        outputs=model.outputs,
        states=names,
        state=ca.vertcat(*(whole[name] for name in names)),
        rates=rates[kept],
    )


def used_in(
    equations: ProcessEquations | InputAffineEquations, expressions: Iterable[ca.SX]
) -> tuple[Constant, ...]:
    """Return the constants of a process on which expressions depend.

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = process_equations(cl.load("averaging-tank").linear)
    >>> [each.signal.name for each in used_in(equations, [equations.reading("volume")])]
    ['tank.area']
    """
    used = {symbol.name() for symbol in ca.symvar(ca.vertcat(*map(ca.vec, expressions)))}
    return tuple(each for each in equations.constants if each.symbol.name() in used)


def models_in(
    equations: ProcessEquations | InputAffineEquations, expressions: Iterable[ca.SX]
) -> list[Signal]:
    """Return those constants as parameters of a law (`model_parameter`).

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = process_equations(cl.load("averaging-tank").linear)
    >>> [each.name for each in models_in(equations, [equations.reading("volume")])]
    ['model.tank.area']
    """
    return [model_parameter(each) for each in used_in(equations, expressions)]


def evaluated(
    equations: ProcessEquations | InputAffineEquations,
    expressions: Sequence[ca.SX],
    symbols: Symbols,
    state: ca.SX | float = 0.0,
    moved: ca.SX | float = 0.0,
) -> list[ca.SX]:
    """Return expressions of a process within a law, each operation that they share written once.

    Parameters
    ----------
    equations : ProcessEquations or InputAffineEquations
    expressions : sequence of casadi.SX
    symbols : mapping
        The constants that they depend on, as parameters of the law (`model.*`).
    state, moved : casadi.SX [n], [m], optional
        x and u, where they depend on them.

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> level = {"model.level_1.gain": ca.SX(50.0)}
    >>> evaluated(equations, [equations.reading("level_1")], level, ca.SX([0.1, 0, 0, 0]))
    [SX(5)]
    """
    function, constants = function_in(equations, expressions, symbols)
    return function.call([ca.SX(state), ca.SX(moved), constants])


def function_in(
    equations: ProcessEquations | InputAffineEquations,
    expressions: Sequence[ca.SX],
    symbols: Symbols,
) -> tuple[ca.Function, ca.SX]:
    """Return expressions as a function of x, u and constants, and the constants within a law.

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> gain = {"model.level_1.gain": ca.SX(50.0)}
    >>> function_in(equations, [equations.reading("level_1")], gain)[1]
    SX(50)
    """
    used = used_in(equations, expressions)
    arguments = [equations.state, equations.moved, ca.vertcat(*(each.symbol for each in used))]
    given = (symbols[model_parameter(each).name] for each in used)
    return ca.Function("at", arguments, list(expressions)), ca.SX(ca.vertcat(*given))


def model_parameter(constant: Constant) -> Signal:
    """Return the parameter of a law that stands for a constant of the process.

    Examples
    --------
    >>> area = Constant(Signal("tank.area", "m^2"), ca.SX.sym("area"), 0.5)
    >>> model_parameter(area).name, model_parameter(area).high
    ('model.tank.area', 5.0)
    """
    signal, value = constant.signal, constant.value
    low, high = sorted((value / _FACTOR, value * _FACTOR))
    if value == 0.0:
        low, high = -signals.LARGEST_PARAMETER, signals.LARGEST_PARAMETER
    return replace(
        signal,
        name=path("model", signal.name),
        low=low,
        high=high,
        initial=value,
        kind="real",
        description=signal.description or signal.name,
    )


def _acting(rates: ca.SX, shown: ca.SX, state: ca.SX) -> list[int]:
    """Return the places of the states that act on what is shown, at once or through others."""
    acts = np.array(ca.DM(ca.jacobian_sparsity(rates, state), 1)) != 0.0
    found = np.any(np.array(ca.DM(ca.jacobian_sparsity(shown, state), 1)) != 0.0, axis=0)
    for _ in range(state.numel()):
        found = found | np.any(acts[found], axis=0)
    return [int(place) for place in np.flatnonzero(found)]
