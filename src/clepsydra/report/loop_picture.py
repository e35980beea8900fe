"""The picture of a closed loop: how near each channel comes to -1, and the peak of S."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.process.process import Process
from clepsydra.report.axes_box import draw_box, draw_legend
from clepsydra.report.chart import LETTER, SIZE, Chart, Scale, thinned
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.quantities import short_text
from clepsydra.studies.warnings.loop_response import LoopResponse

_HEIGHT = 232.0
#: The box of the plane, whose units are as long in both directions, and that of S [pt].
_PLANE, _BAND = (44.0, 234.0), (292.0, 520.0)
_TOP, _FLOOR = 24.0, 204.0
_LEFT, _RIGHT, _LOW, _HIGH = -2.6, 1.2, -2.2, 1.4
_LIMIT = "#D55E00"
_DASH = "4 2"


def loop_svg(response: LoopResponse, process: Process, title: str, prefix: str) -> str:
    """Draw each controlled channel in the complex plane, and the sensitivity over frequency.

    Left: L(e^jωT) of each measurement, also of inner loops, broken alone, the others closed; the
    grey disc around -1 holds what has \\|S\\| above 2, and a dot marks the crossover. Right: the
    largest singular value of S, at the measurements and at the manipulated variables (dashed), up
    to half the sampling frequency.

    Parameters
    ----------
    response : LoopResponse
    process : Process
    title, prefix : str
        As for `trend_svg`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.warnings.loop_response import loop_response
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> response = loop_response(controller, plant.linear)
    >>> loop_svg(response, plant.process, "loops", "a").count("<circle")
    3
    """
    chart = Chart(_HEIGHT, title, prefix)
    _draw_plane(chart, response, process)
    _draw_sensitivity(chart, response)
    return chart.svg()


def _draw_plane(chart: Chart, response: LoopResponse, process: Process) -> None:
    colours = signal_colours(process)
    x, y = Scale(_LEFT, _RIGHT, *_PLANE), Scale(_LOW, _HIGH, _FLOOR, _TOP)
    unit = x.place(1.0) - x.place(0.0)
    box = chart.clip(_PLANE, (_TOP, _FLOOR))
    chart.circle(x.place(-1.0), y.place(0.0), unit / SENSITIVITY_LIMIT, "#e4e8ed")
    draw_box(chart, x, y, x_label="real part of L", y_label="imaginary part of L", ticks=(5, 5))
    turn = np.linspace(0.0, 2.0 * np.pi, 120)
    chart.curve(
        x.places(np.cos(turn)), y.places(np.sin(turn)), MUTED, 0.6, dash="4 3", clip=box
    )  # fmt: skip
    chart.line(_PLANE, (y.place(0.0),) * 2, MUTED, 0.5)
    chart.line((x.place(0.0),) * 2, (_TOP, _FLOOR), MUTED, 0.5)
    centre = (x.place(-1.0), y.place(0.0))
    chart.line((centre[0] - 4.0, centre[0] + 4.0), (centre[1],) * 2, INK, 1.0)
    chart.line((centre[0],) * 2, (centre[1] - 4.0, centre[1] + 4.0), INK, 1.0)
    entries = []
    for name in (*response.outputs, *response.at_inner):
        channel, colour = response.channels[name], colours.get(name, INK)
        across, up = _within(channel.loop)
        chart.curve(x.places(across), y.places(up), colour, 1.4, clip=box)
        phase, crossing = channel.phase_margin
        if math.isfinite(phase):
            at = np.interp(crossing, response.frequencies, channel.loop)
            chart.circle(x.place(at.real), y.place(at.imag), 2.4, colour)
        entries.append((name, colour, 1.4, ""))
    width = sum(len(name) + 8 for name, *_ in entries)
    room = (_PLANE[1] - _PLANE[0] + 40.0) / max(width, 1)
    draw_legend(chart, _PLANE[0], _TOP - 6.0, entries, min(LETTER * SIZE, room))


def _within(loop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return real and imaginary parts, not finite where the curve is far out of the picture."""
    real, imaginary = loop.real.copy(), loop.imag.copy()
    far = (np.abs(loop) > 12.0) | ~np.isfinite(loop)
    hidden = far & np.roll(far, 1) & np.roll(far, -1)
    real[hidden] = np.nan
    # The ends of what is seen stay near enough for a picture's numbers.
    return np.clip(real, -99.0, 99.0), np.clip(imaginary, -99.0, 99.0)


def _draw_sensitivity(chart: Chart, response: LoopResponse) -> None:
    frequencies = response.frequencies
    sizes = [
        np.linalg.svd(values, compute_uv=False)[:, 0]
        for values in (response.at_output, response.at_input)
    ]
    finite = np.concatenate([size[np.isfinite(size)] for size in sizes])
    highest = max(3.0, 1.1 * float(finite.max())) if finite.size else 3.0
    x = Scale(float(frequencies[0]), float(frequencies[-1]), *_BAND, logarithmic=True)
    y = Scale(0.05, highest, _FLOOR, _TOP, logarithmic=True)
    draw_box(chart, x, y, x_label="frequency [rad/s]", y_label="largest singular value of S")
    chart.line(_BAND, (y.place(SENSITIVITY_LIMIT),) * 2, _LIMIT, 0.8)
    words = short_text(SENSITIVITY_LIMIT)
    chart.text(_BAND[0] + 3.0, y.place(SENSITIVITY_LIMIT) - 2.5, words, colour=_LIMIT)
    chart.line(_BAND, (y.place(1.0),) * 2, MUTED, 0.5)
    for size, dash in zip(sizes, ("", _DASH), strict=True):
        box = chart.clip(_BAND, (_TOP, _FLOOR))
        shown = np.where(np.isfinite(size), np.clip(size, 1e-3, None), np.nan)
        places, values = thinned(x.places(frequencies), y.places(shown))
        chart.curve(places, values, INK, 1.2, dash=dash, clip=box)
    entries = [
        ("S at the measurements", INK, 1.2, ""),
        ("at the manipulated variables", INK, 1.2, _DASH),
    ]
    draw_legend(chart, _BAND[0] - 12.0, _TOP - 6.0, entries, 0.5 * SIZE)
