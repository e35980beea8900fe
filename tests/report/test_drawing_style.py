"""Drawings are readable on a light page and on a dark one, and grey where all is normal."""

import colorsys
import re
from itertools import product
from textwrap import dedent

import pytest
from drawn import SVG, Drawn

import clepsydra as cl
from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing.block_picture import program_svg
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.drawing.shapes import ALARM, FRAME, PAPER, PIPE, STEEL, TINTS, colour_style

TANK = """
name = "tank"
sampling_period = "1 s"
controlled = ["level"]
[reservoirs.basin]
[tanks.vessel]
area = "1 m^2"
height = "1 m"
[sensors.level]
tank = "vessel"
range = ["0 m", "1 m"]
tag = "LIC_4711"
[orifices.hole]
source = "vessel"
destination = "basin"
area = "10 cm^2"
[pumps.feed]
source = "basin"
destination = "vessel"
gain = "1 l/(s V)"
range = ["0 V", "10 V"]
nominal = "2 V"
tag = "P4711"
"""
PAIRS = dict(re.findall(r"fill:light-dark\((#\w{6}),(#\w{6})\)", colour_style("a")))


def luminance(colour):
    """The relative luminance of WCAG 2.2."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return sum(w * p for w, p in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one, other):
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("page", ["light", "dark"])
def test_words_and_lines_have_their_contrast(page):
    seen = {light: light if page == "light" else dark for light, dark in PAIRS.items()}
    words = [*product((INK, MUTED, ALARM), (PAPER, STEEL)), *product((INK, ALARM), TINTS)]
    for colour, behind in words:
        assert contrast(seen[colour], seen[behind]) >= 4.5, (colour, behind)
    lines = [*product((INK, MUTED, PIPE, FRAME), (PAPER, STEEL)), *product((INK, PIPE), TINTS)]
    for colour, behind in lines:
        assert contrast(seen[colour], seen[behind]) >= 3.0, (colour, behind)


def pictures():
    plant = cl.load("quadruple-tank")
    controller = cl.design.simc(plant)
    yield process_drawing(plant.process, plant.point, controller)
    yield process_drawing(cl.load("averaging-tank").process, None)
    yield program_svg(controller.program(), "blocks")


def colours(picture):
    shapes = re.sub(r"<style>.*?</style>", "", picture)
    return set(re.findall(r'(?:fill|stroke)="(#\w+)"', shapes))


def test_no_colour_stays_the_same_in_the_dark():
    for picture in pictures():
        used = colours(picture)
        assert used <= PAIRS.keys() and PAPER in used


def colourfulness(colour):
    return colorsys.rgb_to_hls(*(int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)))[2]


def test_a_plant_is_grey_where_all_is_normal_and_water_is_of_one_tint():
    plant = cl.load("quadruple-tank")
    picture = process_drawing(plant.process, plant.point, cl.design.simc(plant))
    used = colours(picture) - {TINTS[0]}
    assert max(map(colourfulness, used)) < 0.3 < colourfulness(ALARM)
    waters = [path.get("fill") for path in Drawn(picture).root.iter(f"{SVG}path")
              if path.get("class") == "water"]  # fmt: skip
    assert waters == 4 * [TINTS[0]]


def test_what_is_at_the_end_of_its_range_is_coloured_and_said(tmp_path):
    path = tmp_path / "tank.toml"
    for range_, count in (("10 V", 0), ("2 V", 1)):
        path.write_text(TANK.replace("10 V", range_), encoding="utf-8")
        plant = cl.load(path)
        words = Drawn(process_drawing(plant.process, plant.point)).words
        found = [(text.text, text.get("fill")) for text, _ in words]
        assert found.count(("at its highest", ALARM)) == count


def test_a_meter_of_a_pump_that_stands_still_shows_nothing_abnormal(tmp_path):
    spare = """
        [pumps.spare]
        source = "basin"
        destination = "vessel"
        gain = "1 l/(s V)"
        range = ["0 V", "10 V"]
        nominal = "0 V"
        [sensors.spare_flow]
        flow = "spare"
        lag = "2 s"
        range = ["0 l/s", "10 l/s"]
        """
    path = tmp_path / "tank.toml"
    path.write_text(TANK + dedent(spare), encoding="utf-8")
    plant = cl.load(path)
    assert plant.point.as_dict()["spare_flow"] == 0.0
    words = [text.text for text, _ in Drawn(process_drawing(plant.process, plant.point)).words]
    assert "spare_flow" in words and "at its lowest" not in words


def test_a_stopped_pump_looks_stopped():
    plant = cl.load("wet-well")
    root = Drawn(process_drawing(plant.process, plant.point)).root
    found = {
        group[0].text.split(",")[0].split()[-1]: (group[0].text, group[2].get("fill"))
        for group in root.iter(f"{SVG}g")
        if group[0].tag == f"{SVG}title" and group[0].text.startswith("pump ")
    }
    assert found == {
        "duty": ("pump duty, 69.6 %", PIPE),
        "standby": ("pump standby, stopped, set to 100 %", PAPER),
    }


def test_a_tag_of_the_file_is_the_number_of_the_loop(tmp_path):
    path = tmp_path / "tank.toml"
    path.write_text(TANK, encoding="utf-8")
    plant = cl.load(path)
    drawn = Drawn(process_drawing(plant.process, plant.point, cl.design.simc(plant)))
    words = [text.text for text, _ in drawn.words]
    assert words.count("4711") == 2 and {"LT", "LIC", "level", "P4711"} <= set(words)
    assert "pump feed (P4711), 2.00 V, 20 %" in {t.text for t in drawn.root.iter(f"{SVG}title")}
