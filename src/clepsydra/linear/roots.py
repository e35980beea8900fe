"""Poles and zeros of a model, with dead time as far as they mean something."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from clepsydra.linear.dead_time import (
    at_rest,
    dead_times,
    has_delay_in_loop,
    lags_of,
    undisturbed,
    without_dead_time,
)
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import poles, time_constants
from clepsydra.linear.zeros import minimum_phase, zeros

#: Order of the Padé approximation where one is needed. It holds up to about this over τ.
PADE_ORDER = 6


class Roots(NamedTuple):
    """Poles, time constants and zeros, and what has to be said about them.

    Parameters
    ----------
    poles, zeros : ndarray, complex
        [rad/s], rightmost first.
    time_constants : ndarray
        [s], in the order of the poles.
    minimum_phase : bool
        Whether neither a zero in the right half-plane nor a dead time limits control.
    zeros_of : LinearModel
        The rational model that has these zeros.
    note : str
        Empty without dead time.
    """

    poles: np.ndarray
    time_constants: np.ndarray
    zeros: np.ndarray
    minimum_phase: bool
    zeros_of: LinearModel
    note: str = ""


@lru_cache(maxsize=16)
def roots_of(model: LinearModel) -> Roots:
    """Return poles, time constants and zeros; the controllers of a study ask for the same ones.

    With dead time in no loop the poles are those of the states alone, exactly; and where the
    dead times only shift the outputs against the inputs, so are the zeros of what is shifted.
    Otherwise there are infinitely many, and those of a Padé approximation are returned as far
    out as it holds, 6/τ for the longest dead time τ.

    Examples
    --------
    1/(s + e^(-s)) has no finite zero and infinitely many poles, of which two are near:

    >>> from clepsydra.linear.linear_model import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> late = InternalDelays(np.ones(1), -one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    >>> roots_of(LinearModel(0.0 * one, one, none, one, 0.0 * one, ("tank.level",), ("pump",), (),
    ...                      ("level",), delays=late)).poles[:2].round(4)
    array([-0.3181+1.3372j, -0.3181-1.3372j])
    """
    if model.delays is None:
        return Roots(poles(model), time_constants(model), zeros(model), minimum_phase(model), model)
    in_loop, lags = has_delay_in_loop(model), lags_of(model)
    if in_loop or lags is None:
        approximate = without_dead_time(undisturbed(model), PADE_ORDER)
        reach = PADE_ORDER / float(model.delays.times.max())
    shown = approximate if in_loop else at_rest(model)
    rates, constants = poles(shown), time_constants(shown)
    if in_loop:
        near = np.abs(rates) <= reach
        rates, constants = rates[near], constants[near]
    zeros_of = at_rest(model) if lags is not None else approximate
    rises = zeros(zeros_of)
    if lags is None:
        rises = rises[np.abs(rises) <= reach]
    undelayed = not np.any(np.nan_to_num(dead_times(model), nan=1.0) > 0.0)
    well_behaved = undelayed and minimum_phase(zeros_of)
    return Roots(rates, constants, rises, well_behaved, zeros_of, _note(model, in_loop, lags))


def _note(model: LinearModel, in_loop: bool, lags: object) -> str:
    assert model.delays is not None
    approximation = (
        f"of a Padé approximation of order {PADE_ORDER}, as far as it holds, "
        f"{PADE_ORDER / float(model.delays.times.max()):.3g} rad/s"
    )
    if in_loop:
        return (
            "Dead time stands in a loop within the process, so it has infinitely many poles: "
            f"poles and zeros are those {approximation}."
        )
    if lags is None:
        return (
            "The poles are exact, since no loop within the process has dead time. Ways of "
            "different dead time lead to the outputs, so there may be infinitely many zeros: "
            f"those shown are {approximation}."
        )
    return (
        "Poles and zeros are exact: no loop within the process has dead time, and what it does "
        "besides shifting the outputs in time has these."
    )
