"""The margins of a controller's loops as a table."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.report.analysis_tables import Grid
from clepsydra.report.quantities import number_text, time_cell
from clepsydra.studies.warnings.loop_response import LoopResponse


def margin_grid(response: LoopResponse) -> Grid:
    """Return gain, phase and delay margin of every channel broken alone, the others closed.

    Parameters
    ----------
    response : LoopResponse
        Of the exact sampled loop.

    Examples
    --------
    >>> from clepsydra.designs.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.studies.warnings.loop_response import loop_response
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> margin_grid(loop_response(controller, analysis.model)).rows[0][0]
    'level_1'
    """
    rows = []
    for name in response.channels:
        channel = response.channels[name]
        phase, crossing = channel.phase_margin
        late = phase / crossing if math.isfinite(phase) and crossing > 0.0 else math.inf
        peak = float(np.max(np.abs(1.0 / (1.0 + channel.loop))))
        inner = " (inner loop)" if name in response.at_inner else ""
        rows.append(
            (
                f"{name}{inner}",
                number_text(channel.gain_margin.value),
                number_text(math.degrees(phase)) + ("°" if math.isfinite(phase) else ""),
                number_text(crossing),
                time_cell(late),
                number_text(peak),
            )
        )
    head = (
        "loop broken at", "gain margin", "phase margin", "crossover [rad/s]", "delay margin",
        "max|S|",
    )  # fmt: skip
    return Grid("Margins, the other loops closed", head, tuple(rows))
