from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from written_plants import plant_of

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_file
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.recording import all_panels, controlled_panels
from clepsydra.report.trends import plot, segment_words, trend_figure


def panel_axes(figure, run):
    """The axes of each panel by signal name; the first axes are the strip on top."""
    panels = all_panels(run)
    return {panel.signal.name: axes for panel, axes in zip(panels, figure.axes[1:], strict=False)}


@pytest.fixture(scope="module")
def figure(run):
    return plot(run)


def line_of(axes, colour):
    return max(
        (line for line in axes.lines if line.get_color() == colour),
        key=lambda line: len(line.get_xdata()),
    )


def test_levels_are_drawn_in_centimetres_over_minutes(figure, run):
    axes = panel_axes(figure, run)["tank_1.level"]
    line = line_of(axes, signal_colours(run.process)["tank_1.level"])
    assert np.allclose(line.get_ydata(), run.values["tank_1.level"] * 100, rtol=1e-12)
    assert np.allclose(line.get_xdata(), run.time / 60)
    assert axes.get_ylabel() == "cm"


def test_setpoints_are_dashed_and_stand_where_the_sensor_would_read_them(figure, run):
    axes = panel_axes(figure, run)["tank_2.level"]
    (line,) = [entry for entry in axes.lines if entry.get_color() == INK]
    # 0.5 V/cm, so twice as many centimetres as volts.
    assert np.allclose(line.get_ydata(), 2 * run.values["level_2.setpoint"], rtol=1e-12)
    assert line.is_dashed()


def test_the_right_axis_shows_percent_of_the_tank(figure, run):
    axes = panel_axes(figure, run)["tank_1.level"]
    (percent,) = axes.child_axes
    figure.draw_without_rendering()
    assert np.allclose(np.array(percent.get_ylim()), np.array(axes.get_ylim()) * 5)


def test_a_level_beyond_the_rim_is_not_cut_off():
    # 0.05 m³/s more than flows out, on 1 m², from 2 m: 5.5 m after 70 s, in a tank of 4 m.
    more = [cl.step("inflow", to="0.25 m^3/s", at="10 s")]
    flood = cl.simulate(cl.load("averaging-tank"), None, more, duration="80 s")
    axes = trend_figure(flood, all_panels(flood)).axes[0]
    assert flood.values["tank.level"][-1] == pytest.approx(5.5)
    assert axes.get_ylim()[1] > 5.5
    (rim,) = [line for line in axes.lines if list(line.get_ydata()) == [4.0, 4.0]]
    assert rim.get_linewidth() < 1.0


def test_of_an_averaging_level_the_outflow_comes_first_and_the_band_is_lines():
    plant = cl.load(Path(__file__).parents[2] / "docs" / "examples" / "surge-drum.toml")
    run = cl.simulate(plant, cl.design.arrest_time(plant))
    first, level, *others = all_panels(run)
    assert (first.signal.name, level.signal.name) == ("outflow", "drum.level")
    assert [each.name for each in first.beside] == ["feed"] and others == []
    _, flow, drum = trend_figure(run, [first, level]).axes
    colours = signal_colours(plant.process)
    drawn = line_of(flow, colours["outflow"]), line_of(flow, MUTED)
    for line, name in zip(drawn, ("outflow", "feed"), strict=True):
        assert np.allclose(line.get_ydata(), 3600.0 * run.values[name], rtol=1e-9), name
    solid = [x for x in drum.lines if x.get_color() == INK and not x.is_dashed()]
    ends = [set(np.round(x.get_ydata(), 9)) for x in solid]  # 30 and 70 % of 2 m
    assert ends == [{0.6}, {1.4}]
    names = [text.get_text() for text in drum.get_legend().get_texts()]
    assert names.count("band") == 1


def test_manipulated_variables_are_held_between_samples_and_show_their_whole_range(figure, run):
    axes = panel_axes(figure, run)["pump_1"]
    line = line_of(axes, signal_colours(run.process)["pump_1"])
    assert line.get_drawstyle() == "steps-post"
    bottom, top = axes.get_ylim()
    assert bottom < 0.0 < 10.0 < top


