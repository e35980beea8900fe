"""What the document concludes of its controllers, on the linear model that they are made for."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.settling_bands import BANDS
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop, from_rest
from clepsydra.papers.three_tanks.linear_quadratic import SIZES, quadratic_loop
from clepsydra.papers.three_tanks.pid_design import DERIVATIVE_GAIN, GAIN, INTEGRAL_GAIN, loop_model
from clepsydra.papers.three_tanks.printed_model import AREA, printed_model
from clepsydra.papers.three_tanks.state_feedback import (
    DISTANCES,
    STEP,
    placed_loop,
    settling,
)

#: What the design of the FSFB controller desires: overshoot [%] and settling time [s].
OVERSHOOT, SETTLING = PRINTED.numbers("design of the FSFB controller", "overshoot", "settling time")
#: Flow into tank 3 [m³/s], ours; only ratios of what it does are compared.
LOAD = 1e-5
#: What that adds to the rates of the levels [m/s].
_LOADED = LOAD / AREA * np.eye(3)[2]
#: Of a response.
STEPS = 6000
#: What "at least 0.2 seconds" holds of, narrower than the usual bands.
_CLOSE = 0.01
#: So many of a `Response` are of the setpoint step.
_OF_STEP = 6


class Response(NamedTuple):
    """What a setpoint step of 1 cm and a load do to level 3."""

    overshoot: float  # [%]
    settling: float  # to within 2 % [s]
    settling_widely: float  # to within 5 % [s]
    settling_closely: float  # to within 1 % [s]
    absolute: float  # IAE of the setpoint step [cm s]
    squared: float  # and its ISE [cm² s]
    moved: float  # largest deviation after the load [cm]
    left: float  # what of it is left in the end [cm]


def run() -> Found:
    """Judge the conclusion's claims."""
    placed = {distance: _of_feedback(placed_loop(distance), 3.0) for distance in DISTANCES}
    best, pid = placed[25], _of_pid()
    others = [*(_of_feedback(quadratic_loop(weight), 12.0) for weight in SIZES), pid]
    names = [*(f"LQC, R = {weight}" for weight in SIZES), "PID"]
    servo = all(
        one < other
        for each in others
        for one, other in zip(best[:_OF_STEP], each[:_OF_STEP], strict=True)
    )
    assert servo and best.moved < min(each.moved for each in others) and best.left > pid.left
    yield PRINTED["abstract", "performance"].remark(
        f"FSFB {best.overshoot:.1f} % in {best.settling:.2f} s, {best.moved:.2g} cm, left "
        f"{_left(best)} cm; "
        + "; ".join(
            f"{name} {each.overshoot:.1f} % in {each.settling:.3g} s, {each.moved:.2g} cm, left "
            f"{_left(each)} cm"
            for name, each in zip(names, others, strict=True)
        )
    )
    worst, least = (
        tuple(pick(column) for column in zip(*(each[:_OF_STEP] for each in group), strict=True))
        for pick, group in ((max, placed.values()), (min, others[:-1]))
    )
    yield PRINTED["abstract", "FSFB over LQC"].claimed(
        all(one < other for one, other in zip(worst, least, strict=True)),
        "; ".join(
            f"{name} {overshoot:.1f} %, {settled:.2f} s, IAE {absolute:.2f} cm s, "
            f"ISE {squared:.2f} cm² s"
            for name, (overshoot, settled, _, _, absolute, squared) in (
                ("FSFB", worst),
                ("LQC", least),
            )
        ),
        widely=(worst[2], least[2]),
    )
    yield PRINTED["conclusion", "settling time"].remark(
        f"{best.settling_widely:.3f} s to within 5 %, {best.settling:.3f} s to within 2 %, "
        f"{best.settling_closely:.3f} s to within 1 %"
    )
    yield PRINTED["conclusion", "overshoot"].claimed(
        best.overshoot < pid.overshoot, f"{best.overshoot:.1f} % against {pid.overshoot:.1f} %"
    )
    yield PRINTED["conclusion", "desired specifications"].claimed(
        set(_keeps(best)) == {True}
        and best.settling_closely < 1.05 * SETTLING
        and all(set(_keeps(each)) == {False} for each in others)
        and all(
            abs(one - SETTLING) < abs(other - SETTLING)
            for each in others
            for one, other in zip(best[1:3], each[1:3], strict=True)
        ),
        f"FSFB {best.overshoot:.1f} % in {best.settling:.2f} s; "
        + "; ".join(
            f"{name} {each.overshoot:.1f} % in {each.settling:.3g} s"
            for name, each in zip(names, others, strict=True)
        ),
        closely=best.settling_closely,
        widely=best.settling_widely,
        other=min(each.settling_widely for each in others),
    )
    yield PRINTED["conclusion", "settling time, ISE and IAE"].claimed(
        all(one < other for one, other in zip(best[:_OF_STEP], pid[:_OF_STEP], strict=True)),
        f"{best.settling:.2f} against {pid.settling:.0f} s, ISE {best.squared:.2g} against "
        f"{pid.squared:.0f} cm² s, IAE {best.absolute:.2g} against {pid.absolute:.0f} cm s",
        widely=(best.settling_widely, pid.settling_widely),
    )
    yield PRINTED["conclusion", "disturbance"].remark(
        f"FSFB {', '.join(f'{each.moved:.2g}' for each in placed.values())}; "
        + "; ".join(f"{name} {each.moved:.2g}" for name, each in zip(names, others, strict=True))
    )


