"""The linear analysis as rows of text, for a terminal and for a page."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.base.section import Table
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.analysis_words import root_text
from clepsydra.linear.controllability import NOT_AT_ALL
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.report.quantities import (
    display_factor,
    number_text,
    percent_text,
    quantity_text,
    time_cell,
    unit_text,
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
    rows = []
    for group in (process.state, process.inputs, process.disturbances, process.measurements):
        for signal in group:
            value = values[signal.name]
            percent = percent_text(process, signal.name, value)
            rows.append((signal.name, quantity_text(signal, value, 4), percent))
    return Table("Operating point", ("signal", "value", "of range"), tuple(rows))


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
        ("pole" if root.imag == 0.0 else "poles", root_text(root), time_cell(float(time)))
        for root, time in zip(analysis.poles, analysis.time_constants, strict=True)
        if root.imag >= 0.0
    ]
    rows += [
        ("zero" if root.imag == 0.0 else "zeros", root_text(root), "")
        for root in analysis.zeros
        if root.imag >= 0.0
    ]
    if not len(analysis.zeros):
        rows.append(("zero", "none", ""))
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
    outputs = [process.signal(name) for name in model.outputs]
    inputs = [process.signal(name) for name in model.inputs]
    scale = np.outer(
        [display_factor(signal) for signal in outputs],
        [1.0 / display_factor(signal) for signal in inputs],
    )
    rows = []
    for place, signal in enumerate(outputs):
        gains = analysis.static_gain[place] * scale[place]
        rows.append((f"{signal.name} [{unit_text(signal.shown_unit)}]", *_numbers(gains)))
    head = tuple(f"{signal.name} [{unit_text(signal.shown_unit)}]" for signal in inputs)
    return Table("Static gain", ("", *head), tuple(rows))


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
        marked = [
            ("● " if (output, name) in analysis.pairing else "") + f"{gain:.3f}".replace("-", "−")
            for name, gain in zip(model.inputs, gains, strict=True)
        ]
        rows.append((output, *marked))
    return Table("Relative gains, ● pairing", ("", *model.inputs), tuple(rows))


def analysis_grids(analysis: Analysis) -> list[Table]:
    """Return every table of an analysis but the operating point.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> [grid.title for grid in analysis_grids(analysis)]
    ['Poles and zeros', 'Static gain', 'Relative gains, ● pairing']
    """
    grids = [roots_grid(analysis), static_gain_grid(analysis), relative_gain_grid(analysis)]
    return [grid for grid in grids if grid is not None]


def dead_time_grid(analysis: Analysis) -> Table | None:
    """Return the dead time of each pair; None where there is none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> dead_time_grid(cl.load("quadruple-tank").analysis) is None
    True
    """
    if analysis.model.delays is None:
        return None
    rows = tuple(
        (output, *("several" if math.isnan(time) else time_cell(time) for time in times))
        for output, times in zip(analysis.model.outputs, analysis.dead_times, strict=True)
    )
    return Table("Dead time", ("", *analysis.model.inputs), rows)


def frequency_grid_table(analysis: Analysis) -> Table:
    """Return singular values, condition number and relative gains at a few frequencies.

    Examples
    --------
    >>> import clepsydra as cl
    >>> frequency_grid_table(cl.load("quadruple-tank").analysis).rows[0][0]
    '0'
    """
    found, model = analysis.directionality, analysis.model
    head, columns = ["rad/s"], [[number_text(omega) for omega in found.frequencies]]
    if found.singular_values is not None and found.condition_numbers is not None:
        for place, values in enumerate(found.singular_values.T, start=1):
            head.append(f"σ{place}")
            columns.append(_numbers(values))
        if found.singular_values.shape[1] > 1:
            head.append("condition number")
            columns.append(_numbers(found.condition_numbers))
    for output, name in analysis.pairing if min(found.relative_gains.shape[1:]) > 1 else ():
        gains = found.relative_gains[:, model.outputs.index(output), model.inputs.index(name)]
        head.append(f"|λ| {output} by {name}")
        columns.append(_numbers(np.abs(gains)))
    rows = tuple(tuple(row) for row in zip(*columns, strict=True))
    return Table("Over frequency, in shares of the ranges", tuple(head), rows)


def reach_grid(analysis: Analysis) -> Table | None:
    """Return how well each mode is reached and shown; None where a range is missing.

    Examples
    --------
    >>> import clepsydra as cl
    >>> reach_grid(cl.load("wet-well").analysis).rows[0][1]
    'well.level'
    """
    if analysis.reach is None:
        return None
    # The state that moves most in the mode, its right eigenvector, is that of observability.
    rows = tuple(
        (root_text(reached.pole), shown.state, _share(reached.share), _share(shown.share))
        for reached, shown in zip(
            analysis.reach.controllability, analysis.reach.observability, strict=True
        )
        if reached.pole.imag >= 0.0
    )
    return Table(
        "Modes: how well the inputs reach them and the outputs show them",
        ("pole [rad/s]", "mainly", "reached", "shown"),
        rows,
    )


def hankel_grid(analysis: Analysis) -> Table | None:
    """Return the Hankel singular values, largest first; None where a range is missing.

    Examples
    --------
    >>> import clepsydra as cl
    >>> len(hankel_grid(cl.load("wet-well").analysis).rows)
    2
    """
    if analysis.reach is None:
        return None
    found = analysis.reach.hankel
    # Beyond this share of the largest a value says nothing that the first ones did not.
    values = [v for v in found.values if v > 1e-6 * found.values[0]]
    rows = [(str(place), number_text(float(v))) for place, v in enumerate(values, start=1)]
    rows += [("–", f"none for the pole at {root_text(pole)} rad/s") for pole in found.split_off]
    return Table("Hankel singular values, in shares of the ranges", ("", "value"), tuple(rows))


def blocking_zeros_grid(analysis: Analysis) -> Table | None:
    """Return zeros in the right half-plane with their directions; None where there are none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> blocking_zeros_grid(cl.load("quadruple-tank").analysis) is None
    True
    """
    found, model = analysis.right_half_plane_zeros, analysis.model
    if not found:
        return None
    rows = []
    for each in found:
        shares = [*each.input_direction, *each.output_direction]
        rows.append((root_text(each.zero), *(_direction(share) for share in shares)))
    head = ("zero [rad/s]", *model.inputs, *model.outputs)
    return Table("Zeros in the right half-plane and their directions", head, tuple(rows))


def further_grids(analysis: Analysis) -> list[Table]:
    """Return the tables that a page of analysis shows besides those of a study's report.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [grid.title.split()[0] for grid in further_grids(cl.load("wet-well").analysis)]
    ['Over', 'Modes:', 'Hankel']
    """
    grids = [
        dead_time_grid(analysis),
        blocking_zeros_grid(analysis),
        frequency_grid_table(analysis),
        reach_grid(analysis),
        hankel_grid(analysis),
    ]
    return [grid for grid in grids if grid is not None]


def margin_grid(response: LoopResponse) -> Table:
    """Return gain, phase and delay margin of every channel broken alone, the others closed.

    Parameters
    ----------
    response : LoopResponse
        Of the exact sampled loop.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.warnings.loop_response import loop_response
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> margin_grid(loop_response(controller, plant.linear)).rows[0][0]
    'level_1'
    """
    rows = []
    for name, found in margin_table(response).items():
        phase = found["phase margin [deg]"]
        inner = " (inner loop)" if name in response.at_inner else ""
        rows.append(
            (
                f"{name}{inner}",
                number_text(found["gain margin"]),
                number_text(phase) + ("°" if math.isfinite(phase) else ""),
                number_text(found["crossover [rad/s]"]),
                time_cell(found["delay margin [s]"]),
                number_text(found["max|S|"]),
            )
        )
    head = (
        "loop broken at", "gain margin", "phase margin", "crossover [rad/s]", "delay margin",
        "max|S|",
    )  # fmt: skip
    return Table("Margins, the other loops closed", head, tuple(rows))


def margin_table(response: LoopResponse) -> dict[str, dict[str, float]]:
    """Return the numbers of `margin_grid`: each channel to its margins.

    Examples
    --------
    See `margin_grid`.
    """
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


def _numbers(values: Sequence[float] | np.ndarray) -> list[str]:
    return [number_text(float(value)) for value in values]
