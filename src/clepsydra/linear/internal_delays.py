"""Dead times inside a linear model: signals that leave it and come back later."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from clepsydra.base.errors import InputError


@dataclass(frozen=True, eq=False)
class InternalDelays:
    """r signals w that leave a linear model and come back as z_i(t) = w_i(t - τ_i).

    With them the model is ẋ = A x + B u + E d + to_states z, y = C x + D u + to_outputs z and
    w = from_states x + from_inputs u + from_disturbances d + through z. A dead time at an
    input, at an output, in a pipe between two tanks or inside a controller all have this form,
    and joining two such models gives another one.

    Parameters
    ----------
    times : ndarray [r]
        Dead times τ [s], above zero.
    to_states : ndarray [n, r]
    from_states : ndarray [r, n]
    from_inputs : ndarray [r, m]
    from_disturbances : ndarray [r, k]
    through : ndarray [r, r]
        From one delayed signal to another that leaves at once.
    to_outputs : ndarray [q, r]

    Raises
    ------
    InputError
        A dead time is not finite or not above zero.

    Examples
    --------
    A tank whose outflow is what entered it 5 s ago, as a model without an input:

    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> InternalDelays(np.array([5.0]), -one, one, none, none, 0.0 * one, 0.0 * one).times
    array([5.])
    """

    times: np.ndarray
    to_states: np.ndarray
    from_states: np.ndarray
    from_inputs: np.ndarray
    from_disturbances: np.ndarray
    through: np.ndarray
    to_outputs: np.ndarray

    def __post_init__(self) -> None:
        for time in np.ravel(self.times):
            if not (np.isfinite(time) and time > 0.0):
                raise InputError(
                    "linear model, delays, times",
                    float(time),
                    "dead times above 0 s",
                    "leave out a signal that is not delayed",
                )

    def check_shapes(self, n: int, m: int, k: int, q: int) -> None:
        """Raise ValueError unless the matrices fit n states, m inputs, k disturbances, q outputs.

        >>> no_delays(2, 1, 0, 1).check_shapes(2, 1, 0, 1)
        """
        r = len(self.times)
        shapes = {
            "times": (r,),
            "to_states": (n, r),
            "from_states": (r, n),
            "from_inputs": (r, m),
            "from_disturbances": (r, k),
            "through": (r, r),
            "to_outputs": (q, r),
        }
        for field in fields(self):
            found = np.shape(getattr(self, field.name))
            if found != shapes[field.name]:
                raise ValueError(
                    f"linear model: delays.{field.name} is {found}, "
                    f"its names make {shapes[field.name]}"
                )

    def select(self, outputs: Sequence[int], inputs: Sequence[int]) -> InternalDelays:
        """Return the delays of the model with only these outputs and inputs, by their places.

        >>> no_delays(2, 3, 0, 1).select([0], [2, 1]).from_inputs.shape
        (0, 2)
        """
        return InternalDelays(
            self.times,
            self.to_states,
            self.from_states,
            self.from_inputs[:, list(inputs)],
            self.from_disturbances,
            self.through,
            self.to_outputs[list(outputs)],
        )


def no_delays(n: int, m: int, k: int, q: int) -> InternalDelays:
    """Return delays without a signal, for n states, m inputs, k disturbances and q outputs.

    Examples
    --------
    >>> len(no_delays(4, 2, 0, 2).times)
    0
    """
    shapes = ((n, 0), (0, n), (0, m), (0, k), (0, 0), (q, 0))
    return InternalDelays(np.zeros(0), *(np.zeros(shape) for shape in shapes))


def refuse_delays(delays: InternalDelays | None, what: str) -> None:
    """Raise InputError for a model with dead time, where only a rational one has an answer.

    Parameters
    ----------
    delays : InternalDelays or None
        Of the model.
    what : str
        What was asked for, a plural: "poles".

    Examples
    --------
    >>> refuse_delays(None, "poles")
    """
    if delays is not None:
        raise InputError(
            "linear model, delays",
            f"dead times of {', '.join(f'{time:.6g}' for time in delays.times)} s",
            f"a model without dead time, for {what}",
            "approximate the dead time by clepsydra.linear.pade.without_dead_time(model, order)",
        )
