"""The settings of PID loops as an engineer enters them in a control system."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.design.gain_units import GainUnits, gain_units
from clepsydra.design.pid_settings import PidSettings
from clepsydra.report.quantities import number_text, unit_text

_ALGORITHMS = {
    "isa": "ISA (standard, non-interacting)",
    "series": "series (interacting)",
    "parallel": "parallel (independent gains)",
    "velocity": "velocity (incremental, ISA)",
}
_ANTI_WINDUPS = {
    "back_calculation": "back-calculation (external reset)",
    "conditional_integration": "conditional integration",
    "clamping": "integral kept within the output's limits",
    "none": "none",
}


@dataclass(frozen=True)
class LoopSettings:
    """One PID loop as facts: (what, value).

    Parameters
    ----------
    title : str
        "level_1 by pump_1"
    facts : tuple of (str, str)

    Examples
    --------
    >>> LoopSettings("level by pump", (("action", "reverse"),)).facts[0][1]
    'reverse'
    """

    title: str
    facts: tuple[tuple[str, str], ...]


def loop_settings(controller: Controller) -> list[LoopSettings]:
    """Return the settings of every PID loop of a controller, in every unit and form in use.

    Parameters
    ----------
    controller : Controller

    Returns
    -------
    list of LoopSettings
        Empty for a controller without PID loops.

    Examples
    --------
    >>> from clepsydra.study.study import run_study
    >>> result = run_study("quadruple-tank")
    >>> best = next(c for c in result.ranking if c.controller.name == "PI, SIMC")
    >>> loop_settings(best.controller)[0].facts[:2]
    (('measures', 'level_1'), ('moves', 'pump_1'))
    """
    return [
        _loop(block, controller) for block in controller.law.blocks if isinstance(block, PidBlock)
    ]


def _loop(block: PidBlock, controller: Controller) -> LoopSettings:
    number, form, values = block.number, block.form, controller.values
    settings = _isa_settings(block, controller)
    facts = [
        ("measures", block.measurement.name),
        ("moves", _moved(block)),
        ("algorithm", _ALGORITHMS[form.algorithm]),
    ]
    if settings is not None and settings.gain != 0.0:
        facts += _gains(settings, form, block.measurement, block.moved)
    if f"derivative_filter_{number}" in values:
        derivative = values[f"derivative_time_{number}"] / values[f"derivative_filter_{number}"]
        facts.append(("derivative filter", f"{number_text(derivative, 4)} s time constant"))
        facts.append(("derivative of", f"the {form.derivative_on}"))
    if f"setpoint_weight_{number}" in values:
        weight = number_text(values[f"setpoint_weight_{number}"], 3)
        facts.append(("setpoint weight", weight))
    facts.append(("anti-windup", _ANTI_WINDUPS[form.winding]))
    if form.tracks_back:
        tracking = number_text(values[f"tracking_time_{number}"], 4)
        facts.append(("tracking time", f"{tracking} s"))
    if block.direct is not None:
        unit = unit_text(block.moved.unit)
        low, high = (
            number_text(values[f"{end}_limit_{block.direct}"], 4) for end in ("low", "high")
        )
        facts.append(("output limits", f"{low} to {high} {unit}"))
        bias = number_text(controller.initial_state[f"last_output_{block.direct}"], 4)
        facts.append(("output at rest", f"{bias} {unit}"))
    return LoopSettings(f"{block.measurement.name} by {_moved(block)}", tuple(facts))


def _moved(block: PidBlock) -> str:
    return block.moved.name


def _isa_settings(block: PidBlock, controller: Controller) -> PidSettings | None:
    """Return the settings in ISA form; of a loop with other actions on the error None."""
    number, form, values = block.number, block.form, controller.values
    gain = values[f"proportional_gain_{number}"]
    if form.algorithm == "parallel":
        if gain == 0.0:
            return None
        integral = values.get(f"integral_gain_{number}", 0.0)
        derivative = values.get(f"derivative_gain_{number}", 0.0)
        return PidSettings(gain, gain / integral if integral else math.inf, derivative / gain)
    integral_time = values.get(f"integral_time_{number}", math.inf)
    derivative_time = values.get(f"derivative_time_{number}", 0.0)
    if form.algorithm == "series" and derivative_time:
        factor = 1.0 + derivative_time / integral_time
        return PidSettings(gain * factor, integral_time * factor, derivative_time / factor)
    return PidSettings(gain, integral_time, derivative_time)


def _gains(
    settings: PidSettings, form: PidForm, measurement: Signal, moved: Signal
) -> list[tuple[str, str]]:
    if not (math.isfinite(measurement.span) and math.isfinite(moved.span)):
        return [("gain K", f"{number_text(settings.gain, 4)} {moved.unit}/{measurement.unit}")]
    shown = gain_units(settings, measurement, moved)
    unit = unit_text(shown.unit)
    facts = [
        ("action", _action(shown)),
        (
            "gain K",
            f"{number_text(shown.gain, 4)} {unit} = {number_text(shown.percent_gain, 4)} %/%",
        ),
        ("proportional band", f"{number_text(shown.proportional_band, 4)} %"),
    ]
    if form.has_integral:
        facts.append(
            (
                "integral time Ti",
                f"{number_text(shown.integral_time, 4)} s = "
                f"{number_text(shown.minutes_per_repeat, 4)} min/repeat = "
                f"{number_text(shown.repeats_per_minute, 4)} repeats/min",
            )
        )
    if form.has_derivative:
        facts.append(
            (
                "derivative time Td",
                f"{number_text(shown.derivative_time, 4)} s = "
                f"{number_text(shown.derivative_minutes, 4)} min",
            )
        )
        if shown.series is None:
            facts.append(("as a series form", "none, since Ti < 4 Td"))
        else:
            series = shown.series
            facts.append(
                (
                    "as a series form",
                    f"K = {number_text(series.gain, 4)} {unit}, Ti = "
                    f"{number_text(series.integral_time, 4)} s, Td = "
                    f"{number_text(series.derivative_time, 4)} s",
                )
            )
    if form.has_integral or form.has_derivative:
        parallel = shown.parallel
        words = f"Kp = {number_text(parallel.gain, 4)}"
        if form.has_integral:
            words += f", Ki = {number_text(parallel.integral_gain, 4)} /s"
        if form.has_derivative:
            words += f", Kd = {number_text(parallel.derivative_gain, 4)} s"
        facts.append(("as a parallel form", f"{words} [{unit}]"))
    return facts


def _action(shown: GainUnits) -> str:
    moves = "rises" if shown.action == "reverse" else "falls"
    return f"{shown.action}: the output {moves} when the measurement falls"
