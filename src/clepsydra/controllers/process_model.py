"""The equations of a process within a step law, whose constants are parameters of the law."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.linear.process_equations import Constant, ProcessEquations
from clepsydra.program.step_law import Symbols

#: A number of the model may be changed by this factor at run time, so never to zero.
_FACTOR = 10.0


def used_in(equations: ProcessEquations, expressions: Iterable[ca.SX]) -> tuple[Constant, ...]:
    """Return the constants of a process on which expressions depend.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> used_in(process_equations(cl.load("quadruple-tank").linear), [])
    ()
    """
    together = ca.SX(ca.vertcat(*map(ca.vec, expressions)))  # without any, CasADi makes no SX
    used = {symbol.name() for symbol in ca.symvar(together)}
    return tuple(each for each in equations.constants if each.symbol.name() in used)


def models_in(equations: ProcessEquations, expressions: Iterable[ca.SX]) -> list[Signal]:
    """Return those constants as parameters of a law (`model_parameter`)."""
    return [model_parameter(each) for each in used_in(equations, expressions)]


def evaluated(
    equations: ProcessEquations,
    expressions: Sequence[ca.SX],
    symbols: Symbols,
    state: ca.SX | float = 0.0,
    moved: ca.SX | float = 0.0,
) -> list[ca.SX]:
    """Return expressions of a process within a law, each operation that they share written once.

    `symbols`: the constants that they depend on, as parameters of the law (`model.*`); `state`,
    `moved`: x and u, where they depend on them.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> level = {"model.level_1.gain": ca.SX(50.0)}
    >>> evaluated(equations, [equations.reading("level_1")], level, ca.SX([0.1, 0, 0, 0]))
    [SX(5)]
    """
    function, constants = function_in(equations, expressions, symbols)
    return function.call([ca.SX(state), ca.SX(moved), constants])


def function_in(
    equations: ProcessEquations,
    expressions: Sequence[ca.SX],
    symbols: Symbols,
) -> tuple[ca.Function, ca.SX]:
    """Return expressions as a function of x, u and constants, and the constants within a law."""
    used = used_in(equations, expressions)
    arguments = [equations.state, equations.moved, ca.vertcat(*(each.symbol for each in used))]
    given = (symbols[model_parameter(each).name] for each in used)
    return ca.Function("at", arguments, list(expressions)), ca.SX(ca.vertcat(*given))


def model_parameter(constant: Constant) -> Signal:
    """Return the parameter of a law that stands for a constant of the process."""
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
