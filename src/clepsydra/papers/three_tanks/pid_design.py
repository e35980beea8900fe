"""The two-point model, its ultimate point, the PID settings and their loop: (5) and Fig. 13."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.models.ultimate_point import ultimate_point
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.loop_margins import loop_margins
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, bode_panels
from clepsydra.papers.row import Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import from_rest
from clepsydra.papers.three_tanks.printed_model import DENOMINATOR, NUMERATOR, companion

#: The settings that the document goes on with: K_c [m²/s], K_i [m²/s²], K_d [m²].
GAIN, INTEGRAL_GAIN, DERIVATIVE_GAIN = PRINTED.numbers("Ziegler-Nichols", "Kc", "Ki", "Kd")


def run() -> Found:
    """Return the rows on PID control, and its Bode plot."""
    return (*_two_points(), *_settings(), *_loop(), _bode())


def response(time: float) -> float:
    """Return the unit step response of (3) over its static gain.

    Examples
    --------
    >>> round(response(175.748), 4)
    0.333
    """
    return float(from_rest(companion(), DENOMINATOR[3] * np.eye(3)[2], np.array([time]))[0, 0])


def _two_points() -> Rows:
    from scipy.optimize import brentq

    first, second = (
        float(brentq(lambda t, share=share: response(t) - share, 1.0, 5000.0))
        for share in (0.333, 0.666)
    )
    time_constant = 1.43 * (second - first)
    yield PRINTED["two-point method", "τp"].compared(
        time_constant,
        unprinted=f"From {first:.1f} and {second:.1f} s, at which the response of (3) passes "
        "33.3 and 66.6 %; the times that were read are not printed.",
    )
    yield PRINTED["two-point method", "td"].compared(
        first - 0.4 * time_constant,
        unprinted=f"From {first:.1f} s, at which the response of (3) passes 33.3 %, and τp as "
        "computed; the times that were read are not printed.",
    )
    yield PRINTED["two-point method", "Kp"].compared(NUMERATOR / DENOMINATOR[3])


def _settings() -> Rows:
    gain, lag, delay = PRINTED.numbers("two-point method", "Kp", "τp", "td")
    point = ultimate_point(TransferElement(gain, (-1.0 / lag,), (), 0, delay), 0.0)
    period, frequency = point.period, math.tau / point.period
    integral, derivative = period / 2.0, period / 8.0
    is_frequency = (
        f"0.034 rad/s is the ultimate frequency, {frequency:.4f} rad/s",
        abs(frequency - PRINTED["Ziegler-Nichols", "Pu"].value) < 5e-4,
    )
    gains_need = (
        f"τi = Pu/2 and τd = Pu/8 with the {period:.1f} s that Pu of (5) is, and Ki and Kd "
        "follow from these",
        abs(GAIN / integral - INTEGRAL_GAIN) < 5e-7
        and abs(GAIN * derivative - DERIVATIVE_GAIN) < 5e-4
        and abs(GAIN / PRINTED["Ziegler-Nichols", "τi"].value - INTEGRAL_GAIN) > 1e-2,
    )
    yield PRINTED["Ziegler-Nichols", "Kcu"].compared(point.gain)
    yield PRINTED["Ziegler-Nichols", "Pu"].compared(period, right_if=[is_frequency])
    yield PRINTED["Ziegler-Nichols", "Kc"].compared(
        0.6 * point.gain, why=f"0.6 times the ultimate gain {point.gain:.5f} of (5)."
    )
    yield PRINTED["Ziegler-Nichols", "τi"].compared(integral, right_if=[gains_need])
    yield PRINTED["Ziegler-Nichols", "Ki"].compared(GAIN / integral)
    yield PRINTED["Ziegler-Nichols", "τd"].compared(derivative, right_if=[gains_need])
    yield PRINTED["Ziegler-Nichols", "Kd"].compared(GAIN * derivative)


def loop_model() -> LinearModel:
    """Return the open loop L(s) = G(s) C(s) of (3) and the printed PID settings."""
    from scipy.signal import tf2ss

    numerator = NUMERATOR * np.array([DERIVATIVE_GAIN, GAIN, INTEGRAL_GAIN])
    A, B, C, D = tf2ss(numerator, np.append(DENOMINATOR, 0.0))
    names = tuple(f"x{i}" for i in range(len(A)))
    return LinearModel(A, B, B[:, :0], C, D, names, ("error",), (), ("level_3",))


def _loop() -> Rows:
    numerator = NUMERATOR * np.array([DERIVATIVE_GAIN, GAIN, INTEGRAL_GAIN])
    closed = np.append(DENOMINATOR, 0.0) + np.append(np.zeros(2), numerator)
    place = "closed loop of the PID"
    above = ("numerator s²", "numerator s", "numerator constant")
    below = tuple(f"denominator {power}" for power in ("s³", "s²", "s", "constant"))
    found = dict(zip((*above, *below), map(float, (*numerator, *closed[1:])), strict=True))
    # Half a unit of the last digit of Kc, 0.0012, in the one coefficient that it leaves open.
    left = {"denominator s": 5e-5 * NUMERATOR}
    yield from [
        PRINTED[place, name].compared(value, tolerance=left.get(name, 0.0) / value)
        for name, value in found.items()
    ]
    margins = loop_margins(loop_model())
    phase = math.degrees(margins.phase_margin or 0.0)
    peak = 20.0 * math.log10(margins.sensitivity.peak)
    poles = np.roots([1.0, *(PRINTED[place, name].value for name in below)])
    assert math.isinf(margins.gain_margin_up or 0.0)
    yield PRINTED[place, "internal stability"].claimed(
        bool(poles.real.max() >= 0.0) or not margins.stable,
        f"stable, poles of the printed denominator at most at {poles.real.max():.4f} 1/s",
        reason="Of the loop of (3) and the printed Kc, Ki and Kd. GM is infinite, since the "
        f"phase reaches -180° at no finite frequency, and PM is {phase:.1f}°.",
    )
    yield PRINTED[place, "VGM"].compared(peak)
    yield PRINTED[place, "VGM of the PID"].claimed(peak > 9.5, f"{peak:.2f} dB")


def _bode() -> Figure:
    frequencies = np.logspace(-4.0, 1.0, 400)
    s = 1j * frequencies
    controller = (DERIVATIVE_GAIN * s**2 + GAIN * s + INTEGRAL_GAIN) / s
    loop = controller * NUMERATOR / np.polyval(DENOMINATOR, s)
    shown = {"open loop": loop, "closed loop": loop / (1.0 + loop), "S": 1.0 / (1.0 + loop)}
    return Figure("Fig. 13", "Bode plot with the PID controller", bode_panels(frequencies, shown))
