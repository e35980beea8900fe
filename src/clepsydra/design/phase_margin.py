"""Multiloop PI from a phase margin and a crossover frequency, in closed form."""

from __future__ import annotations

import math

from clepsydra.base.errors import InputError
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.design.applicability import NotApplicable, reasons_about
from clepsydra.design.detuning import SENSITIVITY_LIMIT, Detuned, as_given, detune
from clepsydra.design.multiloop import MultiloopPi, PairedLoop, Pairing, note_on_peak
from clepsydra.design.pi_settings import PiSettings, slowed_down
from clepsydra.design.request import positive_number
from clepsydra.design.transfer_element import TransferElement
from clepsydra.linear.linear_model import LinearModel

METHOD = "phase margin"
#: The lag of the PI at the default crossover is at least this, which makes ω Ti at most 3.
SMALLEST_LAG = math.atan(1.0 / 3.0)
_BISECTIONS = 60
_POINTS_A_DECADE = 50


def pi_for_margin(
    element: TransferElement, delay: float, phase_margin: float, crossover: float
) -> PiSettings:
    """Return the PI that gives an element this phase margin at this crossover.

    The PI must lag by φ = π − φm + arg g(jω) − ωθ at the crossover ω, and make |g C| one there.
    Since arg C = −atan(1/(ω Ti)) and \\|C| = K/cos φ::

        Ti = 1/(ω tan φ),   K = cos φ/|g(jω)|

    Parameters
    ----------
    element : TransferElement
        Stable, or integrating.
    delay : float
        θ [s]
    phase_margin : float
        φm [rad]
    crossover : float
        ω [rad/s]

    Raises
    ------
    NotApplicable
        φ is not between 0° and 90°: no PI has that phase.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 6.

    Examples
    --------
    An integrator 1/s, 45° at 1 rad/s: the PI lags by 45° itself.

    >>> setting = pi_for_margin(TransferElement(1.0, (), (), 1), 0.0, math.pi / 4, 1.0)
    >>> round(setting.gain, 6), round(setting.integral_time, 6)
    (0.707107, 1.0)
    """
    lag = _lag(element, delay, phase_margin, crossover)
    if not 0.0 < lag < math.pi / 2.0:
        needed = "lead by" if lag <= 0.0 else "lag by"
        raise NotApplicable(
            METHOD,
            f"at {crossover:.3g} rad/s the controller would have to {needed} "
            f"{abs(math.degrees(lag)):.0f}° for a margin of {math.degrees(phase_margin):.0f}°, and "
            f"a PI lags by 0° to 90°; choose a {'lower' if lag <= 0.0 else 'higher'} crossover",
        )
    gain = element.sign * math.cos(lag) / element.magnitude(crossover)
    return PiSettings(gain, 1.0 / (crossover * math.tan(lag)))


def default_crossover(
    element: TransferElement, delay: float, phase_margin: float, largest_gain: float
) -> float:
    """Return the highest crossover [rad/s] with ω Ti ≤ 3 and a gain within the input's room.

    Parameters
    ----------
    element : TransferElement
    delay : float
        [s]
    phase_margin : float
        [rad]
    largest_gain : float
        Largest magnitude of the proportional gain, `control_authority.largest_proportional_gain`.

    Raises
    ------
    NotApplicable
        There is no frequency at which a PI gives this margin with ω Ti ≤ 3.

    Examples
    --------
    1/(s + 1)² with a margin of 60°: the PI lags by 18.4° where the element lags by 101.6°.

    >>> element = TransferElement(1.0, (-1.0, -1.0), (), 0)
    >>> crossover = default_crossover(element, 0.0, math.pi / 3, 1e9)
    >>> round(2 * math.degrees(math.atan(crossover)), 1)
    101.6
    """
    rates = [abs(root) for root in (*element.poles, *element.zeros)]
    total = delay + element.dead_time
    rates += [1.0 / total] if total > 0.0 else []
    slowest, fastest = 1e-3 * min(rates, default=1.0), 1e3 * max(rates, default=1.0)
    count = max(2, int(_POINTS_A_DECADE * math.log10(fastest / slowest)))
    grid = [slowest * (fastest / slowest) ** (k / (count - 1)) for k in range(count)]

    def too_fast(omega: float) -> bool:
        lag = _lag(element, delay, phase_margin, omega)
        if lag < SMALLEST_LAG:
            return True
        return lag < math.pi / 2.0 and math.cos(lag) / element.magnitude(omega) > largest_gain

    # The lowest frequency that is too fast: beyond it the phase has run out for good.
    first = next((k for k, omega in enumerate(grid) if too_fast(omega)), None)
    impossible = f"a PI cannot give a margin of {math.degrees(phase_margin):.0f}° with ω Ti ≤ 3"
    if first is None:
        raise NotApplicable(METHOD, "nothing bounds the crossover from above: give one")
    if first == 0:
        raise NotApplicable(METHOD, impossible)
    low, high = grid[first - 1], grid[first]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if too_fast(middle) else (middle, high)
    if _lag(element, delay, phase_margin, low) >= math.pi / 2.0:
        raise NotApplicable(METHOD, impossible)
    return low


