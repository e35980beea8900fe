"""State feedback with a precompensator by placed poles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.frequency import angular_frequency
from clepsydra.designs.arguments.numbers import poles
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.design import Studied, design
from clepsydra.designs.kalman import process_noise
from clepsydra.designs.loops.control_authority import check_ranges, control_authorities
from clepsydra.designs.models.bisection import last_before
from clepsydra.designs.slowing_down import note_on_peak, note_on_slowing, slow_down, unslowed
from clepsydra.designs.states.estimation import Estimation, input_noise, with_loads
from clepsydra.designs.states.feedback_controller import (
    feedback_controller,
    precompensator,
    states_to_feed_back,
)
from clepsydra.designs.states.linear_quadratic import (
    check_independent,
    refuse_feedthrough,
    slowest_time_constant,
)
from clepsydra.designs.states.observed_process import ObservedProcess
from clepsydra.designs.states.placement import (
    checked_poles,
    correction,
    placed_gain,
    slow_modes_gain,
)
from clepsydra.designs.states.state_controllers import sensitivity_peak
from clepsydra.linear.control_authority import DESIGN_STEP
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

NAME = "State feedback, pole placement"
#: The observer is at most this much faster than the regulator.
OBSERVER_RATIO = 4.0
#: However noisy the sensors are, it is not slower than this.
SLOWEST_RATIO = 0.25
#: The noise of the sensors may move an input by this share of its range (standard deviation).
INPUT_NOISE = 0.02
#: At least so many samples in the time of the fastest pole, 1/ω.
_SAMPLES = 2.0
_HALVINGS = 51
#: The bandwidth is found to this share.
_ACCURACY = 1e-3


class PolePattern(NamedTuple):
    """What was asked of a placement: poles or a bandwidth [rad/s], of regulator and observer."""

    poles: Sequence[complex] | None
    observer_poles: Sequence[complex] | None
    bandwidth: float
    ratio: float


@design(
    "pole_placement",
    "state feedback by pole placement",
    Studied(290, "State feedback, pole placement"),
    keys=(
        poles(
            "poles", 'list of poles z = e^(sT) of the sampled loop, complex ones as `"0.9+0.1j"`'
        ),
        angular_frequency("bandwidth", "of Bessel poles that take the place of a list"),
        poles("observer_poles", "list of poles of the observer, as `poles`"),
        MEASUREMENTS,
    ),
)
def design_pole_placement(
    model: LinearModel,
    *,
    poles: Sequence[complex] | None = None,
    bandwidth: float | None = None,
    observer_poles: Sequence[complex] | None = None,
    measurements: Sequence[str] | None = None,
) -> Controller:
    """Design state feedback with a precompensator by placing the poles of the sampled loop.

    u = u° − F x + N (r − r°). By default the poles have Bessel's pattern
    (`designs.states.bessel_filter`) with the largest bandwidth at which a setpoint step of a tenth
    of a measurement's range does not saturate an input, and at which a sample is at most half of
    the pattern's time 1/ω.

    Where sensors show every state they are fed back as measured. Else a Luenberger observer
    estimates the states and a constant load at each input, which is taken off the input. Its
    poles have Bessel's pattern too, four times as fast, or slower where the noise of the
    sensors would move an input by more than 2 % of its range. Where the sensitivity peak of
    the sampled loop is above 2, regulator and observer are slowed down by one factor until it is
    2. Poles and a bandwidth that are given are used as they are.

    Parameters
    ----------
    poles : sequence of complex, optional
        Of the regulator, z = e^(sT), one for each state that acts on the outputs.
    bandwidth : float, optional
        Of Bessel's pattern [rad/s].
    observer_poles : sequence of complex, optional
        One for each state and each input.
    measurements : sequence of str, optional
        What an observer reads; naming them asks for the observer. See
        `designs.states.observed_process.observed_process`.

    Raises
    ------
    NotApplicable
        The process has dead time, a mode is out of reach or not shown, the outputs cannot be
        held independently, the loop is unstable, or no slowing down makes it robust.
    InputError
        The model has no operating point, a signal is unknown, poles are of a wrong number,
        outside of the unit circle or without their conjugates, the bandwidth is not above zero
        or given beside poles, or observer poles are given where nothing is estimated.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 4.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> controller = design_pole_placement(model, poles=[0.97, 0.95, 0.93])
    >>> round(1e4 * controller.values["feed.feedback.level_1"], 3)  # [cm²/s]
    2.779
    """
    point = operating_point_of(model)
    refuse_feedthrough(model)
    if model.delays is not None:
        raise NotApplicable(
            "the process has dead time, and the poles of what is on its way cannot be chosen; "
            "LQI with a Kalman filter takes dead time"
        )
    check_ranges(point.process, model.outputs, model.inputs)
    check_independent(model)
    observed, measured = states_to_feed_back(model, measurements)
    _check_request(poles, bandwidth, observer_poles, observed, measured)
    moves = control_authorities(point, model.inputs)
    request = PolePattern(poles, observer_poles, bandwidth or 0.0, OBSERVER_RATIO)
    is_open = poles is None and bandwidth is None
    if is_open:
        request = request._replace(bandwidth=_largest_bandwidth(observed, moves))
    if not measured and observer_poles is None:
        request = _quiet(request, observed, moves)

    def designed(factor: float) -> tuple[Controller, np.ndarray, Estimation | None]:
        asked = request._replace(bandwidth=request.bandwidth / factor)
        feedback, regulator_poles = _feedback(observed, asked, moves)
        estimation = None if measured else _observer(observed, asked, regulator_poles)
        fading = slowest_time_constant(regulator_poles, observed.period)
        controller = feedback_controller(NAME, observed, feedback, moves, fading, estimation)
        return controller, regulator_poles, estimation

    def peak(design: tuple[Controller, np.ndarray, Estimation | None]) -> float:
        return sensitivity_peak(design[0], model)

    found = slow_down(designed, peak) if is_open else unslowed(designed(1.0), peak)
    if math.isinf(found.peak):
        raise NotApplicable("the sampled loop is unstable with these poles")
    controller, regulator_poles, estimation = found.design
    reached = request.bandwidth / found.factor
    words = "Pole placement, " + (
        f"Bessel's pattern with a bandwidth of {reached:.3g} rad/s"
        if poles is None
        else "given poles"
    )
    what = "the regulator"
    if estimation is not None:
        what = "the regulator with its observer"
        words += f"; Luenberger observer for {estimation.names}"
        words += "" if observer_poles is not None else f", {request.ratio:.3g} times as fast"
    slowest = time_text(slowest_time_constant(regulator_poles, observed.period))
    return controller.described(
        f"{words}; slowest closed-loop time constant {slowest}, sensitivity peak {found.peak:.2f}.",
        (*note_on_slowing(found, what), *note_on_peak(found.peak, "choose slower poles")),
        found.factor,
    )


def _check_request(
    poles: Sequence[complex] | None,
    bandwidth: float | None,
    observer_poles: Sequence[complex] | None,
    observed: ObservedProcess,
    measured: bool,
) -> None:
    n, m = observed.moved.shape
    if bandwidth is not None and poles is not None:
        raise InputError("bandwidth", bandwidth, "poles or a bandwidth", "give one of the two")
    if poles is not None:
        checked_poles(poles, n, "poles")
    if observer_poles is not None and measured:
        expected = "none, since sensors show every state"
        remedy = "leave them out, or name the measurements of an observer"
        raise InputError("observer_poles", list(observer_poles), expected, remedy)
    if observer_poles is not None:
        checked_poles(observer_poles, n + m, "observer_poles")


def _feedback(
    observed: ObservedProcess, asked: PolePattern, moves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return F and the poles of the regulator."""
    held, moved, scales = observed.held, observed.moved, (observed.sizes, moves, observed.period)
    if asked.poles is None:
        feedback = slow_modes_gain(held, moved, asked.bandwidth, *scales)
    else:
        feedback = placed_gain(held, moved, asked.poles, *scales)
    return feedback, np.linalg.eigvals(held - moved @ feedback)


