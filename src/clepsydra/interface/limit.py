"""`cl.limit`: how good control of a plant could possibly be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.arguments import require_signal, require_type
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.quantities import Quantity, check_within, read_signal
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shown import Answered, lifted
from clepsydra.interface.subject import StudyRequest, Subject, plant_of, read_subject
from clepsydra.limits import limits as inner
from clepsydra.limits.limits import LimitProgress, limits_of

if TYPE_CHECKING:
    from clepsydra.base.section import Section
    from clepsydra.interface.events import Events
    from clepsydra.interface.plant import Plant


@dataclass(frozen=True, eq=False, repr=False)
class Limits(Answered, inner.Limits):
    """The limit of every setpoint event: `index`, `found`, `refused` and `times(run)`."""

    def answer(self) -> Section:
        """Return the limit of each event, and how it was proved."""
        from clepsydra.report.limit_answer import limit_answer

        return limit_answer(self)


@keywords_checked()
def limit(
    plant: Subject,
    events: Events | None = None,
    *,
    duration: Quantity | None = None,
    within: Mapping[str, tuple[Quantity, Quantity]] | None = None,
    overshoot: bool = True,
    progress: Callable[[LimitProgress], None] | None = None,
) -> Limits:
    """Find the least error that any input, however clever its controller, leaves of each event.

    It is found on the nonlinear process at its sampling period, without noise, for inputs within
    their ranges, by an optimisation that knows each setpoint from its instant on, starts at rest
    and ends at rest.

    Parameters
    ----------
    plant : Plant, str or Path
        Or the path of a study file, whose scenario it is.
    events, duration : optional
        The scenario, as for `cl.simulate`; the default scenario if left out. Of a given duration
        every horizon ends where its event does.
    within : mapping, optional
        Input to the two ends between which it may move, {"pump_1": ("0 V", "8 V")}; its range if
        left out.
    overshoot : bool
        Whether the output that steps may go beyond its setpoint.
    progress : callable, optional
        Takes how far the search is, before each event.

    Returns
    -------
    Limits
        With `index`, the sum over the events; of each its errors and `proofs`; and `times(run)`.

    Raises
    ------
    InputError
        No input moves the output, the bounds are the wrong way round, the plant does not rest at
        the setpoint, or the duration is too short for it to come to rest.

    Examples
    --------
    >>> import clepsydra as cl
    >>> found = limit("quadruple-tank", [cl.step("level_1", "+1 V")])
    >>> round(found.index, 2)  # [s], of a step of 1 V
    1.78
    """
    require_type(overshoot, bool, "limit, overshoot", "True or False", "choose one")
    subject = plant
    if isinstance(subject, (str, Path)):
        subject = read_subject(subject)
    own = plant_of(subject)
    if isinstance(subject, StudyRequest) and events is None and duration is None:
        scenario = subject.scenario
    else:
        scenario = scenario_of(own, events, duration)
    if not any(each.kind == "setpoint" for each in scenario.segments):
        raise InputError(
            "limit, events", "no step of a setpoint that comes alone", "at least one",
            'write as in [cl.step("level_1", "+1 V")]',
        )  # fmt: skip
    found = limits_of(
        scenario,
        own.linear,
        bounds=_bounds(own, within or {}),
        overshoot=overshoot,
        extend=duration is None,
        progress=progress,
    )
    return lifted(Limits, found)


def _bounds(
    plant: Plant, within: Mapping[str, tuple[Quantity, Quantity]]
) -> dict[str, tuple[float, float]]:
    remedy = 'write as in {"pump_1": ("0 V", "8 V")}'
    require_type(within, Mapping, "limit, within", "inputs with their bounds", remedy)
    found = {}
    for name, ends in within.items():
        place = f"limit, within.{name}"
        signal = require_signal("limit, within", name, plant.process.inputs, "an input")
        if not (isinstance(ends, (tuple, list)) and len(ends) == 2):
            raise InputError(place, ends, "a lower and an upper end", remedy)
        low, high = (read_signal(place, "bound", end, signal, "a bound") for end in ends)
        for value, written in zip((low, high), ends, strict=True):
            check_within(place, "bound", signal, value, written, "a bound")
        if not low < high:
            raise InputError(
                place, f"{ends[0]} to {ends[1]}", "a lower end below the upper one",
                "exchange the two",
            )  # fmt: skip
        found[name] = (low, high)
    return found
