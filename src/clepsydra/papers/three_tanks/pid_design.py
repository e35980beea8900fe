"""The two-point model, its ultimate point, the PID settings and their loop: (5) and Fig. 13."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.models.ultimate_point import UltimatePoint, ultimate_point
from clepsydra.linear.linear_model import LinearModel
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, bode_panels
from clepsydra.papers.row import Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import from_rest
from clepsydra.papers.three_tanks.printed_model import DENOMINATOR, NUMERATOR, companion

#: The settings that the document goes on with: K_c [m²/s], K_i [m²/s²], K_d [m²].
GAIN, INTEGRAL_GAIN, DERIVATIVE_GAIN = PRINTED.numbers("Ziegler-Nichols", "Kc", "Ki", "Kd")

#: Numerator and denominator of the open loop of (3) under these.
_ABOVE = NUMERATOR * np.array([DERIVATIVE_GAIN, GAIN, INTEGRAL_GAIN])
_BELOW = np.append(DENOMINATOR, 0.0)


def run() -> Found:
    """Return the rows on PID control, and its Bode plot."""
    return (*_two_points(), *_settings(), *_loop(), _bode())


def response(time: float) -> float:
    """Return the unit step response of (3) over its static gain."""
    return float(from_rest(companion(), DENOMINATOR[3] * np.eye(3)[2], np.array([time]))[0, 0])


def _two_points() -> Rows:
    from scipy.optimize import brentq

    place = "two-point method"
    first, second = (
        float(brentq(lambda t, share=share: response(t) - share, 1.0, 5000.0))
        for share in np.array(PRINTED.numbers(place, "first share", "second share")) / 100.0
    )
    factor, late = PRINTED.numbers(place, "factor of τp", "factor of td")
    time_constant = factor * (second - first)
    delay = first - late * time_constant
    # What was read, by the same formulas.
    lag, dead_time = PRINTED.numbers(place, "τp", "td")
    early = dead_time + late * lag
    read = (early, early + lag / factor)
    low, high = (100.0 * response(time) for time in read)
    told: dict[str, Any] = {"first": first, "second": second, "read": read[0], "late": read[1]}
    told |= {"low": low, "high": high}
    yield PRINTED[place, "τp"].compared(time_constant, **told)
    yield PRINTED[place, "td"].compared(delay, **told)
    yield PRINTED[place, "Kp"].compared(NUMERATOR / DENOMINATOR[3])


def _ultimate_point() -> UltimatePoint:
    """Return that of (5) with the numbers as printed."""
    gain, lag, delay = PRINTED.numbers("two-point method", "Kp", "τp", "td")
    return ultimate_point(TransferElement(gain, (-1.0 / lag,), (), 0, delay), 0.0)


def _settings() -> Rows:
    point = _ultimate_point()
    period, frequency = point.period, math.tau / point.period
    of_gain, of_integral, of_derivative = PRINTED.numbers(
        "Ziegler-Nichols", "Kc / Kcu", "Pu / τi", "Pu / τd"
    )
    integral, derivative = period / of_integral, period / of_derivative
    slip, printed_integral, printed_derivative = PRINTED.numbers(
        "Ziegler-Nichols", "Pu", "τi", "τd"
    )
    is_frequency = (
        f"0.034 is the ultimate frequency of (5), {frequency:.4f} rad/s, and not its period",
        abs(frequency - slip) < 5e-4,
    )
    gains_need = (
        f"τi = Pu/2 and τd = Pu/8 with Pu = {period:.1f} s, the period of (5); the printed Ki and "
        "Kd follow from these",
        abs(GAIN / integral - INTEGRAL_GAIN) < 5e-7
        and abs(GAIN * derivative - DERIVATIVE_GAIN) < 5e-4
        and abs(GAIN / printed_integral - INTEGRAL_GAIN) > 1e-2,
    )
    same_slip = (
        "the printed τi and τd are the printed Pu over 2 and 8, so that its slip is theirs",
        math.isclose(slip / of_integral, printed_integral)
        and math.isclose(slip / of_derivative, printed_derivative),
    )
    of_times = [gains_need, same_slip]
    evidence = {"Pu": [is_frequency], "τi": of_times, "τd": of_times}
    found = {
        "Kcu": point.gain,
        "Pu": period,
        "Kc": of_gain * point.gain,
        "τi": integral,
        "Ki": GAIN / integral,
        "τd": derivative,
        "Kd": GAIN * derivative,
    }
    for name, value in found.items():
        line = PRINTED["Ziegler-Nichols", name].told(ultimate=point.gain)
        yield line.compared(value, right_if=evidence.get(name, ()))


def loop_model() -> LinearModel:
    """Return the open loop L(s) = G(s) C(s) of (3) and the printed PID settings."""
    from scipy.signal import tf2ss

    A, B, C, D = tf2ss(_ABOVE, _BELOW)
    names = tuple(f"x{i}" for i in range(len(A)))
    return LinearModel(A, B, B[:, :0], C, D, names, ("error",), (), ("level_3",))


def _loop() -> Rows:
    import control

    place = "closed loop of the PID"
    above = ("numerator s²", "numerator s", "numerator constant")
    below = tuple(f"denominator {power}" for power in ("s³", "s²", "s", "constant"))
    closed = _BELOW + np.append(np.zeros(2), _ABOVE)
    found = dict(zip((*above, *below), map(float, (*_ABOVE, *closed[1:])), strict=True))
    # What the last digit of Kc leaves open in the sum that it enters.
    low, high = (NUMERATOR * (GAIN + end) + DENOMINATOR[3] for end in (-5e-5, 5e-5))
    share = PRINTED["Ziegler-Nichols", "Kc / Kcu"].value
    unrounded = NUMERATOR * share * _ultimate_point().gain + DENOMINATOR[3]
    hangs_on = (
        f"The two digits of Kc leave it open between {low:.2e} and {high:.2e}; with Kc as computed "
        f"from (5), before rounding, it is {unrounded:.2e}."
    )
    for name, value in found.items():
        row = PRINTED[place, name].compared(value)
        yield row.undecided(hangs_on) if name == "denominator s" else row
    margin, phase, nearest, *_ = control.stability_margins(control.tf(_ABOVE, _BELOW))
    peak = -20.0 * math.log10(nearest)
    poles = np.roots([1.0, *(PRINTED[place, name].value for name in below)])
    assert math.isinf(margin)
    yield PRINTED[place, "internal stability"].claimed(
        bool(poles.real.max() >= 0.0) or bool(np.roots(closed).real.max() >= 0.0),
        f"stable, real parts of the poles of the printed denominator up to "
        f"{poles.real.max():.4f} 1/s",
        stable=float(np.roots(closed).real.max()),
        phase=float(phase),
    )
    yield PRINTED[place, "VGM"].compared(peak)
    highest = PRINTED["second equation (6)", "greatest VGM"].value
    yield PRINTED[place, "VGM of the PID"].claimed(peak > highest, f"{peak:.2f} dB")


def _bode() -> Figure:
    frequencies = np.logspace(-4.0, 1.0, 400)
    s = 1j * frequencies
    loop = np.polyval(_ABOVE, s) / np.polyval(_BELOW, s)
    shown = {"open loop": loop, "closed loop": loop / (1.0 + loop), "S": 1.0 / (1.0 + loop)}
    return Figure("Fig. 13", "Bode plot with the PID controller", bode_panels(frequencies, shown))
