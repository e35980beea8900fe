"""The rules of Tyreus and Luyben: slower than Ziegler and Nichols, for integrating plants."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.pid_settings import PidSettings, SeriesSettings, from_series
from clepsydra.designs.loops.published_rule import AS_PUBLISHED, PublishedRule, RuleActions
from clepsydra.designs.loops.words import ultimate_words
from clepsydra.designs.models.ultimate_point import UltimatePoint, ultimate_point

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.designs.loops.pairing import PairedLoop, Pairing
    from clepsydra.linear.linear_model import LinearModel

METHOD = "Tyreus-Luyben"
SOURCE = "Tyreus and Luyben 1992, Luyben 1996"


def tyreus_luyben_settings(point: UltimatePoint, actions: RuleActions = "PI") -> PidSettings:
    """Return the settings from ultimate gain and period.

    PI: K = Ku/3.22, Ti = 2.2 Tu. PID, in series form: K' = 0.46 Ku, Ti' = 2.2 Tu and
    Td' = Tu/(2π), one over the ultimate frequency.

    References
    ----------
    B. D. Tyreus and W. L. Luyben, Tuning PI controllers for integrator/dead time processes,
    Industrial & Engineering Chemistry Research 31(11), 1992, 2625-2628,
    doi 10.1021/ie00011a029; W. L. Luyben, Tuning proportional-integral-derivative controllers
    for integrator/deadtime processes, same journal 35(10), 1996, 3480-3483,
    doi 10.1021/ie9600699.

    Examples
    --------
    >>> round(tyreus_luyben_settings(UltimatePoint(3.22, 10.0)).integral_time, 9)
    22.0
    """
    if actions == "PID":
        series = SeriesSettings(0.46 * point.gain, 2.2 * point.period, point.period / math.tau)
        return from_series(series)
    return PidSettings(point.gain / 3.22, 2.2 * point.period)


@design(
    "tyreus_luyben",
    "PI or PID by Tyreus and Luyben",
    Studied(70, "PI, Tyreus-Luyben"),
    keys=(AS_PUBLISHED,),
    method=METHOD,
)
def design_tyreus_luyben(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    as_published: bool = False,
) -> Controller:
    """Design a PI or PID controller for each pair by the rules of Tyreus and Luyben.

    The ultimate point is computed from the model, with its dead time and half a sampling
    period of delay. Unless `as_published`, all loops are slowed down by one factor until
    together they have a sensitivity peak of 2 (`designs.slowing_down`).

    Parameters
    ----------
    as_published : bool
        Keep the settings of the rules.

    Raises
    ------
    NotApplicable
        An element has no ultimate point, the loops are unstable together, or a setting is
        outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, or the form
        is none of these rules.

    References
    ----------
    As for `tyreus_luyben_settings`.

    Examples
    --------
    A level that integrates, with half a sampling period of 30 s of delay: Ti = 2.2 · 4 · 30 s.

    >>> import clepsydra as cl
    >>> analysis = cl.load("equalisation-tank").analysis
    >>> controller = design_tyreus_luyben(analysis.model, analysis.pairing, as_published=True)
    >>> round(controller.values["level.integral_time"], 6)
    264.0
    """
    return PublishedRule(METHOD, SOURCE, _rule).designed(model, pairing, form, as_published)


def _rule(loop: PairedLoop, delay: float, actions: RuleActions) -> tuple[PidSettings, str]:
    point = ultimate_point(loop.element, delay)
    return tyreus_luyben_settings(point, actions), ultimate_words(point, loop)
