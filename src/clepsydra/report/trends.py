"""Trend pictures: small multiples on one time axis, with the scenario above them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_type
from clepsydra.base.words import time_unit
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.process.process import Process
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.panel_axes import draw_panel
from clepsydra.report.panels import Panel, all_panels
from clepsydra.report.quantities import display_factor, fitted, sensor_scale, short_text, unit_text
from clepsydra.report.recording import Recording, recording_of
from clepsydra.studies.result import Candidate, StudyResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


#: Figure style. The font comes with Matplotlib, so that text has the same width everywhere.
STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "grid.color": "#e6e9ed",
    "grid.linewidth": 0.6,
    "hatch.linewidth": 0.4,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "legend.borderpad": 0.1,
    "legend.borderaxespad": 0.1,
    "legend.handlelength": 2.2,
    "legend.columnspacing": 1.6,
    "path.simplify": True,
    "text.color": INK,
    "text.parse_math": False,
    "xtick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.color": MUTED,
    "ytick.labelcolor": INK,
}

_WIDTH = 7.4
_LEFT, _RIGHT = 0.62, 0.6
_HEADER, _LEGEND, _FOOTER = 0.5, 0.27, 0.42
#: Height above the panels where there is no scenario, with and without events.
_EVENTS_HEADER, _NO_HEADER = 0.24, 0.1
#: Share of the width that the number of an event needs.
_NUMBER_WIDTH = 0.02


def trend_figure(run: Run | Simulation, panels: Sequence[Panel]) -> Figure:
    """Draw panels of a run above each other with a shared time axis.

    States are drawn in their display unit with percent of the range on the right, setpoints
    dashed, limits shaded; a bar on the time axis marks where a manipulated variable stands at a
    limit; the strip on top says what the scenario does. Vertical hairlines are events, numbered
    in order of time where there is room; one that happens often has one, with its count.

    Returns
    -------
    matplotlib.figure.Figure
        Without pyplot: it belongs to nobody but the caller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.report.panels import controlled_panels
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant))
    >>> len(trend_figure(run, controlled_panels(run)).axes)  # two panels and the strip above
    3
    """
    import matplotlib
    from matplotlib.figure import Figure

    recording = recording_of(run)
    unit, seconds = time_unit(recording.end - float(recording.time[0]))
    time = recording.time / seconds
    end = recording.end / seconds
    limits = (float(time[0]) - 0.012 * end, end)
    colours = signal_colours(run.process)
    header = _HEADER if recording.segments else _NO_HEADER
    if recording.marks:
        header += _EVENTS_HEADER
    height = header + sum(panel.height + _LEGEND for panel in panels) + _FOOTER
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(_WIDTH, height))
        top = height - header
        strips = []
        if recording.segments:
            strips.append(figure.add_axes(_box(height - _HEADER + 0.02, _HEADER - 0.06, height)))
            _draw_strip(strips[0], recording, seconds, limits)
        if recording.marks:
            strips.append(figure.add_axes(_box(top, _EVENTS_HEADER, height)))
            _draw_numbers(strips[-1], recording, seconds, limits)
        for axes in strips:
            axes.set(xlim=limits, ylim=(0.0, 1.0))
            axes.set_axis_off()
        first: Axes | None = None
        for panel in panels:
            top -= panel.height + _LEGEND
            axes = figure.add_axes(_box(top, panel.height, height), sharex=first)
            first = first or axes
            colour = colours.get(panel.signal.name, INK)
            draw_panel(axes, panel, recording, time, colour)
            for segment in recording.segments:
                axes.axvline(segment.start / seconds, color=MUTED, linewidth=0.5, alpha=0.6)
            _draw_hairlines(axes, recording, seconds)
            axes.tick_params(labelbottom=False)
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(f"time [{unit}]")
        axes.set_xlim(limits)
        figure.align_ylabels([entry for entry in figure.axes if entry not in strips])
    return figure


def segment_words(process: Process, segment: Segment) -> tuple[str, str, str]:
    """Return what happens in a segment: the kind, the signal and the size with its unit.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> segment_words(process, Segment("setpoint", "level_1", 0.0, 400.0, 0.5))
    ('setpoint', 'level_1', '+0.5 V = +1 cm')
    """
    if segment.kind == "noise":
        return "measurement", "noise", ""
    signal = process.signal(segment.signal)
    size = _signed(segment.size * display_factor(signal), signal.shown_unit)
    if segment.signal in process.measured_state:
        level = process.signal(process.measured_state[segment.signal])
        if level.shown_unit != signal.shown_unit:
            change = segment.size / sensor_scale(process, segment.signal).gain
            size += f" = {_signed(change * display_factor(level), level.shown_unit)}"
    return segment.kind, segment.signal, size


def _signed(value: float, unit: str) -> str:
    sign = "" if value < 0 else "+"
    return f"{sign}{short_text(value)} {unit_text(unit)}".strip()


def _box(bottom: float, axes_height: float, height: float) -> tuple[float, float, float, float]:
    width = (_WIDTH - _LEFT - _RIGHT) / _WIDTH
    return (_LEFT / _WIDTH, bottom / height, width, axes_height / height)


def _draw_strip(
    axes: Axes, recording: Recording, seconds: float, limits: tuple[float, float]
) -> None:
    """Write above the panels what happens when."""
    inches = (_WIDTH - _LEFT - _RIGHT) / (limits[1] - limits[0])
    for index, segment in enumerate(recording.segments):
        start, stop = segment.start / seconds, min(segment.stop / seconds, limits[1])
        axes.axvspan(start, stop, facecolor="#f0f2f5" if index % 2 == 0 else "#e4e8ed", lw=0)
        letters = max(int((stop - start) * inches / 0.062), 1)
        lines = [
            fitted(word, letters) for word in segment_words(recording.process, segment) if word
        ]
        axes.text(
            (start + stop) / 2.0, 0.5, "\n".join(lines), ha="center", va="center",
            fontsize=6.5, linespacing=1.15,
        )  # fmt: skip


def _draw_hairlines(axes: Axes, recording: Recording, seconds: float) -> None:
    if recording.marks:
        # In shares of the panel's height, so that the lines do not widen its range.
        axes.vlines(
            [mark.time / seconds for mark in recording.marks], 0.0, 1.0,
            transform=axes.get_xaxis_transform(), color=INK, linewidth=0.5, alpha=0.8, zorder=1.5,
        )  # fmt: skip


def _draw_numbers(
    axes: Axes, recording: Recording, seconds: float, limits: tuple[float, float]
) -> None:
    """Write above the panels the number of each event that has room."""
    _draw_hairlines(axes, recording, seconds)
    free = limits[0] - 1.0
    for number, mark in enumerate(recording.marks, 1):
        time, label = mark.time / seconds, mark.label(number)
        width = _NUMBER_WIDTH * (limits[1] - limits[0]) * max(1.0, len(label) / 2)
        if time - width / 2 >= free:
            axes.text(
                time, 0.5, label, ha="center", va="center", fontsize=6.5,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
            )  # fmt: skip
            free = time + width / 2


def plot(run: Run | Simulation) -> Figure:
    """Draw everything that a run recorded: states, manipulated variables, disturbances, events.

    Returns
    -------
    matplotlib.figure.Figure
        A notebook shows it; ``figure.savefig("run.pdf")`` writes it.

    Raises
    ------
    InputError
        It is no run; a whole study holds one for each controller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> step = [cl.step("level_1", "+0.5 V", at="10 s")]
    >>> figure = plot(cl.simulate(plant, cl.design.simc(plant), step, duration="1 min"))
    >>> len(figure.axes)  # the strip, four levels, two pumps
    7
    """
    remedy = "give one, as from Loop(controller, model).run(scenario)"
    if isinstance(run, StudyResult):
        remedy = "give result.ranking[0].run" if run.ranking else "no controller of it has a run"
    elif isinstance(run, Candidate):
        remedy = "give candidate.run"
    require_type(run, (Run, Simulation), "plot", "a Run or a Simulation", remedy)
    return trend_figure(run, all_panels(run))
