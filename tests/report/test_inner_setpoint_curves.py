"""Pictures of a cascade: the setpoint of its inner loop beside what that loop measures."""

import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.report.recording import all_panels
from clepsydra.report.trends import plot

FLOW = "duty_flow"


@pytest.fixture
def run(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(flow_cascade(), encoding="utf-8")
    return cl.study(path).best.run


def test_a_picture_shows_it_dashed_beside_what_the_inner_loop_measures(run):
    names = [panel.signal.name for panel in all_panels(run)]
    assert FLOW in names and f"{FLOW}.lagged" not in names
    panels = dict(zip(names, plot(run).axes[-len(names) :], strict=True))
    axes = panels[FLOW]
    factor = {"l/s": 1e3, "m³/s": 1.0}[axes.get_ylabel()]
    (asked,) = [line for line in axes.lines if line.get_label() == f"inner setpoint of {FLOW}"]
    (flow,) = [line for line in axes.lines if line.get_label() == FLOW]
    assert asked.is_dashed() and not flow.is_dashed()
    values = asked.get_ydata()
    assert values == pytest.approx(factor * run.values[f"{FLOW}.inner_setpoint"])
    assert flow.get_ydata() == pytest.approx(factor * run.values[FLOW])
    bottom, top = axes.get_ylim()
    assert bottom < values.min() and values.max() < top
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == [FLOW, f"inner setpoint of {FLOW}"]
    for name in names:
        if name != FLOW:
            legend = panels[name].get_legend().get_texts()
            assert not any("inner" in words.get_text() for words in legend)
