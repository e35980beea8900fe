"""One percent for all that shows a signal: that of its sensor, whose reading the setpoint is."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.report.analysis_pictures import nyquist_figure
from clepsydra.report.analysis_tables import operating_point_grid
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.quantities import percent_scale
from clepsydra.report.recording import all_panels, recording_of
from clepsydra.report.trends import plot

PLANT = """
name = "brine"
sampling_period = "2 s"
controlled = ["{controlled}"]
manipulated = ["{manipulated}"]
[components.salt]
range = ["2 g/l", "32 g/l"]
[reservoirs.basin]
[tanks.tank]
area = "0.5 m^2"
height = "1 m"
[orifices.hole]
source = "tank"
destination = "basin"
area = "10 cm^2"
[flows.brine]
destination = "tank"
range = ["0 l/min", "200 l/min"]
nominal = "100 l/min"
concentration.salt = "26 g/l"
[flows.water]
destination = "tank"
range = ["0 l/min", "200 l/min"]
nominal = "84.61538461538461 l/min"
concentration.salt = "2 g/l"
{sensors}
"""
SALINITY = """
[sensors.salinity]
tank = "tank"
component = "salt"
range = ["0 g/l", "50 g/l"]
lag = "5 s"
"""
#: 0 to 100 % are 10 to 60 cm, and it goes on to 120 %.
LEVEL = """
[sensors.level]
tank = "tank"
span = ["10 cm", "70 cm"]
range = ["0 %", "120 %"]
"""
#: A level of 0.4825 m in percent of those 50 cm.
AT_REST = (0.4825 - 0.1) / 0.5 * 100.0


def line_through(places, values):
    """Two points far out on the line through two others."""
    slope = (values[1] - values[0]) / (places[1] - places[0])
    far = (places[0] - 1000.0, places[0] + 1000.0)
    return far, (values[0] - 1000.0 * slope, values[0] + 1000.0 * slope)


@pytest.fixture
def made(tmp_path):
    """Return a function that makes the plant with these sensors and roles of its signals."""

    def make(sensors, controlled="salinity", manipulated="brine"):
        path = tmp_path / "brine.toml"
        roles = {"controlled": controlled, "manipulated": manipulated}
        path.write_text(PLANT.format(sensors=sensors, **roles), encoding="utf-8")
        return cl.load(path)

    return make


@pytest.fixture
def plant(made):
    return made(SALINITY + LEVEL)


def test_a_table_says_the_percent_of_the_sensor(plant):
    """An analyser of 0 to 50 g/l in 15 g/l shows 30 %, whatever the range of the component."""
    grid = operating_point_grid(plant.point)
    shown = {name: percent for name, _, percent in grid.rows}
    for name in ("tank.salt", "salinity.lagged", "salinity"):
        assert shown[name] == "30.0 %"
    assert shown["tank.level"] == shown["level"] == f"{AT_REST:.1f} %"
    assert shown["brine"] == "50.0 %"


def test_an_axis_and_its_limits_are_those_of_the_sensor(plant):
    more = [cl.step("brine", to="160 l/min", at="60 s")]
    run = cl.simulate(plant, None, more, duration="6 min")
    figure = plot(run)
    figure.draw_without_rendering()
    panels = {
        each.signal.name: axes for each, axes in zip(all_panels(run), figure.axes, strict=True)
    }

    def percent(name):
        """The values at 0 and 100 % of the axis on the right."""
        own, (other,) = panels[name].get_ylim(), panels[name].child_axes
        return np.interp((0.0, 100.0), *line_through(other.get_ylim(), own))

    for name in ("tank.salt", "salinity.lagged"):
        assert percent(name) == pytest.approx((0.0, 50.0), abs=1e-9)
        assert [words.get_text() for words in panels[name].texts] == ["top of range 50 g/l ↑"]
    low, high = percent("tank.level")
    assert (low, high) == pytest.approx((0.1, 0.6))  # [m]
    assert [words.get_text() for words in panels["tank.level"].texts] == ["rim 1 m ↑"]
    axis = 100.0 * (run.values["tank.level"] - low) / (high - low)
    within = axis < 120.0
    assert np.allclose(axis[within], 100.0 * run.values["level"][within])
    assert np.all(run.values["level"][~within] == 1.2)


def test_a_drawing_says_the_percent_of_the_sensor_and_fills_the_tank_to_its_level(plant):
    svg = process_drawing(plant.process, plant.point)
    assert f"tank: level 0.483 m of 1.00 m, {AT_REST:.1f} %" in svg


def test_the_controlled_sensor_of_several_decides(made):
    second = SALINITY.replace("salinity", "trace").replace("50 g/l", "20 g/l")
    plant = made(second + SALINITY + LEVEL)
    assert percent_scale(plant.process, "tank.salt") == pytest.approx((0.0, 50.0))


def test_a_locus_is_in_the_percent_of_the_sensor(made):
    """A range that goes on to 120 % is no other percent: the locus is the same."""
    loci = []
    for span, most in (("60 cm", "100 %"), ("70 cm", "120 %")):
        level = LEVEL.replace("70 cm", span).replace("120 %", most)
        (axes,) = nyquist_figure(made(SALINITY + level, "level").analysis).axes
        assert axes.get_xlabel() == "real part [% per %]", span
        loci.append(max(axes.lines, key=lambda line: abs(line.get_xdata()[0])).get_xdata())
    assert loci[0] == pytest.approx(loci[1])


def test_a_picture_shows_a_manipulated_flow_as_it_runs(made):
    """An outflow that is asked for and not there, since its tank is empty, reads nothing."""
    more = """
[flows.outflow]
source = "tank"
range = ["0 l/min", "300 l/min"]
nominal = "20 l/min"
"""
    sensors = SALINITY + LEVEL.replace("10 cm", "0 cm") + more
    plant = made(sensors, "level", "outflow")
    model = plant.linear
    nothing = np.zeros((300, 2))
    disturbances = np.tile(model.point.disturbances, (300, 1)) * np.linspace(1, 0, 300)[:, None]
    setpoints = np.full((300, 1), 0.0)
    run = Loop(cl.design.simc(plant), model).run(
        Scenario(2.0, setpoints, disturbances, nothing, (), 1)
    )
    draws = run.values["outflow.draws"] > 0.5
    shown = recording_of(run).values["outflow"]
    assert 0.0 < np.mean(draws) < 1.0 and np.any(run.values["outflow"][~draws] > 0.0)
    assert np.array_equal(shown, np.where(draws, run.values["outflow"], 0.0))
