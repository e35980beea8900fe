"""The rules of Ziegler and Nichols, from the ultimate point and from the reaction curve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from clepsydra.base.words import time_text
from clepsydra.designs.arguments.argument import word
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.published_rule import AS_PUBLISHED, PublishedRule, RuleActions
from clepsydra.designs.loops.words import slope, ultimate_words
from clepsydra.designs.models.reaction_curve import reaction_curve
from clepsydra.designs.models.ultimate_point import UltimatePoint, ultimate_point

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.designs.loops.pairing import PairedLoop, Pairing
    from clepsydra.linear.linear_model import LinearModel

METHOD = "Ziegler-Nichols"
Experiment = Literal["ultimate_point", "step_response"]
SOURCE = "Ziegler and Nichols 1942"


def ziegler_nichols_settings(point: UltimatePoint, actions: RuleActions = "PI") -> PidSettings:
    """Return the settings from ultimate gain and period.

    PI: K = 0.45 Ku, Ti = Tu/1.2. PID: K = 0.6 Ku, Ti = Tu/2, Td = Tu/8.

    References
    ----------
    J. G. Ziegler and N. B. Nichols, Optimum settings for automatic controllers,
    Transactions of the ASME 64(8), 1942, 759-765, doi 10.1115/1.4019264.

    Examples
    --------
    >>> ziegler_nichols_settings(UltimatePoint(10.0, 8.0), "PID")
    PidSettings(gain=6.0, integral_time=4.0, derivative_time=1.0)
    """
    if actions == "PID":
        return PidSettings(0.6 * point.gain, point.period / 2.0, point.period / 8.0)
    return PidSettings(0.45 * point.gain, point.period / 1.2)


def ziegler_nichols_step_settings(
    slope: float, delay: float, actions: RuleActions = "PI"
) -> PidSettings:
    """Return the settings from the slope R and the delay L of the reaction curve.

    PI: K = 0.9/(R L), Ti = L/0.3. PID: K = 1.2/(R L), Ti = 2 L, Td = L/2.

    Parameters
    ----------
    slope : float
        R of the response to a unit step [output unit/(input unit·s)].
    delay : float
        L [s]

    References
    ----------
    J. G. Ziegler and N. B. Nichols, Optimum settings for automatic controllers,
    Transactions of the ASME 64(8), 1942, 759-765, doi 10.1115/1.4019264.

    Examples
    --------
    >>> ziegler_nichols_step_settings(0.5, 4.0, "PID")
    PidSettings(gain=0.6, integral_time=8.0, derivative_time=2.0)
    """
    if actions == "PID":
        return PidSettings(1.2 / (slope * delay), 2.0 * delay, 0.5 * delay)
    return PidSettings(0.9 / (slope * delay), delay / 0.3)


@design(
    "ziegler_nichols",
    "PI or PID by Ziegler and Nichols",
    Studied(60, "PI, Ziegler-Nichols"),
    Studied(150, "PID, Ziegler-Nichols", {"actions": "PID"}),
    keys=(
        word("experiment", "the experiment that the settings follow from", Experiment),
        AS_PUBLISHED,
    ),
    method=METHOD,
)
def design_ziegler_nichols(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    experiment: Experiment = "ultimate_point",
    as_published: bool = False,
) -> Controller:
    """Design a PI or PID controller for each pair by the rules of Ziegler and Nichols.

    What their experiments would find is computed from the model, with its dead time and half
    a sampling period of delay. The rules aim at a decay by a quarter from swing to swing,
    which is oscillatory and fragile: unless `as_published`, all loops are slowed down by one
    factor until together they have a sensitivity peak of 2 (`designs.slowing_down`).

    Parameters
    ----------
    experiment : {"ultimate_point", "step_response"}
    as_published : bool
        Keep the settings of the rules.

    Raises
    ------
    NotApplicable
        An element has no ultimate point or no reaction curve, the loops are unstable together,
        or a setting is outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, or the form
        or the experiment is none of these rules.

    References
    ----------
    J. G. Ziegler and N. B. Nichols, Optimum settings for automatic controllers,
    Transactions of the ASME 64(8), 1942, 759-765, doi 10.1115/1.4019264.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("equalisation-tank").analysis
    >>> controller = design_ziegler_nichols(analysis.model, analysis.pairing, as_published=True)
    >>> round(controller.values["level.integral_time"], 6)
    100.0
    """
    rule = _from_ultimate_point if experiment == "ultimate_point" else _from_step_response
    advice = (
        "The rules of Ziegler and Nichols let a swing decay by no more than a quarter: expect "
        "oscillation."
    )
    return PublishedRule(METHOD, SOURCE, rule, advice).designed(model, pairing, form, as_published)


def _from_ultimate_point(
    loop: PairedLoop, delay: float, actions: RuleActions
) -> tuple[PidSettings, str]:
    point = ultimate_point(loop.element, delay)
    return ziegler_nichols_settings(point, actions), ultimate_words(point, loop)


def _from_step_response(
    loop: PairedLoop, delay: float, actions: RuleActions
) -> tuple[PidSettings, str]:
    curve = reaction_curve(loop.element, delay)
    steepest = slope(curve.slope, loop.output, loop.input)
    words = f"steepest {steepest}, delay {time_text(curve.delay)}"
    return ziegler_nichols_step_settings(curve.slope, curve.delay, actions), words
