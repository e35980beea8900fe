"""The linear analysis as rows of text, for a terminal and for a page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.linear.analysis import Analysis
from clepsydra.linear.analysis_words import root_text
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.report.quantities import display_factor, number_text, quantity_text, unit_text


@dataclass(frozen=True)
class Grid:
    """A table of text with a title, a head and rows; the first column holds names.

    Examples
    --------
    >>> Grid("Scenario", ("what", "size"), (("load inflow_1", "+2 cm³/s"),)).rows[0]
    ('load inflow_1', '+2 cm³/s')
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def operating_point_grid(point: OperatingPoint) -> Grid:
    """Return every signal of an operating point in its display unit and in percent.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> operating_point_grid(analysis.operating_point).rows[0]
    ('tank_1.level', '12.26 cm', '61.3 %')
    """
    process, values = point.process, point.as_dict()
    rows = []
    for group in (process.state, process.inputs, process.disturbances, process.measurements):
        for signal in group:
            value = values[signal.name]
            bounded = 0.0 < signal.span < math.inf
            percent = f"{number_text(signal.to_percent(value))} %" if bounded else ""
            rows.append((signal.name, quantity_text(signal, value, 4), percent))
    return Grid("Operating point", ("signal", "value", "of range"), tuple(rows))


def roots_grid(analysis: Analysis) -> Grid:
    """Return poles with their time constants, then transmission zeros; a pair is one row.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> roots_grid(analysis).rows[0]
    ('pole', '−0.0110', '90.6 s')
    """
    rows = [
        ("pole" if root.imag == 0.0 else "poles", root_text(root), f"{number_text(float(time))} s")
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
    return Grid("Poles and zeros", ("", "rad/s", "time constant"), tuple(rows))


def static_gain_grid(analysis: Analysis) -> Grid:
    """Return the static gain from inputs to outputs in display units.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
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
    return Grid("Static gain", ("", *head), tuple(rows))


def relative_gain_grid(analysis: Analysis) -> Grid | None:
    """Return the relative gain array with the suggested pairs marked; None where there is none.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
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
    return Grid("Relative gains, ● pairing", ("", *model.inputs), tuple(rows))


def analysis_grids(analysis: Analysis) -> list[Grid]:
    """Return every table of an analysis but the operating point.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> [grid.title for grid in analysis_grids(analysis)]
    ['Poles and zeros', 'Static gain', 'Relative gains, ● pairing']
    """
    grids = [roots_grid(analysis), static_gain_grid(analysis), relative_gain_grid(analysis)]
    return [grid for grid in grids if grid is not None]


def _numbers(values: Sequence[float] | np.ndarray) -> list[str]:
    return [number_text(float(value)) for value in values]
