"""The settings of PID loops as an engineer enters them in a control system."""

from __future__ import annotations

import math

from clepsydra.base.errors import InputError
from clepsydra.base.section import Table
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.anti_windup import IN_WORDS
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.gain_units import GainUnits, gain_units
from clepsydra.designs.loops.pid_settings import (
    ParallelSettings,
    PidSettings,
    SeriesSettings,
    from_parallel,
    from_series,
)
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.report.facts import (
    DIGITS,
    facts_table,
    gain_factor,
    gain_text,
    gain_unit,
    known_signal,
    level_words,
    range_text,
)
from clepsydra.report.law_tables import output_facts
from clepsydra.report.quantities import (
    display_factor,
    number_text,
    quantity_text,
    setting_time,
    unit_text,
)

_ALGORITHMS = {
    "isa": "ISA (standard, non-interacting)",
    "series": "series (interacting)",
    "parallel": "parallel (independent gains)",
    "velocity": "velocity (incremental, ISA)",
}


def loop_settings(controller: Controller, point: OperatingPoint) -> list[Table]:
    """Return the settings of every PID loop of a controller, in every unit and form in use.

    Parameters
    ----------
    controller : Controller
    point : OperatingPoint
        Where it rests; its process lends ranges and display units.

    Returns
    -------
    list of Table
        Empty for a controller without PID loops.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> loop_settings(controller, plant.point)[0].rows[:2]
    (('measures', 'level_1 (0 to 10 V)'), ('moves', 'pump_1 (0 to 10 V)'))
    """
    return [
        _loop(block, controller, point)
        for block in controller.law.blocks
        if isinstance(block, PidBlock)
    ]


def equation(form: PidForm) -> str:
    """Return the law of a PID loop in automatic, as one equation.

    Examples
    --------
    >>> equation(PidForm())
    'u = K (b r − y) + K/Ti ∫ e dt, e = r − y'
    """
    gain = "Kp" if form.algorithm == "parallel" else "K"
    error = {"linear": "e", "gap": "f(e)", "squared": "e |e|/scale"}[form.error]
    first = f"{gain} (b r − y)" if form.error == "linear" else f"{gain} {error}"
    differentiated = "D(e)" if form.derivative_on == "error" else "−D(y)"
    acts = form.has_derivative
    if form.algorithm == "series":
        integral = " + K/Ti ∫ (r − y′) dt" if form.has_integral else " + bias"
        seen = f"y′ = y − Td·{differentiated}" if acts else "y′ = y"
        return f"u = K (b r − y′){integral}, {seen}"
    integral = ("Ki" if form.algorithm == "parallel" else "K/Ti") + f" ∫ {error} dt"
    derivative = "Kd" if form.algorithm == "parallel" else "K Td"
    terms = [first]
    terms.append(integral if form.has_integral else "bias")
    terms += [f"{derivative}·({differentiated})"] if acts else []
    words = f"u = {' + '.join(terms)}, e = r − y"
    if form.error == "gap":
        words += ", f(e) = e outside the gap, less within it"
    return words + (", computed as increments of u" if form.algorithm == "velocity" else "")


def _loop(block: PidBlock, controller: Controller, point: OperatingPoint) -> Table:
    form, values = block.form, _values(block, controller)
    process = point.process
    measurement = known_signal(process, block.measurement)
    moved = known_signal(process, block.moved)
    facts = [
        ("measures", range_text(measurement)),
        ("moves", range_text(moved) if block.direct else _moves(block, moved, controller)),
        ("setpoint", _setpoint(block, controller, measurement, point)),
        ("algorithm", f"{_ALGORITHMS[form.algorithm]}: {equation(form)}"),
        *_gains(block, controller, measurement, moved),
        *_options(block, controller, measurement),
    ]
    if form.has_integral:
        facts.append(("anti-windup", IN_WORDS[form.winding]))
    if form.tracks_back:
        facts.append(("tracking time", setting_time(values["tracking_time"])))
    if block.direct:
        facts += output_facts(moved, controller)
    return facts_table(f"{measurement.name} by {moved.name}", facts)


def _values(block: PidBlock, controller: Controller) -> dict[str, float]:
    """Return the settings of a loop by their names in it."""
    return {each.part: controller.values[each.name] for each in block.parameters()}


def _moves(block: PidBlock, moved: Signal, controller: Controller) -> str:
    for other in controller.law.blocks:
        if isinstance(other, PidBlock) and other.setpoint == block.name:
            return f"the setpoint of {range_text(moved)}"
    return f"{range_text(moved)}, through the blocks below ({block.name})"


def _setpoint(
    block: PidBlock, controller: Controller, measurement: Signal, point: OperatingPoint
) -> str:
    if block.inner:
        values = _values(block, controller)
        low, high = (
            quantity_text(measurement, values[f"setpoint_{end}_limit"], 4)
            for end in ("low", "high")
        )
        return f"from {block.setpoint} (cascade), kept from {low} to {high}"
    fixed = controller.free_inputs.get(block.setpoint)
    if fixed is not None:
        return f"fixed at {level_words(point.process, measurement, fixed)}"
    rest = level_words(point.process, measurement, point.as_dict()[measurement.name])
    words = f"from the operator, {rest} at rest"
    return words + (", or from a remote source" if block.form.remote_setpoint else "")


