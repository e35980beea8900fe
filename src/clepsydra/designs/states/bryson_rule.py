"""Bryson's rule: weights from the largest acceptable deviations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.of_process import largest_deviations
from clepsydra.designs.loops.control_authority import control_authorities
from clepsydra.designs.request import in_shown_unit, positive_number
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.linear.control_authority import DESIGN_STEP
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.late_outputs import late_outputs
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.poles import origin_radius, time_constants
from clepsydra.linear.zeros import zeros
from clepsydra.process.process import Process

#: Largest deviations that a design by Bryson's rule accepts.
DEVIATIONS = (
    largest_deviations(
        "maximum_errors",
        'largest acceptable deviations of controlled measurements: `{ level = "5 %" }`',
        of_inputs=False,
    ),
    largest_deviations(
        "maximum_moves",
        'largest acceptable deviations of inputs: `{ outflow = "20 %" }`',
        of_inputs=True,
    ),
)


class Deviations(NamedTuple):
    """The largest acceptable deviations, and how long an error may last.

    Parameters
    ----------
    errors, moves : dict
        Output and input names to deviations [their units].
    horizon : float
        T [s]

    Examples
    --------
    >>> Deviations({"level": 0.1}, {"pump": 3.0}, 30.0).slower(2.0)
    Deviations(errors={'level': 0.1}, moves={'pump': 1.5}, horizon=60.0)
    """

    errors: dict[str, float]
    moves: dict[str, float]
    horizon: float

    def slower(self, factor: float) -> Deviations:
        """Return deviations that ask for less: smaller moves and a longer horizon."""
        moves = {name: value / factor for name, value in self.moves.items()}
        return Deviations(self.errors, moves, self.horizon * factor)

    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return errors and moves as arrays [q] and [m]."""
        return np.array(list(self.errors.values())), np.array(list(self.moves.values()))

    def in_words(self, process: Process) -> str:
        """Return them as the reader sees them."""
        parts = [
            f"{name} {in_shown_unit(process.signal(name), value)}"
            for name, value in (self.errors | self.moves).items()
        ]
        return f"largest acceptable deviations {', '.join(parts)}"

    def weights(self, model: LinearModel) -> QuadraticWeights:
        """Return Bryson's weights of a model."""
        return bryson_weights(model, *self.sizes(), self.horizon)


def acceptable_deviations(
    model: LinearModel,
    maximum_errors: Mapping[str, float] | None,
    maximum_moves: Mapping[str, float] | None,
) -> Deviations:
    """Return Bryson's deviations: the default ones, with those that were given in their place.

    Parameters
    ----------
    model, maximum_errors, maximum_moves
        As for `design_lqi`.

    Raises
    ------
    InputError
        A mapping names an unknown signal, or a deviation is not above zero.
    NotApplicable
        The model has nothing to tell a horizon from.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> acceptable_deviations(model, {"level_1": 0.5}, None).errors
    {'level_1': 0.5, 'level_2': 1.0}
    """
    point = operating_point_of(model)
    errors = acceptable_errors(model, maximum_errors)
    rooms = control_authorities(point, model.inputs).tolist()
    usual = dict(zip(model.inputs, rooms, strict=True))
    moves = _given("maximum_moves", maximum_moves, usual)
    asked = Deviations(errors, moves, 0.0)
    return asked._replace(horizon=_horizon(model, *asked.sizes()))


def acceptable_errors(
    model: LinearModel, maximum_errors: Mapping[str, float] | None
) -> dict[str, float]:
    """Return the largest acceptable error of each output: a tenth of its range if none is given.

    Raises
    ------
    InputError
        The mapping names an unknown output, or an error is not above zero.

    Examples
    --------
    >>> import clepsydra as cl
    >>> acceptable_errors(cl.load("averaging-tank").linear, {"volume": 0.1})
    {'concentration': 2500.0, 'volume': 0.1}
    """
    signal = operating_point_of(model).process.signal
    steps = {name: DESIGN_STEP * signal(name).span for name in model.outputs}
    return _given("maximum_errors", maximum_errors, steps)


def bryson_weights(
    model: LinearModel,
    maximum_errors: np.ndarray,
    maximum_moves: np.ndarray,
    settling_horizon: float | np.ndarray,
) -> QuadraticWeights:
    """Return Bryson's weights, each the inverse square of the largest acceptable deviation.

    The cost is ∫ Σ (y_j/ȳ_j)² + Σ (u_i/ū_i)² dt + Δt Σ_k Σ_j (w_j(k)/(ȳ_j T))², where T is the
    time for which a largest error may last.

    Parameters
    ----------
    maximum_errors : ndarray [q]
        ȳ [output unit]
    maximum_moves : ndarray [m]
        ū [input unit]
    settling_horizon : float or ndarray [q]
        T [s]

    References
    ----------
    A. E. Bryson and Y.-C. Ho, Applied Optimal Control, Hemisphere 1975, chapter 5.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], 5.0 * one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> float(bryson_weights(tank, np.ones(1), np.array([2.0]), 10.0).states[0, 0])
    25.0
    """
    errors, moves = np.asarray(maximum_errors, float), np.asarray(maximum_moves, float)
    shown = late_outputs(model).prompt.C
    return QuadraticWeights(
        states=shown.T @ np.diag(errors**-2) @ shown,
        inputs=np.diag(moves**-2),
        integrals=np.diag((errors * settling_horizon) ** -2),
    )


def inverse_response(model: LinearModel) -> float:
    """Return 1/z of the slowest zero z in the right half-plane [s], zero where there is none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank-nonminimum-phase").linear
    >>> round(inverse_response(model), 1), inverse_response(cl.load("quadruple-tank").linear)
    (78.4, 0.0)
    """
    model = at_rest(model)
    radius = origin_radius(model.A)
    return max((1.0 / float(abs(zero)) for zero in zeros(model) if zero.real > radius), default=0.0)


def _horizon(model: LinearModel, errors: np.ndarray, moves: np.ndarray) -> float:
    """Return the time for which a largest error may last [s]."""
    late = float(model.times.sum())
    model = at_rest(model)
    times = [float(time) for time in time_constants(model) if math.isfinite(time) and time > 0.0]
    inverse = inverse_response(model)
    if times or inverse or late:
        return max(max(times, default=0.0) / 3.0, inverse, late)
    rates = np.abs(model.C @ model.B) @ moves
    if not np.all(rates > 0.0):
        raise NotApplicable("the model has no time constant to scale the weights with")
    return float(np.max(errors / rates))


def _given(
    place: str, given: Mapping[str, float] | None, default: dict[str, float]
) -> dict[str, float]:
    """Return the default deviations with those that were given in their place, checked."""
    given = {} if given is None else given
    if not isinstance(given, Mapping):
        raise InputError(place, given, "names with numbers", "give a dictionary")
    for name, value in given.items():
        check_choice(place, name, [*default])
        expected = f"a deviation above zero, as a number in the unit of {name}"
        remedy = "give its largest acceptable deviation"
        positive_number(f"{place}, {name}", value, expected, remedy)
    return {name: float(given.get(name, value)) for name, value in default.items()}
