"""The scenario of a study that nobody wrote one for, made from the process alone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.designs.loops.averaging_room import longest_arrest
from clepsydra.engine.white_noise import check_seed
from clepsydra.linear.assignment import cheapest_assignment
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.poles import origin_radius, time_constants
from clepsydra.linear.zeros import zeros
from clepsydra.loop.finite_span import finite_span
from clepsydra.loop.moves_at_rest import moves_at_rest
from clepsydra.loop.residence_times import residence_times, width_of_range
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.loop.with_noise import with_noise
from clepsydra.process.averaging import check_at_rest
from clepsydra.process.process import Process
from clepsydra.scores.segment import SegmentKind

#: Wanted setpoint step, and the smallest that still shows something; shares of the range.
STEP_SHARE = 0.10
SMALLEST_STEP_SHARE = 0.01
#: A proportional controller that leaves a sixth of a step moves the inputs, when it comes, by so
#: many times what holds it at rest.
KICK = 5.0
#: Inputs and outputs rest at least this share of their range away from its ends.
MARGIN = 0.05
#: No level rests nearer to floor, rim or an end of its band than this share of its distance at the
#: start.
LEVEL_SHARE = 0.5
#: Length of a segment in times of the slowest thing that happens in it.
SLOWEST_TIMES = 6.0
#: Rest before the first step, share of a segment.
REST_SHARE = 0.1
#: A loop is slower than this many sampling periods.
LOOP_PERIODS = 10.0
#: And slower than this many dead times.
DEAD_TIMES = 4.0
#: And than this many arrest times of a level that uses its band, which may swing back.
ARREST_TIMES = 2.0
#: Where the range of an input would move an output this many times its range, the process alone
#: is as good as integrating: the output meets its ends long before it comes to rest.
INTEGRATING_GAIN = 5.0
PRETTY = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
MOST_SAMPLES = 1_000_000


def default_scenario(model: LinearModel, seed: int = 1) -> Scenario:
    """Return setpoint steps, load steps and a stretch of noise, one thing a segment.

    *Order.* A short rest; for each controlled measurement a setpoint step away from the
    operating point and one back; for each inflow its load steps, each of which then stays,
    so that each segment holds one change only; measurement noise without steps.

    *Setpoint step.* 10 % of the measurement's range, upward where there is room, else
    downward. It is reduced until, at rest after it by the linear model (all other controlled
    measurements unchanged), all inputs and the stepped measurement lie in the middle 90 % of
    their ranges, no level has gone more than half its way to floor or rim, and no averaging
    level more than half its way to an end of its band, or 2 % in one as narrow, and until a
    proportional controller that leaves a sixth of the step keeps all inputs there at the step
    and at the step back; but for the latter never below 1 %. Then it is rounded down to one digit.

    *Load step.* The sizes that the process gives for the inflow, one after the other.

    *Length.* Each segment lasts six times the slowest of: the model's time constants; 2/z for
    each zero z in the right half-plane, since no loop is faster; the mean residence time from the
    strongest input to each output, which counts tanks in series; for a level that integrates,
    the time in which the full range of the inputs moves its full range; twice the arrest time
    with which a level just stays in its band; ten sampling periods.
    An output whose full range is less than a fifth of what its strongest input moves it by is
    as good as integrating: the times then are those with it held by 1 % of that input for 1 %.
    It is rounded up to a pretty number.

    *Noise.* White, normal, by `white_noise` from the seed that the scenario records, the name of
    the signal and the place of the sample. Its standard deviation is what the process gives for a
    measurement, or 0.5 % of the measurement's range; in the same stretch, those disturbances are
    noisy for which the process gives it.

    Parameters
    ----------
    model : LinearModel
        Of a process at the operating point where the scenario begins, with at least the
        controlled measurements as outputs.
    seed : int
        Of the noise, not negative.

    Raises
    ------
    InputError
        The model has no operating point, a measurement has no finite range, a setpoint step
        has no room or cannot be held by the inputs, a level rests outside of its band, one
        that averages meets no load step, the scenario would take more than a million samples,
        or the seed is no whole number from 0.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd edition, Wiley,
    2005, chapter 5, for the bound on the bandwidth by a zero.

    Examples
    --------
    The quadruple tank steps by 1 V, a tenth of its sensors' 10 V, in segments of 600 s:

    >>> import clepsydra as cl
    >>> scenario = default_scenario(cl.load("quadruple-tank").linear)
    >>> scenario.segments[0]
    Segment(kind='setpoint', signal='level_1', start=60.0, stop=660.0, size=1.0)
    """
    check_seed(seed)
    point = operating_point_of(model)
    process = point.process
    check_at_rest(process, point.as_dict())
    controlled = at_rest(model.select(outputs=process.controlled))
    period = process.sampling_period
    loads = [
        (column, signal.name, size)
        for column, signal in enumerate(process.disturbances)
        for element in process.elements
        for size in element.load_steps().get(signal.name, ())
    ]
    if process.averaging and not loads:
        raise InputError(
            f"{process.address}, averaging",
            f"{', '.join(process.averaging)}, and no load step",
            "at least one, since an averaging level is judged by what loads do to the outflow",
            'give what flows in a step, as under [flows.feed]: step = "10 m^3/h"',
        )
    rest, each = segment_samples(model)
    samples = rest + (2 * len(process.controlled) + len(loads) + 1) * each
    if samples > MOST_SAMPLES:
        raise InputError(
            f"{process.name}, sampling_period",
            f"{period:g} s",
            f"at least {period * samples / MOST_SAMPLES:.2g} s for segments of {each * period:g} s",
            "lengthen the sampling period",
        )

    start = np.array([point.as_dict()[name] for name in process.controlled])
    setpoints = np.tile(start, (samples, 1))
    disturbances = np.tile(np.asarray(point.disturbances, float), (samples, 1))
    noise = np.zeros((samples, len(process.measurements)))
    segments: list[Segment] = []
    begin = rest

    def add_segment(kind: SegmentKind, signal: str, size: float) -> slice:
        nonlocal begin
        stretch = slice(begin, begin + each)
        begin = stretch.stop
        segments.append(Segment(kind, signal, stretch.start * period, stretch.stop * period, size))
        return stretch

    for column, name in enumerate(process.controlled):
        size = _setpoint_step(process, point, controlled, column)
        setpoints[add_segment("setpoint", name, size), column] += size
        add_segment("setpoint", name, -size)
    for column, name, size in loads:
        disturbances[add_segment("load", name, size).start :, column] += size
    quiet = add_segment("noise", "", 0.0)
    scenario = Scenario(period, setpoints, disturbances, noise, tuple(segments), seed)
    return with_noise(scenario, process, quiet.start)


def segment_samples(model: LinearModel) -> tuple[int, int]:
    """Return how many samples the default scenario rests at first, and how many a segment has.

    Parameters
    ----------
    model : LinearModel
        As for `default_scenario`, which says how the length is chosen.

    Examples
    --------
    >>> import clepsydra as cl
    >>> segment_samples(cl.load("quadruple-tank").linear)
    (60, 600)
    """
    process = operating_point_of(model).process
    late = float(model.times.sum())
    controlled = at_rest(model.select(outputs=process.controlled))
    slowest = max(
        _slowest(process, controlled),
        DEAD_TIMES * late,
        ARREST_TIMES * longest_arrest(model),
    )
    length = _pretty_above(SLOWEST_TIMES * slowest)
    each = math.ceil(length / process.sampling_period * (1.0 - 1e-12))
    return math.ceil(REST_SHARE * each), each


def _setpoint_step(
    process: Process, point: OperatingPoint, model: LinearModel, column: int
) -> float:
    """Return the signed size of the setpoint step of one controlled measurement."""
    name = model.outputs[column]
    output = process.signal(name)
    span = finite_span(process, output)
    values, smallest = point.as_dict(), SMALLEST_STEP_SHARE * span
    wanted = np.zeros(len(model.states) + len(model.outputs))
    wanted[len(model.states) + column] = 1.0
    moves = moves_at_rest(model, wanted)
    if moves is None:
        raise InputError(
            f"{process.name}, setpoint step of {name}",
            f"inputs {', '.join(model.inputs)}",
            f"inputs that can hold a new value of {name} with the other outputs unchanged",
            "control fewer measurements",
        )
    rooms = [_room(values[name], *_inner(output), 1.0)]
    if name in process.bands:
        value, ends = values[name], process.bands[name]
        near, far = _room(value, *_near(value, *ends), 1.0), _room(value, *ends, 1.0)
        up, down = (max(near[way], min(2.0 * smallest, far[way])) for way in (0, 1))
        rooms.append((up, down))
    for state in model.states:
        signal, value = process.signal(state), values[state]
        rooms.append(_room(value, *_near(value, signal.low, signal.high), moves[state]))
    kicks: list[tuple[float, float]] = []
    for actuator in model.inputs:
        value, (low, high) = values[actuator], _inner(process.signal(actuator))
        move = moves[actuator]
        rooms.append(_room(value, low, high, move))
        kicks.append(_room(value, low, high, KICK * move))
        if low <= value <= high:  # one that rests shut may be asked to shut
            kicks.append(_room(value, low, high, (1.0 - KICK) * move))
    up, down = (
        min(*(room[way] for room in rooms), max(smallest, min(kick[way] for kick in kicks)))
        for way in (0, 1)
    )
    largest = STEP_SHARE * span
    upward = up >= min(largest, down)
    size = _one_digit_below(min(largest, up if upward else down))
    if size < smallest:
        raise InputError(
            f"{process.name}, setpoint step of {name}",
            f"room for {100.0 * max(up, down) / span:.2g} % of its range",
            f"room for at least {100.0 * SMALLEST_STEP_SHARE:g} %",
            "move the operating point away from the limits",
        )
    return size if upward else -size


def _slowest(process: Process, model: LinearModel) -> float:
    """Return the slowest thing that a loop around the model has to wait for [s]."""
    model = _held(process, model)
    constants = np.abs(time_constants(model))
    times = [LOOP_PERIODS * process.sampling_period, *constants[np.isfinite(constants)]]
    origin = origin_radius(model.A)
    times += [2.0 / zero.real for zero in zeros(model) if zero.real > origin]
    if np.all(np.isfinite(constants)):
        times += list(residence_times(model))
    else:
        # s G(s) near the origin: the rate of each output for a constant input.
        s = 1e-6 / max(times)
        states = np.eye(len(model.states))
        rates = np.abs(s * model.C @ np.linalg.solve(s * states - model.A, model.B))
        fastest = rates @ [width_of_range(process.signal(name)) for name in model.inputs]
        spans = np.array([finite_span(process, process.signal(name)) for name in model.outputs])
        integrating = fastest * max(times) > 1e-3 * spans
        times += list(spans[integrating] / fastest[integrating])
    return float(max(times))


def _held(process: Process, model: LinearModel) -> LinearModel:
    """Return a model whose outputs that are as good as integrating are held by their inputs.

    What integrates entirely stays as it is. Each input holds one output at most, paired so that
    the product of the gains is the largest, by its whole range for the range of the output: a
    tank that integrates then has the time constant in which the range of the input fills it.
    """
    if not np.all(np.isfinite(time_constants(model))):
        return model
    widths = np.array([width_of_range(process.signal(name)) for name in model.inputs])
    spans = np.array([finite_span(process, process.signal(name)) for name in model.outputs])
    # [%/%]
    gains = (model.D - model.C @ np.linalg.solve(model.A, model.B)) * widths / spans[:, None]
    gain = np.zeros((len(widths), len(spans)))
    strength = np.log(np.maximum(np.abs(gains), np.finfo(float).tiny))
    for row, column in cheapest_assignment(-strength):
        if abs(gains[row, column]) > INTEGRATING_GAIN:
            gain[column, row] = math.copysign(widths[column] / spans[row], gains[row, column])
    return replace(model, A=model.A - model.B @ gain @ model.C) if gain.any() else model


def _room(value: float, low: float, high: float, move: float) -> tuple[float, float]:
    """Return how far a setpoint may go up and down until a signal meets its limits."""
    above, below = max(0.0, high - value), max(0.0, value - low)
    if move == 0.0:
        return math.inf, math.inf
    return (above / move, below / move) if move > 0.0 else (below / -move, above / -move)


def _inner(signal: Signal) -> tuple[float, float]:
    """Return the ends of the middle 90 % of a range."""
    return signal.low + MARGIN * signal.span, signal.high - MARGIN * signal.span


def _near(value: float, low: float, high: float) -> tuple[float, float]:
    """Return the ends of what is nearer to a value than to the limits."""
    return value - LEVEL_SHARE * (value - low), value + LEVEL_SHARE * (high - value)


def _one_digit_below(value: float) -> float:
    """Round down to one significant digit."""
    if value <= 0.0:
        return 0.0
    unit = 10.0 ** math.floor(math.log10(value))
    return float(f"{math.floor(value / unit * (1.0 + 1e-9)) * unit:.0e}")


def _pretty_above(value: float) -> float:
    """Round up to the next pretty number."""
    unit = 10.0 ** math.floor(math.log10(value))
    return next(pretty * unit for pretty in PRETTY if pretty * unit >= value * (1.0 - 1e-9))