def isa_settings(block: PidBlock, controller: Controller) -> PidSettings | None:
    """Return the settings in ISA form; None where there is none."""
    form, values = block.form, _values(block, controller)
    gain = values["proportional_gain"]
    if gain == 0.0:
        return None
    if form.algorithm == "parallel":
        integral = values.get("integral_gain", 0.0)
        derivative = values.get("derivative_gain", 0.0)
        try:
            return from_parallel(ParallelSettings(gain, integral, derivative))
        except InputError:
            return None
    integral_time = values.get("integral_time", 0.0) or math.inf
    derivative_time = values.get("derivative_time", 0.0)
    if form.algorithm == "series":
        return from_series(SeriesSettings(gain, integral_time, derivative_time))
    return PidSettings(gain, integral_time, derivative_time)


def _gains(
    block: PidBlock, controller: Controller, measurement: Signal, moved: Signal
) -> list[tuple[str, str]]:
    settings, form = isa_settings(block, controller), block.form
    if settings is None:
        proportional = _values(block, controller)["proportional_gain"]
        if proportional == 0.0:
            return [("gain K", "0: no proportional action")]
        words = "none: its gains have different signs"
        return [("gain K", gain_text(proportional, measurement, moved)), ("the ISA form", words)]
    rises = settings.gain > 0.0
    action = "reverse: the output rises" if rises else "direct: the output falls"
    facts = [("action", f"{action} when the measurement falls")]
    gain = gain_text(settings.gain, measurement, moved)
    if not (measurement.has_range and moved.has_range):
        return [*facts, ("gain K", gain), *_times(settings, form)]
    shown = gain_units(settings, measurement, moved)
    percent = f"{number_text(shown.percent_gain, DIGITS)} %/%"
    if percent != gain:
        gain += f", that is {percent}{'' if rises else ' with direct action'}"
    facts += [
        ("gain K", gain),
        ("proportional band", f"{number_text(shown.proportional_band, DIGITS)} %"),
        *_times(settings, form),
    ]
    factor, unit = gain_factor(measurement, moved), gain_unit(measurement, moved)
    if form.has_derivative:
        facts.append(("the same in series form", _series(shown, factor, unit)))
    if form.has_integral or form.has_derivative:
        facts.append(("the same in parallel form", _parallel(shown, form, factor, unit)))
    return facts


def _times(settings: PidSettings, form: PidForm) -> list[tuple[str, str]]:
    facts = []
    if form.has_integral:
        minutes = settings.integral_time / 60.0
        words = (
            f"{setting_time(settings.integral_time)} = {number_text(minutes, DIGITS)} min/repeat = "
            f"{number_text(1.0 / minutes, DIGITS)} repeats/min"
        )
        facts.append(("integral time Ti", words))
    if form.has_derivative:
        time = settings.derivative_time
        words = f"{number_text(time, DIGITS)} s = {number_text(time / 60.0, DIGITS)} min"
        facts.append(("derivative time Td", words))
    return facts


def _series(shown: GainUnits, factor: float, unit: str) -> str:
    if shown.series is None:
        return "none, since Ti < 4 Td"
    series = shown.series
    return (
        f"K = {number_text(series.gain * factor, DIGITS)} {unit}, "
        f"Ti = {number_text(series.integral_time, DIGITS)} s, "
        f"Td = {number_text(series.derivative_time, DIGITS)} s"
    )


def _parallel(shown: GainUnits, form: PidForm, factor: float, unit: str) -> str:
    parallel, unit = shown.parallel, unit or "1"
    words = f"Kp = {number_text(parallel.gain * factor, DIGITS)} {unit}"
    if form.has_integral:
        words += f", Ki = {number_text(parallel.integral_gain * factor, DIGITS)} {unit} per s"
    if form.has_derivative:
        words += f", Kd = {number_text(parallel.derivative_gain * factor, DIGITS)} {unit} × s"
    return words


def _options(block: PidBlock, controller: Controller, measurement: Signal) -> list[tuple[str, str]]:
    """Return filter, setpoint weight, shape of the error and ramp, each where there is one."""
    values, form = _values(block, controller), block.form
    factor, unit = display_factor(measurement), unit_text(measurement.shown_unit)
    facts = []
    if form.has_derivative:
        seconds = values.get("filter_time")
        words = ""
        if seconds is None:
            ratio = values["derivative_filter"]
            seconds = values["derivative_time"] / ratio
            words = f" (Td/{ratio:g})"
        facts.append(("derivative of", f"the {form.derivative_on}"))
        facts.append(("derivative filter", f"{setting_time(seconds)}{words}"))
    for name, what, scale, of in (
        ("setpoint_weight", "setpoint weight b", 1.0, ""),
        ("gap", "gap, to each side", factor, unit),
        ("gap_gain", "share of the error within the gap", 1.0, ""),
        ("squared_error_scale", "error with the nominal gain", factor, unit),
        ("setpoint_ramp", "setpoint moves at most", factor, f"{unit}/s"),
    ):
        if name in values:
            shown = number_text(values[name] * scale, DIGITS)
            facts.append((what, f"{shown} {of}".strip()))
    return facts
