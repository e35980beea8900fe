"""The linear analysis as rows of text, for a terminal and for a page."""

from __future__ import annotations

import math
from itertools import chain

import numpy as np

from clepsydra.base.section import Table
from clepsydra.base.signal import Signal
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.analysis_words import root_text
from clepsydra.linear.controllability import NOT_AT_ALL
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.report.law_tables import gains_table
from clepsydra.report.quantities import (
    number_text,
    percent_text,
    quantity_text,
    time_cell,
)
from clepsydra.studies.warnings.loop_response import LoopResponse


def operating_point_grid(point: OperatingPoint) -> Table:
    """Return every signal of an operating point in its display unit and in percent.

    Examples
    --------
    >>> import clepsydra as cl
    >>> operating_point_grid(cl.load("quadruple-tank").point).rows[0]
    ('tank_1.level', '12.26 cm', '61.3 %')
    """
    process, values = point.process, point.as_dict()
    groups = process.state, process.inputs, process.disturbances, process.measurements
    rows = tuple(value_row(process, each, values[each.name], 4) for each in chain(*groups))
    return Table("Operating point", ("signal", "value", "of range"), rows)


def value_row(process: Process, signal: Signal, value: float, digits: int) -> tuple[str, str, str]:
    """Return a signal's name, and its value in its display unit and in percent."""
    percent = percent_text(process, signal.name, value)
    return signal.name, quantity_text(signal, value, digits), percent


def roots_grid(analysis: Analysis) -> Table:
    """Return poles with their time constants, then transmission zeros; a pair is one row.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> roots_grid(analysis).rows[0]
    ('pole', '−0.0110', '90.6 s')
    """
    rows = [
        ("poles" if root.imag else "pole", root_text(root), time_cell(float(time)))
        for root, time in zip(analysis.poles, analysis.time_constants, strict=True)
        if root.imag >= 0.0
    ]
    zeros = [root for root in analysis.zeros if root.imag >= 0.0]
    rows += [("zeros" if root.imag else "zero", root_text(root), "") for root in zeros]
    rows += [] if zeros else [("zero", "none", "")]
    return Table("Poles and zeros", ("", "rad/s", "time constant"), tuple(rows))


def static_gain_grid(analysis: Analysis) -> Table:
    """Return the static gain from inputs to outputs in display units.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> static_gain_grid(analysis).head
    ('', 'pump_1 [V]', 'pump_2 [V]')
    """
    process, model = analysis.operating_point.process, analysis.model
    rows, columns = (
        [process.signal(name) for name in names] for names in (model.outputs, model.inputs)
    )
    return gains_table("Static gain", analysis.static_gain, rows, columns, 3)


def relative_gain_grid(analysis: Analysis) -> Table | None:
    """Return the relative gain array with the suggested pairs marked; None where there is none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> relative_gain_grid(analysis).rows
    (('level_1', '● 1.400', '−0.400'), ('level_2', '−0.400', '● 1.400'))
    """
    relative, model = analysis.relative_gain_array, analysis.model
    if relative is None:
        return None
    rows = []
    for output, gains in zip(model.outputs, relative, strict=True):
        dots = ["● " * ((output, name) in analysis.pairing) for name in model.inputs]
        cells = (f"{dot}{gain:.3f}" for dot, gain in zip(dots, gains, strict=True))
        rows.append((output, *(cell.replace("-", "−") for cell in cells)))
    return Table("Relative gains at rest, ● pairing", ("", *model.inputs), tuple(rows))


def analysis_grids(analysis: Analysis) -> list[Table]:
    """Return every table of an analysis but the operating point."""
    makers = roots_grid, static_gain_grid, relative_gain_grid
    return [grid for make in makers if (grid := make(analysis)) is not None]


def dead_time_grid(analysis: Analysis) -> Table | None:
    """Return the dead time of each pair; None where there is none."""
    if analysis.model.delays is None:
        return None
    rows = tuple(
        (output, *("several" if math.isnan(time) else time_cell(time) for time in times))
        for output, times in zip(analysis.model.outputs, analysis.dead_times, strict=True)
    )
    return Table("Dead time", ("", *analysis.model.inputs), rows)


def frequency_grid_table(analysis: Analysis) -> Table:
    """Return singular values, condition number and relative gains at a few frequencies."""
    found, model = analysis.directionality, analysis.model
    columns = {"rad/s": found.frequencies}
    if found.singular_values is not None and found.condition_numbers is not None:
        columns |= {f"σ{k}": values for k, values in enumerate(found.singular_values.T, start=1)}
        if found.singular_values.shape[1] > 1:
            columns["condition number"] = found.condition_numbers
    for output, name in analysis.pairing if min(found.relative_gains.shape[1:]) > 1 else ():
        gains = found.relative_gains[:, model.outputs.index(output), model.inputs.index(name)]
        columns[f"|λ| {output} by {name}"] = np.abs(gains)
    numbers = np.column_stack(list(columns.values())).tolist()
    rows = tuple(tuple(map(number_text, row)) for row in numbers)
    return Table("Over frequency, in shares of the ranges", tuple(columns), rows)


