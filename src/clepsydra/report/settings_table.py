"""The settings of PID loops and what is added to their outputs at a glance, a row each."""

from __future__ import annotations

import math

from clepsydra.base.section import Table
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.gain_units import gain_units, percent_gain
from clepsydra.process.process import Process
from clepsydra.report.facts import gain_text, known_signal, told_table
from clepsydra.report.pid_tables import isa_settings
from clepsydra.report.quantities import number_text, time_cell

_DIGITS = 3


def settings_table(controller: Controller, process: Process) -> Table | None:
    """Return gain, times and setpoint weight of each loop in ISA form; None where it has no loop.

    The gain K stands in the units of the process file and in % of the output's range per % of the
    measurement's, positive, with "direct" where the output rises with the measurement; the times
    stand in the unit that suits them.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> table = settings_table(cl.design.simc(plant), plant.process)
    >>> table.head
    ('settings, ISA form', 'K', 'K [%/%]', 'Ti', 'b')
    >>> table.rows[0]
    ('level_1 by pump_1', '3.00 V/V', '3.00', '32.0 s', '1')
    """
    loops = [block for block in controller.law.blocks if isinstance(block, PidBlock)]
    if not loops:
        return None
    rows = [_loop(block, controller, process) for block in loops]
    head = ("settings, ISA form", "K", "K [%/%]", "Ti", "Td", "b")
    return told_table(head, rows)


def added_table(controller: Controller, process: Process) -> Table | None:
    """Return what decoupling and feedforward add to the outputs of loops, a row each, or None.

    Gain (1 + lead s)/(1 + lag s) times the way of a signal from where it adds nothing.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> decoupled = cl.design.simc(plant, decoupling="static")
    >>> added_table(decoupled, plant.process).rows[0]
    ('pump_1 from pump_2', '−0.575 V/V', '−0.575')
    """
    sums = (block for block in controller.law.blocks if isinstance(block, FeedforwardBlock))
    rows = [_added(term, controller, process) for block in sums for term in block.terms]
    head = ("added to", "gain", "gain [%/%]", "lead", "lag")
    return told_table(head, rows) if rows else None


def _loop(block: PidBlock, controller: Controller, process: Process) -> tuple[str, ...]:
    measurement, moved = (known_signal(process, each) for each in (block.measurement, block.moved))
    name = f"{measurement.name} by {moved.name}"
    settings = isa_settings(block, controller)
    if settings is None:
        return name, "no ISA form", "", "", "", ""
    ranged = measurement.has_range and moved.has_range
    percent = gain_units(settings, measurement, moved).percent_gain if ranged else 0.0
    weight = controller.values.get(f"{block.owner}.setpoint_weight")
    return (
        name,
        gain_text(settings.gain, measurement, moved, _DIGITS),
        number_text(percent, _DIGITS) + (", direct" if settings.gain < 0.0 else "")
        if percent
        else "",
        time_cell(settings.integral_time) if math.isfinite(settings.integral_time) else "none",
        time_cell(settings.derivative_time) if settings.derivative_time else "",
        "" if weight is None else f"{weight:.2g}",
    )


def _added(term: FeedforwardTerm, controller: Controller, process: Process) -> tuple[str, ...]:
    signal, moved = (known_signal(process, each) for each in (term.signal, term.moved))
    gain = controller.values[f"{term.owner}.gain"]
    ranged = signal.has_range and moved.has_range
    times = (controller.values.get(f"{term.owner}.{what}", 0.0) for what in ("lead", "lag"))
    return (
        f"{moved.name} from {signal.name}",
        gain_text(gain, signal, moved, _DIGITS),
        number_text(percent_gain(gain, signal, moved), _DIGITS) if ranged else "",
        *(time_cell(time) if time else "" for time in times),
    )