def design_phase_margin(
    model: LinearModel,
    pairing: Pairing,
    *,
    phase_margin: float = math.pi / 3.0,
    crossover: float | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design a PI controller for each pair from its phase margin.

    Each loop by itself, taken as continuous with half a sampling period of delay, gets exactly
    this margin. Without a given crossover each takes the highest at which ω Ti ≤ 3 and a
    setpoint step of a tenth of the measurement's range does not saturate the input; then all
    are slowed down by one factor, K/F and F·Ti, until the sampled loops together have a
    sensitivity peak of 2 (`design.detuning`), which changes the margins: the notes give what
    they became. A given crossover is used as it is.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input)
    phase_margin : float
        Of each loop by itself [rad].
    crossover : float, optional
        Of all loops [rad/s].
    anti_windup : {"back_calculation", "conditional_integration"}

    Returns
    -------
    Controller
        Loop i for the i-th pair.

    Raises
    ------
    NotApplicable
        No PI gives this margin, an element is unstable, the loops are unstable together, or
        a setting is outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the
        anti-windup is unknown, or a number is out of range.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> controller = design_phase_margin(analysis.model, analysis.pairing)
    >>> round(controller.values["proportional_gain_1"], 6)
    3.0
    """
    _check(phase_margin, crossover)
    together = MultiloopPi(model, pairing, anti_windup, METHOD)
    delay = together.process.sampling_period / 2.0
    crossovers, settings = [], []
    for loop in together.loops:
        with reasons_about(loop.pair):
            _check_element(loop.element)
            frequency = crossover or default_crossover(
                loop.element, delay, phase_margin, loop.largest_gain
            )
            settings.append(pi_for_margin(loop.element, delay, phase_margin, frequency))
        crossovers.append(frequency)
    if crossover is None:
        found = detune(lambda factor: slowed_down(settings, factor), together.peak, METHOD)
    else:
        choice = f"a crossover of {crossover:g} rad/s"
        found = as_given(settings, together.peak, METHOD, choice)
    return together.controller(
        found,
        f"Phase margin of {math.degrees(phase_margin):.0f}° at "
        + ", ".join(f"{frequency:.3g} rad/s" for frequency in crossovers)
        + (f", slowed down {found.factor:.3g} times" if found.factor > 1.0 else ""),
        _notes(found, together.loops, delay),
    )


def margin_of(element: TransferElement, delay: float, setting: PiSettings) -> tuple[float, float]:
    """Return the crossover [rad/s] and phase margin [rad] of one loop by itself.

    The crossover is where |g C| falls through one; it is unique for an element without
    resonance, whose magnitude falls with frequency.

    Examples
    --------
    >>> integrator = TransferElement(1.0, (), (), 1)
    >>> crossover, margin = margin_of(integrator, 0.0, PiSettings(0.5**0.5, 1.0))
    >>> round(crossover, 6), round(math.degrees(margin), 6)
    (1.0, 45.0)
    """

    def loop_gain(omega: float) -> float:
        controller = abs(setting.gain) * math.hypot(1.0, 1.0 / (omega * setting.integral_time))
        return controller * element.magnitude(omega)

    low, high = 1e-9, 1e-9
    while loop_gain(high) > 1.0 and high < 1e9:
        low, high = high, 2.0 * high
    for _ in range(_BISECTIONS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if loop_gain(middle) > 1.0 else (low, middle)
    lag = math.atan(1.0 / (high * setting.integral_time))
    return high, math.pi + element.phase(high) - high * delay - lag


def _lag(element: TransferElement, delay: float, phase_margin: float, omega: float) -> float:
    return math.pi - phase_margin + element.phase(omega) - omega * delay


def _check(phase_margin: float, crossover: float | None) -> None:
    if not is_finite_number(phase_margin) or not 0.0 < phase_margin < math.pi:
        raise InputError(
            f"{METHOD}, phase_margin", phase_margin, "an angle between 0 and π rad", "use radians"
        )
    if crossover is not None:
        place = f"{METHOD}, crossover"
        positive_number(place, crossover, "a frequency above 0 rad/s", "give it in rad/s")


def _check_element(element: TransferElement) -> None:
    if any(root.real >= 0.0 for root in element.poles):
        raise NotApplicable(METHOD, "the element is unstable without control")
    if element.integrators < 0:
        raise NotApplicable(METHOD, "the input cannot hold the output: its static gain is zero")


def _notes(found: Detuned, loops: list[PairedLoop], delay: float) -> list[str]:
    if found.factor > 1.0:
        margins = [
            margin_of(loop.element, delay, setting)
            for loop, setting in zip(loops, found.settings, strict=True)
        ]
        reached = " and ".join(
            f"{math.degrees(margin):.0f}° at {crossover:.3g} rad/s" for crossover, margin in margins
        )
        return [
            f"The loops were slowed down {found.factor:.3g} times, so that together they keep a "
            f"sensitivity peak of {SENSITIVITY_LIMIT:g}; by itself each now has {reached}."
        ]
    return note_on_peak(found, "choose a lower crossover or a larger margin")
