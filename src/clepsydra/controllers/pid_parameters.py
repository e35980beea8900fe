"""The parameters of one PID loop, named and with their units."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.pid_form import PidForm

#: The smallest and the largest ratio of derivative to filter time.
_FILTER = (1.0, 1000.0)
#: The gains of a loop, with the time that their unit has beside those of the signals.
GAINS = {"proportional_gain": "", "integral_gain": "/s", "derivative_gain": " s"}


def pid_parameters(form: PidForm, measurement: Signal, moved: Signal) -> list[Signal]:
    """Return the parameters of a loop.

    Parameters
    ----------
    form : PidForm
    measurement, moved : Signal
        What the loop measures, and what it moves: an output or another loop's setpoint.

    Returns
    -------
    list of Signal
        proportional_gain; integral_time, derivative_time [s] and derivative_filter [1], or in
        the parallel form integral_gain, derivative_gain and filter_time [s]; setpoint_weight
        [1], or gap and gap_gain [1], or squared_error_scale; setpoint_ramp and tracking_time
        [s]: each where the form has it.

    Examples
    --------
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> [p.name for p in pid_parameters(PidForm(anti_windup="none"), level, pump)]
    ['proportional_gain', 'integral_time', 'setpoint_weight']
    """
    way = f"from {measurement.name} to {moved.name}"
    ratio = signals.per(moved, measurement)
    found = [signals.gain("proportional_gain", ratio, 1.0, f"proportional gain {way}")]
    if form.algorithm == "parallel":
        found += _parallel(form, measurement, moved, way)
    else:
        found += _times(form)
    found += _shape(form, measurement)
    if form.setpoint_ramp:
        words = f"largest rate of change of the setpoint of {measurement.name}"
        found.append(signals.largest_rate("setpoint_ramp", measurement, words))
    if form.tracks_back:
        found.append(signals.TRACKING_TIME)
    return found


def remembered(form: PidForm) -> list[str]:
    """Return the parameters whose last value counts where they change, so that nothing jumps.

    The velocity form has no integral that takes a change up: there it is the filter's alone.

    Examples
    --------
    >>> remembered(PidForm("PI"))
    ['proportional_gain', 'setpoint_weight']
    """
    of_derivative = ["derivative_time", "derivative_filter"] if form.has_derivative else []
    if form.algorithm == "velocity":
        return of_derivative
    if form.has_derivative and form.algorithm == "parallel":
        of_derivative = ["derivative_gain", "filter_time"]
    shape = {
        "linear": ["setpoint_weight"],
        "gap": ["gap", "gap_gain"],
        "squared": ["squared_error_scale"],
    }[form.error]
    return ["proportional_gain", *of_derivative, *shape]


def _times(form: PidForm) -> list[Signal]:
    found = []
    if form.has_integral:
        found.append(signals.duration("integral_time", "integral time"))
    if form.has_derivative:
        found += [
            Signal(
                "derivative_time",
                "s",
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=0.0,
                description="derivative time",
            ),
            Signal(
                "derivative_filter",
                low=_FILTER[0],
                high=_FILTER[1],
                initial=10.0,
                description="derivative time over the time constant of its filter",
            ),
        ]
    return found


def _parallel(form: PidForm, measurement: Signal, moved: Signal, way: str) -> list[Signal]:
    found = []
    if form.has_integral:
        unit = signals.per(moved, measurement, "s")
        found.append(signals.gain("integral_gain", unit, 0.0, f"integral gain {way}"))
    if form.has_derivative:
        ratio = signals.per(moved, measurement)
        seconds = ("s" if unit == "1" else f"s {unit}" for unit in (ratio.unit, ratio.shown_unit))
        found += [
            signals.gain(
                "derivative_gain", signals.of_units(*seconds), 0.0, f"derivative gain {way}"
            ),
            signals.duration("filter_time", "time constant of the derivative's filter"),
        ]
    return found


def _shape(form: PidForm, measurement: Signal) -> list[Signal]:
    if form.error == "gap":
        return [
            Signal(
                "gap",
                measurement.unit,
                measurement.display_unit,
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                description=f"half the width of the gap around the setpoint of {measurement.name}",
            ),
            Signal(
                "gap_gain",
                low=0.0,
                high=1.0,
                initial=0.1,
                description="share of the error that acts within the gap",
            ),
        ]
    if form.error == "squared":
        return [
            Signal(
                "squared_error_scale",
                measurement.unit,
                measurement.display_unit,
                low=signals.SHORTEST_TIME,
                high=signals.LARGEST_PARAMETER,
                initial=1.0,
                description=f"error of {measurement.name} at which the gain is the nominal one",
            )
        ]
    return [
        Signal(
            "setpoint_weight",
            low=0.0,
            high=1.0,
            initial=1.0,
            description="share of the setpoint in the proportional part",
        )
    ]
