"""The settings of PID loops as an engineer enters them in a control system."""

from __future__ import annotations

import math
from itertools import compress

from clepsydra.base.errors import InputError
from clepsydra.base.section import Table
from clepsydra.base.units import unit_text
from clepsydra.controllers.blocks.anti_windup import IN_WORDS
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.pid_keys import PARAMETERS
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.gain_units import gain_factor, percent_gain
from clepsydra.designs.loops.pid_settings import (
    ParallelSettings,
    PidSettings,
    SeriesSettings,
    from_parallel,
    from_series,
    to_parallel,
    to_series,
)
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.report.facts import (
    DIGITS,
    facts_table,
    gain_text,
    gain_unit,
    known_signal,
    level_words,
    own_values,
    range_text,
    told_table,
)
from clepsydra.report.law_tables import output_facts
from clepsydra.report.quantities import (
    display_factor,
    number_text,
    quantity_text,
    setting_time,
    time_cell,
)

_ALGORITHMS = {
    "isa": "ISA (standard, non-interacting)",
    "series": "series (interacting)",
    "parallel": "parallel (independent gains)",
    "velocity": "velocity (incremental, ISA)",
}
_Facts = list[tuple[str, str]]
#: Said below settings of PID loops, and where a ranking is explained.
SETTINGS_WORDS = (
    "Settings of a PID loop: r is the setpoint, y the measurement, u the output, D the filtered "
    "derivative, b the setpoint weight, "
    f"the {PARAMETERS['setpoint_weight'].words}. Reverse action: u rises when y falls; "
    "direct: it falls, and the gains count as negative. The gain in %/% counts both in percent of "
    "their ranges; the proportional band is 100 % divided by it. A repeat is the time in which "
    "the integral does once more what the gain did at once."
)


def settings_table(controller: Controller, process: Process) -> Table | None:
    """Return the settings of each loop in ISA form, a gain without its sign; None without loops.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> settings_table(cl.design.simc(plant), plant.process).rows[0]
    ('level_1 by pump_1', '3.00 V/V', '3.00', '32.0 s', '1', 'reverse')
    """
    loops = _loops(controller, process)
    head = ("ISA settings", "K", "K [%/%]", "Ti", "Td", "b", "action")
    return told_table(head, [loop.row() for loop in loops]) if loops else None


def loop_settings(controller: Controller, point: OperatingPoint) -> list[Table]:
    """Return the settings of every PID loop of a controller, in every unit and form in use.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> loop_settings(controller, plant.point)[0].rows[:2]
    (('measures', 'level_1 (0 to 10 V)'), ('moves', 'pump_1 (0 to 10 V)'))
    """
    return [
        facts_table(f"{loop.measurement.name} by {loop.moved.name}", loop.facts(point))
        for loop in _loops(controller, point.process)
    ]


def equation(form: PidForm) -> str:
    """Return the law of a PID loop in automatic, as one equation.

    Examples
    --------
    >>> equation(PidForm())
    'u = K (b r − y) + K/Ti ∫ e dt, e = r − y'
    """
    parallel = form.algorithm == "parallel"
    gain, integral, derivative = ("Kp", "Ki", "Kd") if parallel else ("K", "K/Ti", "K Td")
    error = {"linear": "e", "gap": "f(e)", "squared": "e |e|/scale"}[form.error]
    differentiated = "D(e)" if form.derivative_on == "error" else "−D(y)"
    if form.algorithm == "series":
        sums = "K/Ti ∫ (r − y′) dt" if form.has_integral else "bias"
        seen = f"y − Td·{differentiated}" if form.has_derivative else "y"
        return f"u = K (b r − y′) + {sums}, y′ = {seen}"
    terms = [f"{gain} (b r − y)" if form.error == "linear" else f"{gain} {error}"]
    terms.append(f"{integral} ∫ {error} dt" if form.has_integral else "bias")
    terms += [f"{derivative}·({differentiated})"] * form.has_derivative
    words = f"u = {' + '.join(terms)}, e = r − y"
    if form.error == "gap":
        words += ", f(e) = e outside the gap, less within it"
    return words + (", computed as increments of u" if form.algorithm == "velocity" else "")