def reach_grid(analysis: Analysis) -> Table | None:
    """Return how well each mode is reached and shown; None where a range is missing.

    And where the margins of many modes are left out, which a sentence says.

    Examples
    --------
    >>> import clepsydra as cl
    >>> reach_grid(cl.load("wet-well").analysis).rows[0][1]
    'well.level'
    """
    if analysis.reach is None or not analysis.reach.controllability:
        return None
    # The state that moves most in the mode, its right eigenvector, is that of observability.
    found = zip(analysis.reach.controllability, analysis.reach.observability, strict=True)
    rows = tuple(
        (root_text(reached.pole), shown.state, _share(reached.share), _share(shown.share))
        for reached, shown in found
        if reached.pole.imag >= 0.0
    )
    title = "Modes: how well the inputs reach them and the outputs show them"
    return Table(title, ("pole [rad/s]", "mainly", "reached", "shown"), rows)


def hankel_grid(analysis: Analysis) -> Table | None:
    """Return the Hankel singular values, largest first; None where a range is missing."""
    if analysis.reach is None:
        return None
    found = analysis.reach.hankel
    # Beyond this share of the largest a value says nothing that the first ones did not.
    values = [v for v in found.values if v > 1e-6 * found.values[0]]
    rows = [(str(place), number_text(float(v))) for place, v in enumerate(values, start=1)]
    rows += [("–", f"none for the pole at {root_text(pole)} rad/s") for pole in found.split_off]
    return Table("Hankel singular values, in shares of the ranges", ("", "value"), tuple(rows))


def blocking_zeros_grid(analysis: Analysis) -> Table | None:
    """Return zeros in the right half-plane with their directions; None where there are none."""
    found, model = analysis.right_half_plane_zeros, analysis.model
    if not found:
        return None
    rows = (
        (root_text(each.zero), *map(_direction, (*each.input_direction, *each.output_direction)))
        for each in found
    )
    head = ("zero [rad/s]", *model.inputs, *model.outputs)
    return Table("Zeros in the right half-plane and their directions", head, tuple(rows))


def further_grids(analysis: Analysis) -> list[Table]:
    """Return the tables that a page of analysis shows besides those of a study's report."""
    makers = dead_time_grid, blocking_zeros_grid, frequency_grid_table, reach_grid, hankel_grid
    return [grid for make in makers if (grid := make(analysis)) is not None]


def margin_grid(response: LoopResponse) -> Table:
    """Return gain, phase and delay margin of every channel broken alone, the others closed.

    Parameters
    ----------
    response : LoopResponse
        Of the exact sampled loop.
    """
    rows = []
    for name, found in margin_table(response).items():
        inner = " (inner loop)" if name in response.at_inner else ""
        gain, phase, crossing, late, peak = found.values()
        angle = f"{number_text(phase)}{'°' * math.isfinite(phase)}"
        numbers = number_text(gain), angle, number_text(crossing), time_cell(late)
        rows.append((f"{name}{inner}", *numbers, number_text(peak)))
    margins = "gain margin", "phase margin", "crossover [rad/s]", "delay margin", "max|S|"
    several = len(response.channels) > 2  # a single loop is broken at its two ends
    title = "Margins, the other loops closed" if several else "Margins"
    return Table(title, ("loop broken at", *margins), tuple(rows))


def margin_table(response: LoopResponse) -> dict[str, dict[str, float]]:
    """Return the numbers of `margin_grid`: each channel to its margins."""
    found = {}
    for name, channel in response.channels.items():
        phase, crossing = channel.phase_margin
        late = phase / crossing if math.isfinite(phase) and crossing > 0.0 else math.inf
        found[name] = {
            "gain margin": channel.gain_margin.value,
            "phase margin [deg]": math.degrees(phase),
            "crossover [rad/s]": crossing,
            "delay margin [s]": late,
            "max|S|": float(np.max(np.abs(1.0 / (1.0 + channel.loop)))),
        }
    return found


def _share(value: float) -> str:
    return "not at all" if value < NOT_AT_ALL else number_text(value, 2)


def _direction(value: complex) -> str:
    if abs(value.imag) <= 1e-9:
        return f"{value.real:.2f}".replace("-", "−")
    return f"{abs(value):.2f} ∠ {math.degrees(math.atan2(value.imag, value.real)):.0f}°"
