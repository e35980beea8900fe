"""Active disturbance rejection by bandwidths: one for the loop, a multiple for its observer."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.disturbance_rejection import FAMILY, disturbance_rejection_law
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.design import design
from clepsydra.designs.loops.closed_loop_time import CLOSED_LOOP_TIME, in_words
from clepsydra.designs.loops.loops_together import LoopsTogether
from clepsydra.designs.loops.multiloop import MultiloopPid
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.loops.words import model_words
from clepsydra.designs.models.delayed_lags import half_rule
from clepsydra.designs.slowing_down import note_on_peak
from clepsydra.linear.linear_model import LinearModel

METHOD = "disturbance rejection"
#: Of the observer to the loop: faster hears more noise, slower leaves less margin.
RATIO = 5.0
_RATIO = number(
    "observer_ratio",
    "a factor",
    "how many times faster than its loop an observer is",
    example=f"{RATIO:g}",
)


@design(
    "disturbance_rejection",
    "active disturbance rejection (ADRC)",
    keys=(CLOSED_LOOP_TIME, _RATIO),
    method=METHOD,
)
def design_disturbance_rejection(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    closed_loop_time_constant: float | None = None,
    observer_ratio: float = RATIO,
) -> Controller:
    """Design a loop of active disturbance rejection for each pair.

    Of each paired element the half rule leaves the slope b0 and an effective delay, to which half
    a sampling period is added; its lag is left to the observer, as is the load. The loop has the
    bandwidth ωc = 1/τc and the observer ωo = ratio · ωc. Without a given τc each loop takes the
    shortest that is not below its effective delay and at which a setpoint step of a tenth of the
    measurement's range does not saturate the input; then all are lengthened by one factor until
    the sampled loops together have a sensitivity peak of 2 (`designs.slowing_down`).

    Apt where loads count and models are poor: it needs one number of the process, b0, and reaches
    the setpoint without an integral that could wind up.

    Parameters
    ----------
    closed_loop_time_constant : float, optional
        τc of all loops [s].
    observer_ratio : float
        ωo/ωc, usually 3 to 10.

    Raises
    ------
    NotApplicable
        An element has no first-order model, the loops are unstable together, or a setting is
        outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, or a number is
        not above zero.

    References
    ----------
    Z. Gao, Scaling and bandwidth-parameterization based controller tuning, American Control
    Conference 2003, 4989-4996; G. Herbst, Electronics 2(3), 2013, 246-279,
    doi 10.3390/electronics2030246, for the ratio.

    Examples
    --------
    A level that integrates, with τc = 1000 s; the observer is five times as fast:

    >>> import clepsydra as cl
    >>> plant = cl.load("equalisation-tank")
    >>> found = design_disturbance_rejection(plant.linear, closed_loop_time_constant=1000.0)
    >>> found.values["level.bandwidth"], found.values["level.observer_bandwidth"]
    (0.001, 0.005)
    """
    together = MultiloopPid(model, pairing, None, METHOD)
    loops, point = together.loops, together.point
    reduced = together.each(lambda loop: half_rule(loop.element, together.delay))
    law = disturbance_rejection_law([x.output for x in loops], [x.input for x in loops])
    # Its state at rest does not depend on its bandwidths.
    blank = numbers_at(point, law.parameters, model_gain=[each.slope for each in reduced])

    def values_of(times: Sequence[float]) -> dict[str, float]:
        own = {"bandwidth": 1.0, "observer_bandwidth": observer_ratio}
        return {
            path(loop.output, name): share / time
            for loop, time in zip(loops, times, strict=True)
            for name, share in own.items()
        }

    rejecting = LoopsTogether(controller_at(point, "ADRC", FAMILY, law, blank), model, values_of)
    shortest = [
        max(each.delay, 1.0 / (abs(each.slope) * loop.largest_gain))
        for loop, each in zip(loops, reduced, strict=True)
    ]
    found, times = rejecting.timed(list, shortest, closed_loop_time_constant)
    models = [model_words(each, loop) for each, loop in zip(reduced, loops, strict=True)]
    words = (
        "Active disturbance rejection (Gao 2003), the observer "
        f"{observer_ratio:g} times as fast as its loop"
    )
    note = f"First-order models by the half rule: {in_words(loops, models, times)}."
    more = note_on_peak(found.peak, "choose a longer closed-loop time constant")
    return rejecting.made(found, words, [note, *more])
