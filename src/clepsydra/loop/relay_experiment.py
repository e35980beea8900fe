"""The relay experiment: a loop under a relay, simulated on the nonlinear process."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.sample import Sample, written_law
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import told_by
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.models.transfer_element import moving_element
from clepsydra.designs.models.ultimate_point import ultimate_point
from clepsydra.linear.control_authority import control_authority
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.program.step_law import StepLaw

#: The relay takes this share of the way from the operating point to the nearer limit.
SHARE = 0.2
#: How many ultimate periods of the linear model it lasts.
PERIODS = 20.0
_MOST_SAMPLES = 1_000_000


@dataclass(frozen=True, eq=False)
class RelayRecord:
    """What a relay did, and what the process answered.

    Parameters
    ----------
    time : ndarray [n]
        [s]
    manipulated, measured : ndarray [n]
        In the units of the signals.
    amplitude, hysteresis, bias : float
        Of the relay: d and the bias [input unit], ε [output unit].
    """

    time: np.ndarray
    manipulated: np.ndarray
    measured: np.ndarray
    amplitude: float
    hysteresis: float
    bias: float


def relay_law(measured: Signal, manipulated: Signal) -> StepLaw:
    """Write the step law of a relay with hysteresis and bias.

    With e = r − y, the relay goes up where e > ε, down where e < −ε, and stays where it is in
    between; the output is bias ± amplitude, with a negative amplitude for an input that must
    fall when the measurement falls.

    Parameters
    ----------
    measured, manipulated : Signal
        They lend their units and ranges.
    """

    def equations(sample: Sample) -> None:
        setpoint, measurement = sample.of(measured, "sp", "pv")
        bias, amplitude, hysteresis = sample.parameters(
            signals.gain("bias", manipulated.unit, 0.0, "middle of the relay"),
            signals.gain("amplitude", manipulated.unit, 1.0, "half the height of the relay"),
            signals.gain(
                "hysteresis", measured.unit, 0.0, "from the setpoint to a switching level"
            ),
        )
        up = Signal("raised", low=0.0, high=1.0, description="the relay is up")
        (last,) = sample.memory(up)
        error = setpoint - measurement
        kept = ca.if_else(error < -hysteresis, 0, last)
        raised = ca.if_else(error > hysteresis, 1, kept)
        sample.next_state["raised"] = raised
        sample.outputs[path(manipulated, "out")] = bias + amplitude * (2 * raised - 1)
        sample.outputs[path(manipulated, "status")] = ca.SX(STATUS_BITS["automatic"].value)

    inputs = *signals.setpoint_inputs([measured]), signals.measurement_inputs([measured])[0]
    return written_law("relay", equations, inputs, signals.output_results([manipulated]))


@told_by("relay experiment")
def relay_experiment(
    model: LinearModel,
    output: str,
    input_name: str,
    *,
    amplitude: float | None = None,
    hysteresis: float = 0.0,
    duration: float | None = None,
) -> RelayRecord:
    """Run a relay on the nonlinear process, from rest at its operating point.

    The bias is the input at rest, and the other inputs stay. `designs.relay_autotune` reads the
    ultimate point off the record.

    Parameters
    ----------
    model : LinearModel
        Of the process at an operating point; it tells the direction and how long to wait.
    output, input_name : str
        The loop.
    amplitude : float, optional
        d, above zero; a fifth of the way to the nearer limit of the input if left out.
    hysteresis : float
        ε [output unit]
    duration : float, optional
        [s]; twenty ultimate periods of the linear model if left out.

    Raises
    ------
    InputError
        A name is unknown, a number is out of range, or the experiment would take more than a
        million samples.
    NotApplicable
        The input does not move the output, a signal has no range, or the loop never swings.

    References
    ----------
    K. J. Åström and T. Hägglund, Automatica 20(5), 1984, 645-651,
    doi 10.1016/0005-1098(84)90014-1.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.relay_autotune import ultimate_point_of_relay
    >>> from clepsydra.designs.models.transfer_element import transfer_element
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> record = relay_experiment(plant.linear, "level_1", "pump_2")
    >>> found = ultimate_point_of_relay(record)
    >>> element = transfer_element(plant.linear, "level_1", "pump_2")
    >>> exact = ultimate_point(element, 0.5)
    >>> bool(abs(found.period / exact.period - 1.0) < 0.15)
    True
    """
    point = operating_point_of(model)
    process, at = point.process, point.as_dict()
    element = moving_element(model, output, input_name)
    check_ranges(process, [output], [input_name])
    measured, manipulated = process.signal(output), process.signal(input_name)
    bias, period = at[input_name], process.sampling_period
    size = SHARE * control_authority(manipulated, bias) if amplitude is None else amplitude
    _check(size, bias, manipulated, hysteresis)
    length = duration
    if length is None:
        length = PERIODS * ultimate_point(element, period / 2.0).period
    elif not is_finite_number(length) or length < 10.0 * period:
        raise InputError("duration", length, f"at least {10.0 * period:g} s", "give a longer time")
    samples = math.ceil(length / period)
    if samples > _MOST_SAMPLES:
        raise InputError(
            "duration",
            f"{samples} samples",
            f"at most {_MOST_SAMPLES}",
            "shorten it, or lengthen the sampling period",
        )
    controller = Controller(
        name="relay",
        family="relay",
        design="An experiment, not a controller to keep.",
        law=relay_law(measured, manipulated),
        values={
            "bias": bias,
            "amplitude": element.sign * size,
            "hysteresis": float(hysteresis),
        },
        # At rest the error is zero, and the first sample stays up: that is the kick.
        initial_state={"raised": 1.0},
        measurements=(output,),
        setpoints=(output,),
        manipulated=(input_name,),
    )
    run = Loop(controller, model).run(scenario_of_changes(point, (), samples))
    return RelayRecord(
        time=run.time,
        manipulated=run.values[input_name],
        measured=run.values[output],
        amplitude=size,
        hysteresis=float(hysteresis),
        bias=bias,
    )


def _check(size: float, bias: float, manipulated: Signal, hysteresis: float) -> None:
    if not is_finite_number(size) or size <= 0.0:
        raise InputError("amplitude", size, "a number above 0", "give it in the input's unit")
    if bias - size < manipulated.low or bias + size > manipulated.high:
        raise InputError(
            "amplitude",
            f"{bias:.4g} ± {size:.4g} {manipulated.unit}",
            f"values from {manipulated.low:g} to {manipulated.high:g} {manipulated.unit}",
            "reduce the amplitude, or move the operating point away from the limit",
        )
    if not is_finite_number(hysteresis) or hysteresis < 0.0:
        raise InputError(
            "hysteresis", hysteresis, "a number from 0", "give it in the output's unit"
        )
