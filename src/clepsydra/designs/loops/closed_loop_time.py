"""What the designs by a closed-loop time constant share: found or given, with its notes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from clepsydra.base.words import time_text
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.words import by_pair
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, note_on_peak
from clepsydra.linear.control_authority import DESIGN_STEP

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.designs.loops.multiloop import MultiloopPid
    from clepsydra.designs.loops.pairing import PairedLoop

CLOSED_LOOP_TIME = number(
    "closed_loop_time_constant",
    "a time",
    "closed-loop time constant of all loops",
    unit="s",
    example='"5 min"',
)


class TimedLoop(NamedTuple):
    """One loop whose settings follow from its closed-loop time constant.

    Parameters
    ----------
    settings_at : callable
        Closed-loop time constant [s] to settings.
    shortest : float
        The closed-loop time constant to begin with [s].
    words : str
        Its model, for the notes.
    """

    settings_at: Callable[[float], PidSettings]
    shortest: float
    words: str


def design_by_time(
    together: MultiloopPid,
    loops: Sequence[TimedLoop],
    given: float | None,
    source: str,
    models: str,
) -> Controller:
    """Return the controller for the given time, or the shortest that all loops together bear.

    Without a given time, all times are lengthened by one factor until the sampled loops
    together have a sensitivity peak of 2 (`designs.slowing_down`). A given time is used as it is.

    Parameters
    ----------
    loops : sequence of TimedLoop
        In the order of the pairing.
    given : float or None
        The closed-loop time constant of all loops [s].
    source : str
        "SIMC (Skogestad 2003)"
    models : str
        What the words of the loops are: "First-order models by the half rule".

    Raises
    ------
    NotApplicable
        The loops together are unstable, or a setting is outside of what a controller takes.
    InputError
        The given time is not above zero.

    Examples
    --------
    >>> from clepsydra.designs.loops.multiloop import MultiloopPid
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> analysis = cl.load("equalisation-tank").analysis
    >>> together = MultiloopPid(analysis.model, analysis.pairing, PidForm(), "by hand")
    >>> loop = TimedLoop(lambda time: PidSettings(-100.0 / time, 4 * time), 1e3, "a guess")
    >>> found = design_by_time(together, [loop], 500.0, "By hand", "Models")
    >>> found.values[f"{found.measurements[0]}.integral_time"]
    2000.0
    """

    def settings_at(times: Sequence[float]) -> list[PidSettings]:
        return [loop.settings_at(time) for loop, time in zip(loops, times, strict=True)]

    found, times = together.timed(settings_at, [loop.shortest for loop in loops], given)
    words = in_words(together.loops, [loop.words for loop in loops], times)
    if found.factor > 1.0:
        notes = [
            f"The closed-loop time constants were lengthened {found.factor:.3g} times, so that "
            f"the interacting loops keep a sensitivity peak of {SENSITIVITY_LIMIT:g}."
        ]
    else:
        notes = [*note_on_peak(found.peak, "choose a longer closed-loop time constant")] or [
            f"A setpoint step of {100 * DESIGN_STEP:.0f} % of the range was taken for the choice "
            "of the closed-loop time constants."
        ]
    return together.controller(found, source, [f"{models}: {words}.", *notes])


def in_words(loops: Sequence[PairedLoop], models: Sequence[str], times: Sequence[float]) -> str:
    """Return the model and the closed-loop time constant of each loop."""
    pairs = zip(models, times, strict=True)
    said = (f"{words}, closed-loop time constant {time_text(time)}" for words, time in pairs)
    return by_pair(loops, said)
