"""What equations compute in one sample, and their CasADi function."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing

#: Named quantities of an equation, as CasADi scalars.
Symbols = Mapping[str, ca.SX]


@dataclass(frozen=True)
class Equations:
    """What a step law computes in one sample, as expressions by name.

    Parameters
    ----------
    next_state : mapping
        State name to its next value; for a delay ring the value that is written.
    outputs : mapping
        Output name to its value.
    intermediates : mapping
        Names for values on the way, which a printed program uses as variable names.
    words : mapping
        Of those names, outputs and states what a reader is told above the step that computes one.

    Examples
    --------
    >>> level = ca.SX.sym("level")
    >>> equations = Equations({"level": 0.9 * level}, {"reading": 50 * level})
    >>> list(equations.next_state), dict(equations.intermediates)
    (['level'], {})
    """

    next_state: Mapping[str, Any]
    outputs: Mapping[str, Any]
    intermediates: Mapping[str, Any] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)


def function_of(
    name: str,
    arguments: Sequence[Sequence[Signal | DelayRing]],
    outputs: Sequence[Signal],
    equations: Callable[[dict[str, ca.SX]], Equations],
) -> tuple[ca.Function, Equations]:
    """Return equations as an SX function, and as they were written.

    Parameters
    ----------
    name : str
    arguments : sequence of sequences
        State, inputs, parameters.
    outputs : sequence of Signal
    equations : callable
        It may add to the arguments as it is called, and their symbols to those that it is given.

    Raises
    ------
    ValueError
        See `step_law`.

    Examples
    --------
    >>> function, _ = function_of("halve", ([], [Signal("level")], []), [Signal("half")],
    ...                           lambda s: Equations({}, {"half": s["level"] / 2}))
    >>> float(function([], [3.0], [])[1])
    1.5
    """
    symbols = {entry.name: ca.SX.sym(entry.name) for group in arguments for entry in group}
    written = equations(symbols)
    groups = [[entry.name for entry in group] for group in arguments]
    names = [entry for group in groups for entry in group]
    if len(set(names)) != len(names):
        clash = sorted({entry for entry in names if names.count(entry) > 1})
        raise ValueError(f"step law {name}: the names {clash} stand for more than one signal")
    function = ca.Function(
        name,
        [ca.vertcat(ca.SX(0, 1), *(symbols[entry] for entry in group)) for group in groups],
        [
            _stack(name, "next state", groups[0], written.next_state),
            _stack(name, "outputs", [signal.name for signal in outputs], written.outputs),
            ca.vertcat(*written.intermediates.values()),
        ],
        ["state", "inputs", "parameters"],
        ["next_state", "outputs", "intermediates"],
    )
    steps = {*written.next_state, *written.outputs, *written.intermediates}
    if unknown := sorted(set(written.words) - steps):
        raise ValueError(f"step law {name}: words for {unknown}, which it does not compute")
    return function, written


def is_scalar(value: Any) -> bool:
    """Tell whether what stands for a signal is one number or one expression.

    Examples
    --------
    >>> is_scalar(ca.SX.sym("level")), is_scalar(2.0), is_scalar([1.0, 2.0])
    (True, True, False)
    """
    # Nearly all are expressions already, and to convert one takes longer than all of the rest.
    return (value if isinstance(value, ca.SX) else ca.SX(value)).numel() == 1


def _stack(law: str, what: str, names: list[str], values: Mapping[str, Any]) -> ca.SX:
    if set(names) != set(values):
        missing, unknown = sorted(set(names) - set(values)), sorted(set(values) - set(names))
        raise ValueError(f"step law {law}: {what} lacks {missing} and has unknown {unknown}")
    for name in names:
        if not is_scalar(values[name]):
            raise ValueError(f"step law {law}: {what} {name} is not a scalar")
    return ca.vertcat(*[values[name] for name in names]) if names else ca.SX(0, 1)