def _left(response: Response) -> str:
    """Tell what of a load is left; what an integral still takes away is nothing."""
    return f"{round(response.left, 5):.2g}"


def _keeps(response: Response) -> tuple[bool, ...]:
    """Return whether overshoot and settling time, to within 2 and 5 %, are as desired."""
    return response.overshoot < OVERSHOOT, *(each <= SETTLING for each in response[1:3])


def _of_feedback(loop: FeedbackLoop, end: float) -> Response:
    time = np.linspace(0.0, end, STEPS + 1)
    load = from_rest(loop.closed, _LOADED, time)
    return _response(time, loop.step(STEP, time)[0][:, 2], load)


@cache
def _of_pid() -> Response:
    """Return the response of (2) under the PID by (3), of the setpoint step by (3) alone."""
    loop, time = loop_model(), np.linspace(0.0, 2000.0, 20001)
    states = from_rest(loop.A - loop.B @ loop.C, STEP * loop.B[:, 0], time)
    # Of (2) with u = -Kp h3 - Ki ∫h3 - Kd dh3/dt; the load enters dh3/dt as well.
    model = printed_model()
    feed = -np.append(GAIN * np.eye(3)[2] + DERIVATIVE_GAIN * model.A[2], INTEGRAL_GAIN)
    whole, entry = np.zeros((4, 4)), np.append(model.B[:, 0], 0.0)
    whole[:3, :3], whole[3, 2] = model.A, 1.0
    loaded = np.append(_LOADED, 0.0) - DERIVATIVE_GAIN * LOAD / AREA * entry
    load = from_rest(whole + np.outer(entry, feed), loaded, np.linspace(0.0, 2000.0, STEPS + 1))
    return _response(time, states @ loop.C[0], load)


def _response(time: np.ndarray, level: np.ndarray, load: np.ndarray) -> Response:
    error = 100.0 * np.abs(STEP - level)
    near, wide = BANDS
    return Response(
        100.0 * (float(level.max()) / STEP - 1.0),
        settling(time, level, near),
        settling(time, level, wide),
        settling(time, level, _CLOSE),
        float(np.trapezoid(error, time)),
        float(np.trapezoid(error**2, time)),
        100.0 * float(np.abs(load[:, 2]).max()),
        100.0 * abs(float(load[-1, 2])),
    )
