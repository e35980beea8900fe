"""The equations of a process at an operating point, as expressions, however its inputs act."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.ways import in_any_steps

#: An outlet's slope grows without bound as its tank empties: below this share of the height the
#: linear model is that of this share.
NEARLY_EMPTY = 0.02


@dataclass(frozen=True, eq=False)
class Constant:
    """What the equations take as constant: a parameter, a disturbance, an input left alone.

    Parameters
    ----------
    symbol : casadi.SX
        It stands for it in the equations.
    value : float
        At the operating point [signal unit].
    """

    signal: Signal
    symbol: ca.SX
    value: float


@dataclass(frozen=True, eq=False)
class ProcessEquations:
    """ẋ = f(x, u) and y = h(x) with the linear model at any x and u.

    Parameters
    ----------
    inputs : tuple of str
        Those that are moved.
    moved : casadi.SX [m]
        The symbols of these, u.
    constants : tuple of Constant
        The other inputs, disturbances and parameters.
    state : casadi.SX [n]
        The symbol of x.
    rates : casadi.SX [n]
        f
    """

    point: OperatingPoint
    inputs: tuple[str, ...]
    moved: ca.SX
    constants: tuple[Constant, ...]
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

        A state that is none of the equations' stands at the operating point.
        """
        process = self.point.process
        at = self.point.as_dict() | dict(zip(self.states, ca.vertsplit(self.state), strict=True))
        symbols = {each.signal.name: each.symbol for each in self.constants}
        state = ca.vertcat(*(at[signal.name] for signal in process.state))
        shown = process.measure(state, ca.vertcat(*(symbols[p.name] for p in process.parameters)))
        return shown[[signal.name for signal in process.measurements].index(measurement)]

    def acting_on(self, names: Sequence[str]) -> list[str]:
        """Return some states, and those that act on them, at once or through further ones."""
        found = list(names)
        for name in found:
            rate = self.rates[self.states.index(name)]
            for place, other in enumerate(self.states):
                if other not in found and ca.depends_on(rate, self.state[place]):
                    found.append(other)
        return found

    def of_states(self, names: Sequence[str]) -> ProcessEquations:
        """Return the equations of some of the states; the others stand at the operating point.

        Raises
        ------
        InputError
            Another state acts on them.
        """
        kept = [self.states.index(name) for name in names]
        rates = self.rates[kept]
        for name, symbol in zip(self.states, ca.vertsplit(self.state), strict=True):
            if name not in names and ca.depends_on(rates, symbol):
                expected = f"{name} too, which acts on them"
                remedy = "estimate it as well"
                raise InputError("observer, estimated", ", ".join(names), expected, remedy)
        groups = self.point, self.inputs, self.moved, self.constants, self.outputs
        return ProcessEquations(*groups, tuple(names), self.state[kept], rates)

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

    def at(
        self, expression: ca.SX, state: ArrayLike | None = None, moved: ArrayLike | None = None
    ) -> np.ndarray:
        """Return the value of an expression at x [n] and u [m], those at rest if left out."""
        at = self.point.as_dict()
        x = [at[name] for name in self.states] if state is None else state
        u = [at[name] for name in self.inputs] if moved is None else moved
        return self.values([expression])(np.array(x, float), np.array(u, float))[0]


def process_equations(model: LinearModel, *, every_state: bool = False) -> ProcessEquations:
    """Return the equations of a process.

    Switches stand as at first.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point: it says which outputs and inputs are meant.
    every_state : bool
        Those too that do not act on the model's outputs, at once or through others.

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
    process, at = point.process, point.as_dict()
    if process.delayed:
        got, expected = ", ".join(process.delayed), "a process without dead time"
        remedy = "control it by a method that holds for dead time"
        raise InputError(f"{process.name}, {process.what_delays}", got, expected, remedy)
    alone = [signal for signal in process.inputs if signal.name not in model.inputs]
    held = [(signal, at[signal.name]) for signal in (*process.disturbances, *alone)]
    held += [(parameter, parameter.initial) for parameter in process.parameters]
    constants = tuple(
        Constant(signal, ca.SX.sym(signal.identifier), value) for signal, value in held
    )
    x, u = ca.SX.sym("x", len(process.state)), ca.SX.sym("u", len(model.inputs))
    symbols = {each.signal.name: each.symbol for each in constants}
    symbols |= dict(zip(model.inputs, ca.vertsplit(u), strict=True))
    groups = (process.inputs, process.disturbances, process.parameters)
    given = (ca.vertcat(*(symbols[signal.name] for signal in group)) for group in groups)
    names = tuple(signal.name for signal in process.state)
    whole = ProcessEquations(
        point, model.inputs, u, constants, model.outputs, names, x, process.dynamics(x, *given)
    )
    if every_state:
        return whole
    kept = _acting(whole.rates, ca.vertcat(*map(whole.reading, model.outputs)), x)
    return whole.of_states([names[place] for place in kept])


def _acting(rates: ca.SX, shown: ca.SX, state: ca.SX) -> list[int]:
    """Return the places of the states that act on what is shown, at once or through others."""
    acts = np.array(ca.DM(ca.jacobian_sparsity(rates, state), 1)) != 0.0
    seen = np.array(ca.DM(ca.jacobian_sparsity(shown, state), 1)) != 0.0
    return np.flatnonzero((seen @ in_any_steps(acts)).any(axis=0)).tolist()
