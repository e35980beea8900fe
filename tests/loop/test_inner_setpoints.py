"""The setpoint that a cascade gives to its inner loop: recorded, counted, and told."""

import numpy as np
import pandas
import pytest

from clepsydra.linear.linearise import linearise
from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.loop import Loop
from clepsydra.loop.parquet import write_parquet
from clepsydra.report.colours import INK
from clepsydra.report.inner_setpoint_curves import with_inner_panels, with_inner_setpoints
from clepsydra.report.panel_content import panel_content
from clepsydra.report.panels import all_panels
from clepsydra.report.recording import recording_of
from clepsydra.report.trend_svg import trend_svg
from clepsydra.report.trends import trend_figure
from clepsydra.studies.file.reader import read_study
from clepsydra.studies.trial import scores_of
from clepsydra.studies.warnings.inner_setpoint import inner_setpoint_warnings

# The gain of the outer loop, 3 % of 60 l/s for 1 % of 16 mA [m³/(s A)].
GAIN = -3.0 * 0.06 / 0.016
NAME = "duty_flow.inner_setpoint"


def study(high: str = "35 l/s", by: str = "5 %", noise: str = "false") -> str:
    return f"""
process = "wet-well:flow-meters"
[scenario]
duration = "20 min"
noise = {noise}
[[scenario.setpoint]]
signal = "level"
at = "2 min"
by = "{by}"
[controllers.cascade.loops.level]
measurement = "level"
output = "flow.setpoint"
actions = "P"
action = "direct"
gain = "3 %/%"
[controllers.cascade.loops.flow]
measurement = "duty_flow"
output = "duty"
actions = "PI"
action = "reverse"
gain = "0.3 %/%"
integral_time = "6 s"
setpoint_high = "{high}"
"""


@pytest.fixture
def cascade(tmp_path):
    def run(solver="kernel", **words):
        path = tmp_path / "study.toml"
        path.write_text(study(**words), encoding="utf-8")
        found = read_study(path)
        controller = found.controllers[0].make(
            found.analysis, linearise(found.analysis.operating_point)
        )
        loop = Loop(controller, linearise(found.analysis.operating_point))
        return loop.run(found.scenario, solver=solver)

    return run


@pytest.mark.thorough
def test_it_is_what_the_outer_loop_asks_for_in_the_same_sample(cascade):
    run, quiet = cascade(noise="true"), cascade()
    rest = quiet.values[NAME][0]
    assert rest == pytest.approx(quiet.values["duty_flow"][0], rel=1e-12)
    asked = rest + GAIN * (run.values["level.setpoint"] - run.values["level"])
    assert run.values[NAME] == pytest.approx(np.clip(asked, 0.0, 0.035), abs=1e-12)
    assert np.ptp(run.values[NAME]) > 1e-3
    # Up by 5 %, which the pump answers by less flow.
    step = round(120.0 / run.scenario.sampling_period)
    assert run.values[NAME][step] < run.values[NAME][step - 1] - 5e-3


@pytest.mark.thorough
def test_both_solvers_record_it_and_it_stands_in_the_table(cascade, tmp_path):
    kernel, reference = cascade(), cascade(solver="reference")
    assert kernel.values[NAME] == pytest.approx(reference.values[NAME], abs=1e-8)
    (signal,) = [s for s in kernel.signals if s.name == NAME]
    assert (signal.unit, signal.high) == ("m^3/s", 0.06)
    write_parquet([kernel], tmp_path / "run.parquet")
    table = pandas.read_parquet(tmp_path / "run.parquet")
    assert np.array_equal(table[NAME], kernel.values[NAME])


@pytest.mark.parametrize(("by", "end"), [("-9 %", "high"), ("45 %", "low")])
def test_a_cascade_that_saturates_at_its_inner_setpoint_is_told(cascade, by, end):
    """Down by 9 % at 3 %/% asks for 16 l/s more than at rest, where the limit allows no more than
    a little; up by 45 % for no flow, while the inflow fills the well."""
    run = cascade(by=by, high="21 l/s")
    (inner,) = inner_setpoints(run.controller, run.process)
    assert (inner.low, inner.high) == (0.0, pytest.approx(0.021))
    values = run.values[NAME]
    limit = getattr(inner, end)
    stood = np.sum(np.abs(values - limit) < 1e-12)
    period = run.scenario.sampling_period
    assert scores_of(run)["time_at_setpoint_limit[duty_flow]"] == stood * period
    share = stood / values.size
    words = inner_setpoint_warnings(run)
    shown = "21 l/s" if end == "high" else "0 l/s"
    assert share > 0.5
    assert words == [
        f"The inner setpoint of duty_flow stands at a limit for {100 * share:.0f} % of the time, "
        f"mostly at its {end} limit of {shown}: the outer loop controls nothing for most of it; "
        f"widen setpoint_{end} of the inner loop, or ask for less."
    ]


def test_a_cascade_with_room_is_not(cascade):
    run = cascade()
    assert inner_setpoint_warnings(run) == []
    assert scores_of(run)["time_at_setpoint_limit[duty_flow]"] == 0.0


def test_a_picture_shows_it_dashed_beside_what_the_inner_loop_measures(cascade):
    run = cascade()
    panels = with_inner_panels(all_panels(run), run)
    names = [panel.signal.name for panel in panels]
    assert "duty_flow" in names and "duty_flow.lagged" not in names
    assert set(names) - {"duty_flow"} == {p.signal.name for p in all_panels(run)} - {
        "duty_flow.lagged"
    }
    panel = panels[names.index("duty_flow")]
    content = panel_content(panel, recording_of(run), run.time, "#0072B2")
    shown = with_inner_setpoints(content, panel, run, run.time)
    (curve,) = [curve for curve in shown.curves if curve.dashed]
    factor = {"l/s": 1e3, "m³/s": 1.0}[shown.unit]
    assert curve.values == pytest.approx(factor * run.values[NAME])
    assert shown.main.values == pytest.approx(factor * run.values["duty_flow"])
    assert shown.bottom < curve.values.min() and curve.values.max() < shown.top
    text = trend_svg(run, panels, "all", "a")
    assert text.count("inner setpoint of duty_flow") == 1
    legends = [axes.get_legend() for axes in trend_figure(run, panels).axes]
    words = [t.get_text() for legend in legends if legend for t in legend.get_texts()]
    assert "inner setpoint of duty_flow" in words
    # The panels of others are as they were.
    level = panel_content(panels[0], recording_of(run), run.time, INK)
    assert with_inner_setpoints(level, panels[0], run, run.time) is level
