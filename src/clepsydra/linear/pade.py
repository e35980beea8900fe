"""Rational models in place of dead time: Padé approximation, and what is exact at rest."""

from __future__ import annotations

from dataclasses import replace
from math import comb, factorial

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import integrators

_HIGHEST_ORDER = 10
# Agrees with e^(-sτ) up to s⁶, so up to six integrators in series are counted exactly.
_ORDER_AT_THE_ORIGIN = 3


def without_dead_time(model: LinearModel, order: int) -> LinearModel:
    """Return a rational model in which each dead time is a Padé approximation.

    e^(-sτ) ≈ p(-sτ)/p(sτ), numerator and denominator of the same order: the gain is one at
    every frequency and the phase is right up to about ω = order/τ. Each dead time adds `order`
    states, and as many zeros in the right half-plane.

    Parameters
    ----------
    model : LinearModel
        Returned as it is where it has no dead time.
    order : int
        1 to 10.

    Returns
    -------
    LinearModel
        Its new states are dead_time_i.state_k, [1] beside the delayed signal.

    Raises
    ------
    InputError
        The order is out of range; a disturbance reaches an output through dead times alone,
        which the matrices of a rational `LinearModel` cannot hold; or delayed signals feed each
        other so that the approximation of this order is not well posed.

    References
    ----------
    G. H. Golub and C. F. Van Loan, Matrix Computations, 4th ed., 2013, chapter 9.

    Examples
    --------
    >>> from clepsydra.linear.internal_delays import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> late = InternalDelays(np.ones(1), -one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    >>> tank = LinearModel(0.0 * one, one, none, one, 0.0 * one, ("tank.level",), ("pump",), (),
    ...                    ("level",), delays=late)
    >>> np.linalg.eigvals(without_dead_time(tank, 5).A)[-2:].round(4)  # s + e^(-s) = 0
    array([-0.3181+1.3372j, -0.3181-1.3372j])
    """
    delays = model.delays
    if not 1 <= order <= _HIGHEST_ORDER or order != int(order):
        raise InputError(
            "Padé approximation, order", order, "a whole number from 1 to 10", "4 serves most loops"
        )
    if delays is None:
        return model
    # Each approximation is ẋ = a x + b w, z = c x + d w, side by side in block matrices.
    a, b, c, d = _approximation(order)
    r = len(delays.times)
    rates = 1.0 / delays.times
    inner = np.kron(np.diag(rates), a)
    driven = np.kron(np.diag(rates), b)
    shown = np.kron(np.eye(r), c)
    loop = np.eye(r) - d * delays.through
    if np.linalg.cond(loop) > 1e12:
        raise InputError(
            "Padé approximation, order",
            order,
            "an order that makes the delayed signals well posed",
            "take the order one higher or lower",
        )
    # z = d w + shown x, w = from z + through z, solved for w.
    solved = np.linalg.inv(loop)
    by_states, by_approximation = solved @ delays.from_states, solved @ delays.through @ shown
    by_inputs, by_disturbances = solved @ delays.from_inputs, solved @ delays.from_disturbances
    if np.any(delays.to_outputs @ by_disturbances):
        raise InputError(
            "linear model, delays",
            "a disturbance that reaches an output through dead time alone",
            "a state between each disturbance and each output",
            "name the disturbance as an input",
        )
    back = shown + d * by_approximation  # z by the approximation's states
    return replace(
        model,
        A=np.block(
            [
                [model.A + d * delays.to_states @ by_states, delays.to_states @ back],
                [driven @ by_states, inner + driven @ by_approximation],
            ]
        ),
        B=np.vstack([model.B + d * delays.to_states @ by_inputs, driven @ by_inputs]),
        E=np.vstack([model.E + d * delays.to_states @ by_disturbances, driven @ by_disturbances]),
        C=np.hstack([model.C + d * delays.to_outputs @ by_states, delays.to_outputs @ back]),
        D=model.D + d * delays.to_outputs @ by_inputs,
        states=(
            *model.states,
            *(f"dead_time_{i}.state_{k}" for i in range(1, r + 1) for k in range(1, order + 1)),
        ),
        delays=None,
    )


def at_rest(model: LinearModel) -> LinearModel:
    """Return the model with its dead times at zero: the same where nothing moves.

    Its G(0) is that of the model. Its poles are not.

    Parameters
    ----------
    model : LinearModel

    Raises
    ------
    numpy.linalg.LinAlgError
        Delayed signals feed each other with a gain of one, so nothing holds them at rest.

    Examples
    --------
    >>> from clepsydra.linear.internal_delays import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> late = InternalDelays(np.ones(1), -one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    >>> at_rest(LinearModel(0.0 * one, one, none, one, 0.0 * one, ("tank.level",), ("pump",), (),
    ...                     ("level",), delays=late)).A
    array([[-1.]])
    """
    delays = model.delays
    if delays is None:
        return model
    solved = np.linalg.inv(np.eye(len(delays.times)) - delays.through)
    return replace(
        model,
        A=model.A + delays.to_states @ solved @ delays.from_states,
        B=model.B + delays.to_states @ solved @ delays.from_inputs,
        E=model.E + delays.to_states @ solved @ delays.from_disturbances,
        C=model.C + delays.to_outputs @ solved @ delays.from_states,
        D=model.D + delays.to_outputs @ solved @ delays.from_inputs,
        delays=None,
    )


def same_at_the_origin(model: LinearModel) -> LinearModel:
    """Return a rational model whose G(s) has the same limit, and the same growth, as s → 0.

    Where nothing integrates that is the model at rest. Where something does, the dead times
    matter even there (a tank filled now and emptied τ later by the same amount ends higher by
    τ times the flow), and a Padé approximation takes their place, whose series in s is that of
    the dead time up to s⁶.

    Parameters
    ----------
    model : LinearModel

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> same_at_the_origin(tank) is tank
    True
    """
    if model.delays is None:
        return model
    size = np.eye(len(model.delays.times)) - model.delays.through
    if np.linalg.cond(size) < 1e12:
        resting = at_rest(model)
        if not integrators(resting.A):
            return resting
    return without_dead_time(undisturbed(model), _ORDER_AT_THE_ORIGIN)


def undisturbed(model: LinearModel) -> LinearModel:
    """Return the model without its disturbances, for what does not depend on them.

    Examples
    --------
    >>> one = np.eye(1)
    >>> undisturbed(LinearModel(-one, one, one, one, 0.0 * one, ("tank.level",), ("pump",),
    ...                         ("inflow",), ("level",))).E.shape
    (1, 0)
    """
    late = model.delays
    if late is not None:
        late = replace(late, from_disturbances=late.from_disturbances[:, :0])
    return replace(model, E=model.E[:, :0], disturbances=(), delays=late)


def _approximation(order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return a state space of the Padé approximation of a dead time of one second.

    The states of its companion form are scaled by the coefficients, which keeps its entries
    near one.
    """
    weights = [  # p(s) = Σ weights[k] s^k
        comb(order, k) * factorial(2 * order - k) / factorial(2 * order) for k in range(order + 1)
    ]
    denominator = np.array(weights) / weights[-1]
    numerator = denominator * (-1.0) ** np.arange(order + 1)
    direct = float(numerator[-1])
    a = np.eye(order, k=1)
    a[-1] = -denominator[:-1]
    b = np.zeros((order, 1))
    b[-1] = 1.0
    c = (numerator - direct * denominator)[:-1][None, :]
    sizes = 1.0 / denominator[:-1]
    return sizes[:, None] ** -1 * a * sizes, b / sizes[:, None], c * sizes, direct
