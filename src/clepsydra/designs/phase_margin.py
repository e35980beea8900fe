"""Multiloop PI and PID from a phase margin and a crossover frequency."""

from __future__ import annotations

import math
from typing import Literal

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.frequency import angle, angular_frequency
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.margin_settings import (
    lag_needed,
    margin_of,
    pi_for_margin,
    pid_for_margin,
)
from clepsydra.designs.loops.multiloop import MultiloopPid
from clepsydra.designs.loops.pairing import PairedLoop, Pairing
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.models.bisection import last_before
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, note_on_peak
from clepsydra.linear.linear_model import LinearModel

METHOD = "phase margin"
#: The lag of the PI at the default crossover is at least this, which makes ω Ti at most 3.
SMALLEST_LAG = math.atan(1.0 / 3.0)
#: The lead of the PID at the default crossover is at most this [rad].
LARGEST_LEAD = math.radians(30.0)
_POINTS_A_DECADE = 50


def default_crossover(
    element: TransferElement,
    delay: float,
    phase_margin: float,
    largest_gain: float,
    actions: Literal["PI", "PID"] = "PI",
) -> float:
    """Return the highest crossover [rad/s] with a gain within the input's room.

    A PI must have ω Ti ≤ 3 there, a PID must not have to lead by more than 30°.

    Parameters
    ----------
    delay : float
        [s]
    phase_margin : float
        [rad]
    largest_gain : float
        Largest magnitude of the proportional gain, `control_authority.largest_proportional_gain`.

    Raises
    ------
    NotApplicable
        There is no such frequency.

    Examples
    --------
    1/(s + 1)² with a margin of 60°: the PI lags by 18.4° where the element lags by 101.6°.

    >>> element = TransferElement(1.0, (-1.0, -1.0), (), 0)
    >>> crossover = default_crossover(element, 0.0, math.pi / 3, 1e9)
    >>> round(2 * math.degrees(math.atan(crossover)), 1)
    101.6
    """
    grid = element.frequencies(delay, 1e3, _POINTS_A_DECADE)
    smallest = SMALLEST_LAG if actions == "PI" else -LARGEST_LEAD
    rule = pi_for_margin if actions == "PI" else pid_for_margin

    def bearable(omega: float) -> bool:
        lag = lag_needed(element, delay, phase_margin, omega)
        if not smallest <= lag < math.pi / 2.0:
            return lag >= smallest
        return abs(rule(element, delay, phase_margin, omega).gain) <= largest_gain

    # The lowest frequency that is too fast: beyond it the phase has run out for good.
    first = next((k for k, omega in enumerate(grid) if not bearable(omega)), None)
    if first is None:
        raise NotApplicable("nothing bounds the crossover from above: give one")
    found = last_before(grid[first - 1], grid[first], bearable) if first else grid[0]
    if first == 0 or lag_needed(element, delay, phase_margin, found) >= math.pi / 2.0:
        within = "ω Ti ≤ 3" if actions == "PI" else f"a lead of {math.degrees(LARGEST_LEAD):.0f}°"
        margin = math.degrees(phase_margin)
        raise NotApplicable(f"a {actions} cannot give a margin of {margin:.0f}° with {within}")
    return found


@design(
    "phase_margin",
    "PI or PID by phase margin",
    Studied(40, "PI, phase margin"),
    Studied(130, "PID, phase margin", {"actions": "PID"}),
    keys=(
        angle("phase_margin", 'the phase margin of each loop, `"60 deg"`'),
        angular_frequency("crossover", "where the loops cross over"),
    ),
    method=METHOD,
)
def design_phase_margin(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    phase_margin: float = math.pi / 3.0,
    crossover: float | None = None,
) -> Controller:
    """Design a PI or PID controller for each pair from its phase margin.

    Each loop by itself, taken as continuous with half a sampling period of delay, gets exactly
    this margin. Without a given crossover each takes the highest at which a PI has ω Ti ≤ 3, or
    a PID has to lead by no more than 30°, and a setpoint step of a tenth of the measurement's
    range does not saturate the input; then all are slowed down by one factor, K/F and F·Ti,
    until the sampled loops together have a sensitivity peak of 2 (`designs.slowing_down`), which
    changes the margins: the notes give what they became. A given crossover is used as it is,
    and where no form is given a loop that a PI cannot lead enough gets a PID.

    Parameters
    ----------
    form : PidForm, optional
        PI in ISA form if left out, and PID where the crossover asks for it.
    phase_margin : float
        Of each loop by itself [rad].
    crossover : float, optional
        Of all loops [rad/s].

    Raises
    ------
    NotApplicable
        No such controller gives this margin, an element is unstable, the loops are unstable
        together, or a setting is outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the form is
        neither PI nor PID, or a number is out of range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> controller = design_phase_margin(analysis.model, analysis.pairing)
    >>> round(controller.values["level_1.proportional_gain"], 6)
    3.0
    """
    together = MultiloopPid(model, pairing, form, METHOD)
    together.each(lambda loop: loop.element.check(math.inf))

    def lag(loop: PairedLoop, frequency: float) -> float:
        return lag_needed(loop.element, together.delay, phase_margin, frequency)

    if form is None and crossover is not None:
        lags = [lag(loop, crossover) for loop in together.loops]
        if min(lags) <= 0.0:
            together = MultiloopPid(model, pairing, PidForm("PID"), METHOD)
    delay, actions = together.delay, together.actions

    def settings_of(loop: PairedLoop) -> tuple[PidSettings, float]:
        element = loop.element
        frequency = crossover or default_crossover(
            element, delay, phase_margin, loop.largest_gain, actions
        )
        leads = actions == "PID" and (lag(loop, frequency) <= 0.0 or form)
        rule = pid_for_margin if leads else pi_for_margin
        return rule(element, delay, phase_margin, frequency), frequency

    settings, crossovers = zip(*together.each(settings_of), strict=True)
    if crossover is None:
        found = together.detuned(settings)
    else:
        found = together.as_given(settings, f"a crossover of {crossover:g} rad/s")
    words = f"Phase margin of {math.degrees(phase_margin):.0f}° at "
    words += ", ".join(f"{frequency:.3g} rad/s" for frequency in crossovers)
    if found.factor == 1.0:
        notes = note_on_peak(found.peak, "choose a lower crossover or a larger margin")
        return together.controller(found, words, notes)
    reached = " and ".join(
        f"{math.degrees(margin):.0f}° at {frequency:.3g} rad/s"
        for frequency, margin in (
            margin_of(loop.element, delay, setting)
            for loop, setting in zip(together.loops, found.design, strict=True)
        )
    )
    note = (
        f"The loops were slowed down {found.factor:.3g} times, so that together they keep a "
        f"sensitivity peak of {SENSITIVITY_LIMIT:g}; by itself each now has {reached}."
    )
    return together.controller(found, f"{words}, slowed down {found.factor:.3g} times", [note])
