"""The setpoints of inner loops in trend pictures: dashed, beside what the inner loop measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from clepsydra.loop.inner_setpoints import InnerSetpoint, inner_setpoints
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.report.colours import INK
from clepsydra.report.panel_content import Curve, PanelContent
from clepsydra.report.panels import Panel
from clepsydra.report.quantities import display_factor, sensor_scale

#: Room above and below a curve, share of what is shown.
_MARGIN = 0.08


def with_inner_panels(panels: Sequence[Panel], run: Run) -> list[Panel]:
    """Return panels with one for each inner measurement, after those of the other states.

    A level that an inner loop measures has its panel already. The state of a sensor with a lag,
    a flow meter's say, gives way to the measurement, which is what the loop follows.

    Parameters
    ----------
    panels : sequence of Panel
    run : Run

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.report.panels import all_panels
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> with_inner_panels(all_panels(run), run) == all_panels(run)  # no cascade
    True
    """
    process, shown = run.process, list(panels)
    for name in dict.fromkeys(each.measurement for each in _of(run)):
        own = f"{name}.lagged"
        if any(panel.measurement == name and panel.signal.name != own for panel in shown):
            continue
        shown = [panel for panel in shown if panel.signal.name != own]
        states = [place for place, panel in enumerate(shown) if panel.kind in ("level", "state")]
        after = states[-1] + 1 if states else 0
        shown.insert(after, Panel("state", process.signal(name), 0.85))
    return shown


def with_inner_setpoints(
    content: PanelContent, panel: Panel, run: Run | Simulation, time: np.ndarray
) -> PanelContent:
    """Return what a panel shows with the inner setpoints of its measurement.

    Parameters
    ----------
    content : PanelContent
    panel : Panel
    run : Run or Simulation
        A simulation has none.
    time : ndarray [samples]
        In the unit of the time axis.

    Examples
    --------
    See `clepsydra.report.trends.trend_figure`.
    """
    if not isinstance(run, Run):
        return content
    curves = [
        _curve(each, panel, run, time)
        for each in _of(run)
        if each.measurement in (panel.measurement, panel.signal.name)
    ]
    if not curves:
        return content
    values = np.concatenate([curve.values for curve in curves])
    values = values[np.isfinite(values)]
    low, high = values.min(initial=content.bottom), values.max(initial=content.top)
    margin = _MARGIN * (high - low)
    return replace(
        content,
        curves=(*curves, *content.curves),
        bottom=float(content.bottom if low >= content.bottom else low - margin),
        top=float(content.top if high <= content.top else high + margin),
    )


def _of(run: Run) -> tuple[InnerSetpoint, ...]:
    found = inner_setpoints(run.controller, run.process)
    return tuple(each for each in found if each.name in run.values)


def _curve(each: InnerSetpoint, panel: Panel, run: Run, time: np.ndarray) -> Curve:
    values = run.values[each.name]
    if each.measurement == panel.measurement:
        values = sensor_scale(run.process, each.measurement).to_state(values)
    shown = values * display_factor(panel.signal)
    words = f"inner setpoint of {each.measurement}"
    return Curve(words, time, shown, INK, 0.9, dashed=True, held=True)