def test_saturation_is_marked_exactly_where_a_pump_stands_at_a_limit(figure, run):
    axes = panel_axes(figure, run)["pump_1"]
    volts = run.values["pump_1"]
    bars = [
        (patch.get_x(), patch.get_x() + patch.get_width())
        for patch in axes.patches
        if patch.get_facecolor() == matplotlib.colors.to_rgba(INK)
    ]
    marked = np.zeros(len(volts), bool)
    for start, stop in bars:
        marked |= (run.time / 60 >= start - 1e-9) & (run.time / 60 < stop - 1e-9)
    assert 0 < marked.sum() < len(volts)
    assert np.array_equal(marked, (volts == 0.0) | (volts == 10.0))
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert f"at a limit for {marked.sum()} s" in words


def test_a_run_away_from_its_limits_has_no_marks(result):
    run = result.ranking[0].run
    axes = panel_axes(plot(run), run)["pump_1"]
    assert not [p for p in axes.patches if p.get_facecolor() == matplotlib.colors.to_rgba(INK)]


def test_beyond_the_limits_is_hatched_and_a_rim_out_of_view_is_named(figure, run):
    pump, tank = (panel_axes(figure, run)[name] for name in ("pump_1", "tank_1.level"))
    zones = [patch.get_bbox() for patch in pump.patches if patch.get_hatch()]
    bottom, top = pump.get_ylim()
    assert sorted((zone.ymin, zone.ymax) for zone in zones) == [(bottom, 0.0), (10.0, top)]
    assert "rim 20 cm ↑" in [text.get_text() for text in tank.texts]


def test_measured_values_are_drawn_only_where_there_is_noise(figure, run):
    axes = panel_axes(figure, run)["tank_3.level"]
    measured = min(axes.lines, key=lambda line: line.get_linewidth())
    assert measured.get_xdata()[0] * 60 == pytest.approx(run.scenario.segments[-1].start)
    noise = measured.get_ydata() - 100 * run.values["tank_3.level"][-len(measured.get_ydata()) :]
    assert np.allclose(noise, 2 * run.scenario.noise[-len(noise) :, 2])


def test_the_strip_names_every_segment_with_its_size(figure, run):
    words = [text.get_text() for text in figure.axes[0].texts]
    assert words[0] == "setpoint\nlevel_1\n+1 V = +2 cm"
    assert words[5] == "load\ninflow_2\n+1.5 cm³/s"
    assert len(words) == len(run.scenario.segments)


def test_a_step_down_has_its_sign(run):
    assert segment_words(run.process, run.scenario.segments[1])[2] == "−1 V = −2 cm"


def test_all_panels_share_their_time_axis(figure, run):
    assert len({axes.get_xlim() for axes in figure.axes}) == 1
    assert all(not axes.get_xlabel() for axes in figure.axes[:-1])
    assert figure.axes[-1].get_xlabel() == "time [min]"


def test_disturbances_that_never_act_take_no_room(run):
    quiet = {name: np.zeros_like(run.time) for name in ("inflow_1", "inflow_2")}
    still = replace(run, values=run.values | quiet)
    kinds = [panel.kind for panel in all_panels(still)]
    assert "disturbance" not in kinds
    assert kinds.count("level") == 4


def test_a_run_that_broke_down_is_still_drawn(run):
    broken = run.values["tank_1.level"].copy()
    broken[100:] = np.nan
    figure = trend_figure(
        replace(run, values=run.values | {"tank_1.level": broken}), controlled_panels(run)
    )
    figure.draw_without_rendering()
    bottom, top = figure.axes[1].get_ylim()
    assert np.isfinite(bottom) and bottom < top


def test_drawing_leaves_the_settings_of_the_caller_alone(run):
    before = dict(matplotlib.rcParams)
    plot(run)
    assert dict(matplotlib.rcParams) == before


@pytest.mark.thorough
def test_long_names_leave_room_for_the_name_of_a_limit(tmp_path):
    text = catalogue_file("quadruple-tank").read_text("utf-8")
    for short in ("tank_1", "level_1"):
        text = text.replace(short, f"{short}_of_the_second_condensate_line_N")
    plant = plant_of(tmp_path, text)
    run = cl.simulate(plant, cl.design.simc(plant))
    figure = trend_figure(run, controlled_panels(run))
    renderer = FigureCanvasAgg(figure).get_renderer()
    axes = next(entry for entry in figure.axes if entry.get_legend())
    entries = axes.get_legend().get_texts()
    assert len(entries) == 3 and all("…" in entry.get_text() for entry in entries)
    (limit,) = [words for words in axes.texts if words.get_text().startswith("rim")]
    assert axes.get_legend().get_window_extent(renderer).x1 < limit.get_window_extent(renderer).x0
