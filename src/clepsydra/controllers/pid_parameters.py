"""The parameters of one PID loop, named and with their units."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.pid_form import PidForm

#: The smallest and the largest ratio of derivative to filter time.
_FILTER = (1.0, 1000.0)
#: The gains of a loop, with the time that their unit has beside those of the signals.
GAINS = {"proportional_gain": "", "integral_gain": "/s", "derivative_gain": " s"}


def pid_parameters(number: int, form: PidForm, measurement: Signal, moved: Signal) -> list[Signal]:
    """Return the parameters of loop `number`.

    Parameters
    ----------
    number : int
        k, from 1.
    form : PidForm
    measurement, moved : Signal
        What the loop measures, and what it moves: an output or another loop's setpoint.

    Returns
    -------
    list of Signal
        proportional_gain_k; integral_time_k, derivative_time_k [s] and derivative_filter_k [1],
        or in the parallel form integral_gain_k, derivative_gain_k and filter_time_k [s];
        setpoint_weight_k [1], or gap_k and gap_gain_k [1], or squared_error_scale_k;
        setpoint_ramp_k and tracking_time_k [s]: each where the form has it.

    Examples
    --------
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> [p.name for p in pid_parameters(1, PidForm("PID", anti_windup="none"), level, pump)]
    ['proportional_gain_1', 'integral_time_1', 'derivative_time_1', 'derivative_filter_1', \
'setpoint_weight_1']
    """
    way = f"from {measurement.name} to {moved.name}"
    ratio = signals.ratio_of_units
    found = [
        signals.gain(
            f"proportional_gain_{number}",
            ratio(moved.unit, measurement.unit),
            1.0,
            f"proportional gain {way}",
        )
    ]
    if form.algorithm == "parallel":
        found += _parallel(number, form, measurement, moved, way)
    else:
        found += _times(number, form)
    found += _shape(number, form, measurement)
    if form.setpoint_ramp:
        found.append(
            Signal(
                f"setpoint_ramp_{number}",
                ratio(measurement.unit, "s"),
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=signals.LARGEST_PARAMETER,
                description=f"largest rate of change of the setpoint of {measurement.name}",
            )
        )
    if form.tracks_back:
        found.append(signals.tracking_time(number))
    return found


def remembered(number: int, form: PidForm) -> list[str]:
    """Return the parameters whose last value counts where they change, so that nothing jumps.

    The velocity form has no integral that takes a change up: there it is the filter's alone.

    Examples
    --------
    >>> remembered(1, PidForm("PI"))
    ['proportional_gain_1', 'setpoint_weight_1']
    """
    if form.algorithm == "velocity":
        names = ["derivative_time", "derivative_filter"] if form.has_derivative else []
        return [f"{name}_{number}" for name in names]
    names = ["proportional_gain"]
    if form.has_derivative:
        parallel = form.algorithm == "parallel"
        names += (
            ["derivative_gain", "filter_time"]
            if parallel
            else ["derivative_time", "derivative_filter"]
        )
    names += {
        "linear": ["setpoint_weight"],
        "gap": ["gap", "gap_gain"],
        "squared": ["squared_error_scale"],
    }[form.error]
    return [f"{name}_{number}" for name in names]


def _times(number: int, form: PidForm) -> list[Signal]:
    found = []
    if form.has_integral:
        found.append(signals.duration(f"integral_time_{number}", "integral time"))
    if form.has_derivative:
        found += [
            Signal(
                f"derivative_time_{number}",
                "s",
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=0.0,
                description="derivative time",
            ),
            Signal(
                f"derivative_filter_{number}",
                low=_FILTER[0],
                high=_FILTER[1],
                initial=10.0,
                description="derivative time over the time constant of its filter",
            ),
        ]
    return found


def _parallel(
    number: int, form: PidForm, measurement: Signal, moved: Signal, way: str
) -> list[Signal]:
    found = []
    if form.has_integral:
        unit = signals.ratio_of_units(moved.unit, measurement.unit, "s")
        found.append(signals.gain(f"integral_gain_{number}", unit, 0.0, f"integral gain {way}"))
    if form.has_derivative:
        per = signals.ratio_of_units(moved.unit, measurement.unit)
        unit = "s" if per == "1" else f"s {per}"
        found += [
            signals.gain(f"derivative_gain_{number}", unit, 0.0, f"derivative gain {way}"),
            signals.duration(f"filter_time_{number}", "time constant of the derivative's filter"),
        ]
    return found


def _shape(number: int, form: PidForm, measurement: Signal) -> list[Signal]:
    if form.error == "gap":
        return [
            Signal(
                f"gap_{number}",
                measurement.unit,
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                description=f"half the width of the gap around the setpoint of {measurement.name}",
            ),
            Signal(
                f"gap_gain_{number}",
                low=0.0,
                high=1.0,
                initial=0.1,
                description="share of the error that acts within the gap",
            ),
        ]
    if form.error == "squared":
        return [
            Signal(
                f"squared_error_scale_{number}",
                measurement.unit,
                low=signals.SHORTEST_TIME,
                high=signals.LARGEST_PARAMETER,
                initial=1.0,
                description=f"error of {measurement.name} at which the gain is the nominal one",
            )
        ]
    return [
        Signal(
            f"setpoint_weight_{number}",
            low=0.0,
            high=1.0,
            initial=1.0,
            description="share of the setpoint in the proportional part",
        )
    ]