def _loops(controller: Controller, process: Process) -> list[_Loop]:
    blocks = controller.law.blocks
    return [_Loop(each, controller, process) for each in blocks if isinstance(each, PidBlock)]


class _Loop:
    """A loop with its settings [SI], and with its signals as the process shows them."""

    def __init__(self, block: PidBlock, controller: Controller, process: Process) -> None:
        self.block, self.form, self.controller = block, block.form, controller
        self.values = own_values(block.parameters(), controller)
        self.measurement = known_signal(process, block.measurement)
        self.moved = known_signal(process, block.moved)
        self.ranged = self.measurement.has_range and self.moved.has_range
        self.settings = self._isa()

    def _isa(self) -> PidSettings | None:
        """Return the settings in ISA form; None where there is none."""
        values, gain = self.values, self.values["proportional_gain"]
        if gain == 0.0:
            return None
        if self.form.algorithm == "parallel":
            others = (values.get(f"{part}_gain", 0.0) for part in ("integral", "derivative"))
            try:
                return from_parallel(ParallelSettings(gain, *others))
            except InputError:
                return None
        times = values.get("integral_time", 0.0) or math.inf, values.get("derivative_time", 0.0)
        if self.form.algorithm == "series":
            return from_series(SeriesSettings(gain, *times))
        return PidSettings(gain, *times)

    def row(self) -> tuple[str, ...]:
        """Return name, gain, the same in percent, times, setpoint weight and action."""
        name, found = f"{self.measurement.name} by {self.moved.name}", self.settings
        if found is None:
            return name, "no ISA form", "", "", "", "", ""
        percent = percent_gain(found.gain, self.measurement, self.moved) if self.ranged else 0.0
        weight = self.values.get("setpoint_weight")
        return (
            name,
            gain_text(abs(found.gain), self.measurement, self.moved, 3),
            number_text(abs(percent)) if percent else "",
            time_cell(found.integral_time) if math.isfinite(found.integral_time) else "none",
            time_cell(found.derivative_time) if found.derivative_time else "",
            "" if weight is None else f"{weight:.2g}",
            found.action,
        )

    def facts(self, point: OperatingPoint) -> _Facts:
        """Return everything about it."""
        form = self.form
        facts = [
            ("measures", range_text(self.measurement)),
            ("moves", self._moves()),
            ("setpoint", self._setpoint(point)),
            ("algorithm", f"{_ALGORITHMS[form.algorithm]}: {equation(form)}"),
            *self._gains(),
            *self._options(),
        ]
        if form.has_integral:
            facts.append(("anti-windup", IN_WORDS[form.winding]))
        if form.tracks_back:
            facts.append(("tracking time", setting_time(self.values["tracking_time"])))
        return facts + (output_facts(self.moved, self.controller) if self.block.direct else [])

    def _moves(self) -> str:
        block, moved = self.block, range_text(self.moved)
        if block.direct:
            return moved
        for other in self.controller.law.blocks:
            if isinstance(other, PidBlock) and other.setpoint == block.name:
                return f"the setpoint of {moved}"
        return f"{moved}, through the blocks below ({block.name})"

    def _setpoint(self, point: OperatingPoint) -> str:
        block, measurement = self.block, self.measurement
        if block.inner:
            ends = (self.values[f"setpoint_{end}_limit"] for end in ("low", "high"))
            low, high = (quantity_text(measurement, end, DIGITS) for end in ends)
            return f"from {block.setpoint} (cascade), kept from {low} to {high}"
        fixed = self.controller.free_inputs.get(block.setpoint)
        if fixed is not None:
            return f"fixed at {level_words(point.process, measurement, fixed)}"
        rest = level_words(point.process, measurement, point.as_dict()[measurement.name])
        remote = ", or from a remote source" if block.form.remote_setpoint else ""
        return f"from the operator, {rest} at rest{remote}"

    def _gains(self) -> _Facts:
        settings, form, signals = self.settings, self.form, (self.measurement, self.moved)
        if settings is None:
            proportional = self.values["proportional_gain"]
            if proportional == 0.0:
                return [("gain K", "0: no proportional action")]
            words = "none: its gains have different signs"
            return [("gain K", gain_text(proportional, *signals)), ("the ISA form", words)]
        moves = {"reverse": "rises", "direct": "falls"}[settings.action]
        words = f"{settings.action}: the output {moves} when the measurement falls"
        facts, times = [("action", words)], _times(settings, form)
        settings = settings._replace(gain=abs(settings.gain))
        gain = gain_text(settings.gain, *signals)
        if not self.ranged:
            return [*facts, ("gain K", gain), *times]
        share = abs(percent_gain(settings.gain, *signals))
        percent = f"{number_text(share, DIGITS)} %/%"
        if percent != gain:
            gain += f", that is {percent}"
        band = f"{number_text(100.0 / share, DIGITS)} %"
        facts += [("gain K", gain), ("proportional band", band), *times]
        factor, unit = gain_factor(*signals), gain_unit(*signals)
        if form.has_derivative:
            words = "none, since Ti < 4 Td"
            if settings.integral_time >= 4.0 * settings.derivative_time:
                series = to_series(settings)
                words = _symbols(
                    ("K", series.gain * factor, unit),
                    ("Ti", series.integral_time, "s"),
                    ("Td", series.derivative_time, "s"),
                )
            facts.append(("the same in series form", words))
        if form.has_integral or form.has_derivative:
            unit = unit or "1"
            units = unit, f"{unit} per s", f"{unit} × s"
            gains = [factor * each for each in to_parallel(settings)]
            parts = zip(("Kp", "Ki", "Kd"), gains, units, strict=True)
            told = compress(parts, (True, form.has_integral, form.has_derivative))
            facts.append(("the same in parallel form", _symbols(*told)))
        return facts

    def _options(self) -> _Facts:
        """Return filter, setpoint weight, shape of the error and ramp, each where there is one."""
        values, facts = self.values, []
        factor, unit = display_factor(self.measurement), unit_text(self.measurement.shown_unit)
        if self.form.has_derivative:
            seconds, words = values.get("filter_time"), ""
            if seconds is None:
                ratio = values["derivative_filter"]
                seconds, words = values["derivative_time"] / ratio, f" (Td/{ratio:g})"
            facts.append(("derivative of", f"the {self.form.derivative_on}"))
            facts.append(("derivative filter", f"{setting_time(seconds)}{words}"))
        for name, what, scale, of in (
            ("setpoint_weight", "setpoint weight b", 1.0, ""),
            ("gap", "gap, to each side", factor, unit),
            ("gap_gain", "share of the error within the gap", 1.0, ""),
            ("squared_error_scale", "error with the nominal gain", factor, unit),
            ("setpoint_ramp", "setpoint moves at most", factor, f"{unit}/s"),
        ):
            if name in values:
                facts.append((what, f"{number_text(values[name] * scale, DIGITS)} {of}".strip()))
        return facts


def _times(settings: PidSettings, form: PidForm) -> _Facts:
    facts = []
    if form.has_integral:
        minutes = settings.integral_time / 60.0
        shown, repeats = (number_text(each, DIGITS) for each in (minutes, 1.0 / minutes))
        words = f"{setting_time(settings.integral_time)} = {shown} min/repeat"
        facts.append(("integral time Ti", f"{words} = {repeats} repeats/min"))
    if form.has_derivative:
        seconds, minutes = settings.derivative_time, settings.derivative_time / 60.0
        words = f"{number_text(seconds, DIGITS)} s = {number_text(minutes, DIGITS)} min"
        facts.append(("derivative time Td", words))
    return facts


def _symbols(*numbers: tuple[str, float, str]) -> str:
    return ", ".join(
        f"{name} = {number_text(value, DIGITS)} {unit}" for name, value, unit in numbers
    )