def _observer(
    observed: ObservedProcess, asked: PolePattern, regulator_poles: np.ndarray
) -> Estimation:
    """Return the observer of the states and of a load at each input."""
    whole, period = with_loads(observed), observed.period
    signal = operating_point_of(observed.model).process.signal
    spans = np.array([signal(name).span for name in observed.measurements])
    scales = whole.sizes, spans, period
    if asked.observer_poles is None:
        bandwidth = asked.bandwidth or 1.0 / slowest_time_constant(regulator_poles, period)
        rate = asked.ratio * bandwidth
        found = correction(slow_modes_gain, whole.held, whole.shown, rate, *scales)
    else:
        placing = partial(placed_gain, place="observer_poles")
        found = correction(placing, whole.held, whole.shown, asked.observer_poles, *scales)
    return Estimation.of(whole, found)


def _largest_bandwidth(observed: ObservedProcess, moves: np.ndarray) -> float:
    """Return the bandwidth at which a design step just does not saturate an input [rad/s]."""
    process = operating_point_of(observed.model).process
    steps = DESIGN_STEP * np.array([process.signal(name).span for name in observed.model.outputs])
    rows = observed.controlled

    def bearable(bandwidth: float) -> bool:
        feedback, _ = _feedback(observed, PolePattern(None, None, bandwidth, OBSERVER_RATIO), moves)
        ahead = precompensator(observed.held, observed.moved, observed.shown[rows], feedback, moves)
        return float(np.max(np.abs(ahead) * steps / moves[:, None])) <= 1.0

    high = low = 1.0 / (_SAMPLES * observed.period)
    for _ in range(_HALVINGS):
        if bearable(low):
            return last_before(low, high, bearable, _ACCURACY)
        low /= 2.0
    raise NotApplicable("a setpoint step saturates an input however slow the loop is")


def _quiet(request: PolePattern, observed: ObservedProcess, moves: np.ndarray) -> PolePattern:
    """Return the request with an observer so slow that noise hardly moves the inputs."""
    model = observed.model
    process = operating_point_of(model).process
    spans = np.array([process.signal(name).span for name in model.inputs])
    noise = process_noise(observed, 1.0).measurement
    feedback, poles = _feedback(observed, request, moves)
    whole = np.hstack([feedback, np.eye(len(feedback))])
    while request.ratio > SLOWEST_RATIO:
        estimation = _observer(observed, request, poles)
        if np.all(input_noise(estimation, whole, noise) <= INPUT_NOISE * spans):
            break
        request = request._replace(ratio=request.ratio / 2.0**0.25)
    return request
