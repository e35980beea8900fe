"""Warnings of a closed loop or of a step law that is unstable, and of modes that drift unseen."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.words import listed, time_text
from clepsydra.controllers.controller import Controller
from clepsydra.linear.controllability import (
    NOT_AT_ALL,
    ModeMargin,
    controllability_margins,
    observability_margins,
)
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.studies.warnings.loop_response import LoopResponse

#: An eigenvalue of a law so near above one is an integrator with its rounding.
_INTEGRATOR = 1e-6
#: So near to a zero of the process, in shares of its distance from z = 1, a law cancels it.
_SAME = 0.1


def stability_warnings(
    controller: Controller,
    model: LinearModel,
    response: LoopResponse,
    blocking_zeros: list[complex],
) -> Iterator[Remark]:
    """Return warnings of an unstable closed loop, of hidden modes and of an unstable step law.

    *Loop.* An eigenvalue of the exact sampled loop, every state of process and law counted,
    outside the unit circle or on it.

    *Hidden modes.* A mode of the process that does not decay and that the manipulated variables
    do not move, or that the measurements of the law do not show (Popov, Belevitch and Hautus):
    no setting of the controller helps.

    *Law.* An eigenvalue of the step law by itself outside the unit circle. Such a law needs its
    loops closed: when an output stands at a limit nothing holds its state. A controller that
    inverts the process, as a dynamic decoupler or feedback linearisation does, has one at
    e^(zT) for every zero z of the process in the right half-plane: the outputs then look well
    while the inputs run away.

    Parameters
    ----------
    model : LinearModel
        With the measurements of the controller.
    blocking_zeros : list of complex
        Of the process in the right half-plane [rad/s].

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    4.7 on internal stability.
    """
    yield from _loop(response)
    yield from _hidden(model, tuple(dict.fromkeys(controller.measurements)), controller.manipulated)
    yield from _law(response, blocking_zeros)


def _loop(response: LoopResponse) -> Iterator[Remark]:
    if response.loop.is_stable:
        return
    largest = float(np.max(np.abs(np.linalg.eigvals(response.loop.A))))
    if largest <= 1.0 + _INTEGRATOR:
        how = "what disturbs it stays for ever"
    else:
        how = f"what disturbs it grows by the factor e in {_growth(largest, response.period)}"
    yield Remark(
        f"The closed loop of {listed(response.outputs)} is unstable by its linear model",
        how,
        "check the sign of each gain and the pairing, then lower the gains",
    )


@lru_cache(maxsize=16)
def _hidden(
    model: LinearModel, seen: tuple[str, ...], moved: tuple[str, ...]
) -> tuple[Remark, ...]:
    """Return what is hidden from all controllers that see and move the same."""
    shares = in_known_ranges(model.select(seen, moved))
    if shares is None:
        return ()
    resting = at_rest(shares)
    poles = np.linalg.eigvals(resting.A)
    if not np.any(poles.real >= -origin_radius(resting.A)):
        return ()
    moves, shows = controllability_margins(resting), observability_margins(resting)
    return (
        *_drifting(resting, moves, f"{listed(moved)} cannot move it", "input"),
        *_drifting(resting, shows, f"{listed(seen)} cannot show it", "sensor"),
    )


def _drifting(
    model: LinearModel, modes: list[ModeMargin], why: str, missing: str
) -> Iterator[Remark]:
    radius = origin_radius(model.A)
    states = [
        mode.state for mode in modes if mode.pole.real >= -radius and mode.share <= NOT_AT_ALL
    ]
    for state in dict.fromkeys(states):
        yield Remark(
            f"{state} does not come to rest by itself, and {why}",
            "it drifts to a limit whatever the controller does",
            f"give the loop another {missing}",
        )


def _law(response: LoopResponse, blocking_zeros: list[complex]) -> Iterator[Remark]:
    eigenvalues = np.linalg.eigvals(response.law.A)
    outside = eigenvalues[np.abs(eigenvalues) > 1.0 + _INTEGRATOR]
    if not outside.size:
        return
    fastest = outside[int(np.argmax(np.abs(outside)))]
    grows = _growth(float(np.abs(fastest)), response.period)
    inverted = [
        zero
        for zero in blocking_zeros
        if np.min(np.abs(outside - np.exp(zero * response.period)))
        <= _SAME * abs(np.exp(zero * response.period) - 1.0)
    ]
    if inverted:
        yield Remark(
            "The controller inverts the process with its zero in the right half-plane at "
            f"{abs(inverted[0]):.3g} rad/s, so that its internal dynamics are unstable",
            f"the inputs run away by the factor e in {grows} while the outputs look well",
            "use a static decoupler, or none",
        )
        return
    yield Remark(
        "The step law is unstable by itself",
        "while an output stands at a limit or a sensor has failed, its state grows by the "
        f"factor e in {grows}",
        "slow the observer or the feedback down until it is stable",
    )


def _growth(size: float, period: float) -> str:
    return time_text(period / float(np.log(size)))
