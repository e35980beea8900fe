"""A step law: the one place where what happens in a sample is written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.dense_function import DenseFunction

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


@dataclass(frozen=True)
class StepLaw:
    """A pure function (state, inputs, parameters) → (next state, outputs) of scalar signals.

    State never lives in a law: a run can be copied, replayed, batched and exported because
    everything that the next sample needs is in `state`.

    Parameters
    ----------
    name : str
        An identifier.
    inputs, parameters, outputs, intermediates : tuple of Signal
    state : tuple of Signal or DelayRing
    function : casadi.Function
        SX function (state [n], inputs [m], parameters [p]) →
        (next state [n], outputs [q], intermediates [r]); the entry of a delay ring is its
        oldest value on the way in and the value to write on the way out.
    description : tuple of str
        What it computes, a line each, for its reader.
    blocks : tuple
        What it was joined from, for who draws or tabulates it.
    equations : callable or None
        What the function was made of; None where it is no expression.

    Examples
    --------
    >>> law = step_law(
    ...     "accumulator",
    ...     inputs=[Signal("flow", "m^3/s")],
    ...     parameters=[Signal("time_step", "s", initial=2.0)],
    ...     state=[Signal("volume", "m^3")],
    ...     outputs=[Signal("total", "m^3")],
    ...     equations=lambda s: Equations(
    ...         next_state={"volume": s["volume"] + s["flow"] * s["time_step"]},
    ...         outputs={"total": s["volume"]},
    ...     ),
    ... )
    >>> next_state, outputs, _ = law.function([1.0], [0.25], [2.0])
    >>> float(next_state), float(outputs)
    (1.5, 1.0)
    """

    name: str
    inputs: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    state: tuple[Signal | DelayRing, ...]
    outputs: tuple[Signal, ...]
    intermediates: tuple[Signal, ...]
    function: ca.Function
    description: tuple[str, ...] = ()
    blocks: tuple[Any, ...] = ()
    equations: Callable[[dict[str, ca.SX]], Equations] | None = field(default=None, repr=False)

    @cached_property
    def jacobians(self) -> Callable[..., Sequence[np.ndarray]]:
        """Function (state, inputs, parameters) → ∂x⁺/∂x, ∂x⁺/∂u, ∂y/∂x and ∂y/∂u, of numbers."""
        symbols = [ca.SX.sym(n, self.function.numel_in(k)) for k, n in enumerate("xup")]
        next_state, outputs, _ = self.function(*symbols)
        return DenseFunction(
            "jacobians",
            symbols,
            [ca.jacobian(of, by) for of in (next_state, outputs) for by in symbols[:2]],
        )

    def depends(self, result: int, argument: int) -> np.ndarray:
        """Return where a result depends on an argument in the same sample.

        Parameters
        ----------
        result : int
            0 for the next state, 1 for the outputs.
        argument : int
            0 for the state, 1 for the inputs.

        Returns
        -------
        numpy.ndarray of bool
            A row each signal of the result, a column each of the argument.

        Examples
        --------
        >>> law = step_law(
        ...     "delayed", inputs=[Signal("level")], parameters=[], state=[Signal("kept")],
        ...     outputs=[Signal("before")],
        ...     equations=lambda s: Equations({"kept": s["level"]}, {"before": s["kept"]}),
        ... )
        >>> law.depends(0, 1).item(), law.depends(1, 1).item()
        (True, False)
        """
        sparsity = self.function.jac_sparsity(result, argument)
        found = np.zeros((sparsity.size1(), sparsity.size2()), dtype=bool)
        found[sparsity.row(), sparsity.get_col()] = True
        return found


def step_law(
    name: str,
    *,
    inputs: Iterable[Signal],
    parameters: Iterable[Signal],
    state: Iterable[Signal | DelayRing],
    outputs: Iterable[Signal],
    equations: Callable[[dict[str, ca.SX]], Equations],
    description: Iterable[str] = (),
    blocks: Iterable[Any] = (),
) -> StepLaw:
    """Write a step law from equations over named scalars.

    Parameters
    ----------
    name : str
        An identifier.
    inputs, parameters, state, outputs
        The signals of the law; every name is unique among inputs, parameters and state.
    equations : callable
        Takes a mapping from name to CasADi SX scalar (inputs, parameters and state together)
        and returns the `Equations`.
    description, blocks : iterable
        As in `StepLaw`.

    Raises
    ------
    ValueError
        Names clash, or the equations leave a state or output undefined or give it a vector.

    Examples
    --------
    A filter of first order that takes half of each step:

    >>> halve = step_law(
    ...     "halve", inputs=[Signal("level", "m")], parameters=[], state=[Signal("kept", "m")],
    ...     outputs=[Signal("smooth", "m")],
    ...     equations=lambda s: Equations(
    ...         {"kept": (s["kept"] + s["level"]) / 2}, {"smooth": s["kept"]}
    ...     ),
    ... )
    >>> [float(value) for value in halve.function([1.0], [3.0], [])[:2]]
    [2.0, 1.0]
    """
    inputs, parameters = tuple(inputs), tuple(parameters)
    state, outputs = tuple(state), tuple(outputs)
    function, written = function_of(name, (state, inputs, parameters), outputs, equations)
    intermediates = tuple(map(Signal, written.intermediates))
    signals = (inputs, parameters, state, outputs, intermediates)
    return StepLaw(name, *signals, function, tuple(description), tuple(blocks), equations)


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
