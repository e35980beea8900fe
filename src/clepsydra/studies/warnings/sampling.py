"""Warnings of a sampling period that is too long for the loop."""

from __future__ import annotations

import math
from collections.abc import Iterator

from clepsydra.base.remark import Remark
from clepsydra.base.signal import path
from clepsydra.base.words import listed, time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.studies.warnings.loop_response import LoopResponse

#: ωc T from which on the sampling is too slow [rad].
_TOO_SLOW = 0.5
#: What the remedy asks for, well inside of it [rad].
_WANTED = 0.2


def sampling_warnings(controller: Controller, response: LoopResponse) -> Iterator[Remark]:
    """Return warnings of a loop that is too fast for its sampling period.

    *Crossover.* ωc T above 0.5 rad, ωc the highest frequency at which the loop of a controlled
    measurement has the gain one, the others closed. The hold delays by half a period, which
    takes ωc T/2 of phase, above this 14°; and the closed loop, whose time constant is about
    1/ωc, rises within fewer than four samples, where four to ten are usual.

    *Derivative filter.* A filter time of the derivative below the sampling period: between two
    samples the filter has forgotten everything, so that the derivative is the difference of two
    noisy samples.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, on the choice of
    the sampling period.
    """
    yield from _crossover(response)
    yield from _derivative(controller, response.period)


def _crossover(response: LoopResponse) -> Iterator[Remark]:
    period = response.period
    fastest = {name: response.channels[name].bandwidth for name in response.outputs}
    late = [name for name, omega in fastest.items() if omega * period > _TOO_SLOW]
    if not late:
        return
    omega = max(fastest[name] for name in late)
    loops, which = ("loop", "which") if len(late) == 1 else ("loops", "the fastest of which")
    yield Remark(
        f"The sampling period of {time_text(period)} is too long for the {loops} of "
        f"{listed(late)}, {which} crosses over at {omega:.3g} rad/s",
        f"the hold alone takes {math.degrees(omega * period / 2.0):.0f}° of phase",
        f"sample every {time_text(_WANTED / omega)} or lower the gain",
    )


def _derivative(controller: Controller, period: float) -> Iterator[Remark]:
    values, times = controller.values, {}
    for loop in owners(controller.law.parameters, "filter_time"):
        if values.get(path(loop, "derivative_gain"), 0.0):
            times[loop] = values[path(loop, "filter_time")]
    for loop in owners(controller.law.parameters, "derivative_time"):
        if (time := values[path(loop, "derivative_time")]) > 0.0:
            times[loop] = time / values[path(loop, "derivative_filter")]
    short = {loop: time for loop, time in times.items() if time < period}
    if not short:
        return
    loops = "loop" if len(short) == 1 else "loops"
    yield Remark(
        f"The derivative of {loops} {listed(list(short))} is filtered with "
        f"{listed([time_text(time) for time in short.values()])}, less than the sampling "
        f"period of {time_text(period)}",
        "it differentiates the noise of single samples",
        "lengthen the filter, or sample faster",
    )
