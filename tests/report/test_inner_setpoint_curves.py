"""Pictures of a cascade: the setpoint of its inner loop beside what that loop measures."""

import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.report.colours import INK
from clepsydra.report.inner_setpoint_curves import with_inner_panels, with_inner_setpoints
from clepsydra.report.panel_content import panel_content
from clepsydra.report.panels import all_panels
from clepsydra.report.recording import recording_of
from clepsydra.report.trends import trend_figure

NAME = "duty_flow.inner_setpoint"


@pytest.fixture
def run(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(flow_cascade(), encoding="utf-8")
    return cl.study(path).best.run


def test_a_picture_shows_it_dashed_beside_what_the_inner_loop_measures(run):
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
    legends = [axes.get_legend() for axes in trend_figure(run, panels).axes]
    words = [t.get_text() for legend in legends if legend for t in legend.get_texts()]
    assert "inner setpoint of duty_flow" in words
    # The panels of others are as they were.
    level = panel_content(panels[0], recording_of(run), run.time, INK)
    assert with_inner_setpoints(level, panels[0], run, run.time) is level
