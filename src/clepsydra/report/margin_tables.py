"""The margins of a controller's loops as a table."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.base.section import Table
from clepsydra.report.quantities import number_text, time_cell
from clepsydra.studies.warnings.loop_response import LoopResponse


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
