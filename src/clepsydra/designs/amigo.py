"""AMIGO, the approximate M-constrained integral gain optimisation of Åström and Hägglund."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.published_rule import AS_PUBLISHED, PublishedRule, RuleActions
from clepsydra.designs.loops.words import model_words
from clepsydra.designs.models.delayed_lags import DelayedLags
from clepsydra.designs.models.reaction_curve import reaction_curve

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.designs.loops.pairing import PairedLoop, Pairing
    from clepsydra.linear.linear_model import LinearModel

METHOD = "AMIGO"
SOURCE = "Åström and Hägglund 2006"


def amigo_settings(model: DelayedLags, actions: RuleActions = "PI") -> PidSettings:
    """Return the AMIGO settings for a first-order or integrating model with delay.

    With gain k, time constant T, delay L and, integrating, slope k'::

        PI    K = 0.15/k + (0.35 − L T/(L + T)²) T/(k L)
              Ti = 0.35 L + 13 L T²/(T² + 12 L T + 7 L²)
              integrating K = 0.35/(k' L), Ti = 13.4 L
        PID   K = (0.2 + 0.45 T/L)/k,  Ti = (0.4 L + 0.8 T)/(L + 0.1 T) L
              Td = 0.5 L T/(0.3 L + T)
              integrating K = 0.45/(k' L), Ti = 8 L, Td = 0.5 L

    Parameters
    ----------
    model : DelayedLags
        With a delay above zero.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 7, eq. (7.5), (7.7) and
    (7.8); Revisiting the Ziegler-Nichols step response method for PID control, Journal of
    Process Control 14(6), 2004, 635-650, doi 10.1016/j.jprocont.2004.01.002.

    Examples
    --------
    The lags 1/(s + 1)⁴ with k = 1, T = 2.90 s and L = 1.42 s:

    >>> found = amigo_settings(DelayedLags(1 / 2.90, 2.90, 1.42), "PID")
    >>> [round(value, 2) for value in found]
    [1.12, 2.4, 0.62]
    """
    T, L = model.time_constant, model.delay
    if math.isinf(T):
        if actions == "PID":
            return PidSettings(0.45 / (model.slope * L), 8.0 * L, 0.5 * L)
        return PidSettings(0.35 / (model.slope * L), 13.4 * L)
    if actions == "PID":
        return PidSettings(
            (0.2 + 0.45 * T / L) / model.gain,
            (0.4 * L + 0.8 * T) / (L + 0.1 * T) * L,
            0.5 * L * T / (0.3 * L + T),
        )
    return PidSettings(
        (0.15 + (0.35 - L * T / (L + T) ** 2) * T / L) / model.gain,
        0.35 * L + 13.0 * L * T**2 / (T**2 + 12.0 * L * T + 7.0 * L**2),
    )


@design(
    "amigo",
    "PI or PID by AMIGO",
    Studied(50, "PI, AMIGO"),
    Studied(140, "PID, AMIGO", {"actions": "PID"}),
    keys=(AS_PUBLISHED,),
    method=METHOD,
)
def design_amigo(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    as_published: bool = False,
) -> Controller:
    """Design a PI or PID controller for each pair by AMIGO.

    The first-order model comes from the exact step response, as the authors take it: L where
    the steepest tangent leaves the start, T the time from there to 63 %; half a sampling
    period counts as delay. Unless `as_published`, all loops are slowed down by one factor
    until together they have a sensitivity peak of 2 (`designs.slowing_down`). The rules
    themselves aim at a peak of 1.4 of each loop alone.

    Parameters
    ----------
    as_published : bool
        Keep the settings of the rules.

    Raises
    ------
    NotApplicable
        An element has no reaction curve, the loops are unstable together, or a setting is
        outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, or the form
        is none of these rules.

    References
    ----------
    As for `amigo_settings`.

    Examples
    --------
    A level that integrates, with half a sampling period of 30 s of delay: Ti = 13.4 · 30 s.

    >>> import clepsydra as cl
    >>> analysis = cl.load("equalisation-tank").analysis
    >>> controller = design_amigo(analysis.model, analysis.pairing, as_published=True)
    >>> round(controller.values["level.integral_time"], 6)
    402.0
    """
    return PublishedRule(METHOD, SOURCE, _rule).designed(model, pairing, form, as_published)


def _rule(loop: PairedLoop, delay: float, actions: RuleActions) -> tuple[PidSettings, str]:
    model = reaction_curve(loop.element, delay).model
    return amigo_settings(model, actions), model_words(model, loop)
