"""A step law: the one place where what happens in a sample is written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.dense_function import DenseFunction, at_rows
from clepsydra.program.equations import Equations as Equations
from clepsydra.program.equations import Symbols as Symbols
from clepsydra.program.equations import function_of
from clepsydra.program.kept_equations import has_calls, kept_equations


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
    notes : tuple of str
        What is to be told to who takes it.
    check : callable or None
        Law, values and the place for a message; refuses values that are each in their range and do
        not go together.
    unsolved : str
        The state that counts the samples in which a search found nothing; empty where none does.

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
    notes: tuple[str, ...] = ()
    check: Callable[[StepLaw, Mapping[str, float], str], None] | None = field(
        default=None, repr=False
    )
    unsolved: str = ""

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled: the equations as data, and nothing that follows from them."""
        state = {each.name: getattr(self, each.name) for each in fields(self)}
        if self.equations is not None:
            groups = self.state, self.inputs, self.parameters
            state["equations"] = kept_equations(self.name, groups, self.outputs, self.equations)
        return state

    @cached_property
    def jacobians(self) -> Callable[..., Sequence[np.ndarray]]:
        """Function (state, inputs, parameters) → ∂x⁺/∂x, ∂x⁺/∂u, ∂y/∂x and ∂y/∂u, of numbers."""
        function = self.function
        if has_calls(function):
            from clepsydra.program.known_routines import where_linear  # with what writes routines

            function = where_linear(function)
        symbols = [ca.SX.sym(n, function.numel_in(k)) for k, n in enumerate("xup")]
        next_state, outputs, _ = function(*symbols)
        return DenseFunction(
            "jacobians",
            symbols,
            [ca.jacobian(of, by) for of in (next_state, outputs) for by in symbols[:2]],
        )

    def next_states(
        self, state: np.ndarray, inputs: np.ndarray, parameters: np.ndarray
    ) -> np.ndarray:
        """Return the state after a sample in k cases [k, n].

        Parameters
        ----------
        state, inputs, parameters : ndarray [k, n], [k, m], [k, p]

        Examples
        --------
        >>> law = step_law(
        ...     "counter", inputs=[Signal("step")], parameters=[], state=[Signal("count")],
        ...     outputs=[], equations=lambda s: Equations({"count": s["count"] + s["step"]}, {}),
        ... )
        >>> none = np.zeros((2, 0))
        >>> law.next_states(np.array([[1.0], [2.0]]), np.array([[0.5], [4.0]]), none).ravel()
        array([1.5, 6. ])
        """
        return at_rows(self.function, [state, inputs, parameters])

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
