"""The still picture of a study: what it says, that words have room, and what it is made without."""

import re
import subprocess
import sys
from itertools import combinations
from xml.etree import ElementTree

import pytest
from drawn import SVG, overlap, width

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.report.overlay import event_windows, shown_signals
from clepsydra.report.overlay_picture import overlay_svg

TITLE = "What <two> controllers make of it"


def picture_of(result):
    signals, first = shown_signals(result), list(result.ranking[:2])
    windows = event_windows(result, signals, first)
    return ElementTree.fromstring(overlay_svg(windows, signals, first, TITLE))


def words_of(root):
    return list(root.iter(f"{SVG}text"))


def box_of(text, letters):
    """Where words stand in the picture, in the widest font that they may be shown in."""
    size = float(text.get("font-size", letters))
    long = width(text.text, size, bold=False)
    begin = -long * {"start": 0.0, "middle": 0.5, "end": 1.0}[text.get("text-anchor")]
    if turned := text.get("transform"):
        x, y = map(float, re.match(r"translate\((\S+) (\S+)\) rotate\(-90\)", turned).groups())
        return (x - 0.74 * size, y - begin - long, x + 0.22 * size, y - begin)
    x, y = float(text.get("x")) + begin, float(text.get("y"))
    return (x, y - 0.74 * size, x + long, y + 0.22 * size)


def test_it_says_what_happens_who_answers_and_in_which_units(result):
    root = picture_of(result)
    assert root[0].text == TITLE
    said = [text.text for text in words_of(root)]
    assert [words for words in said if words.startswith("Setpoint")] == [
        "Setpoint level_1 +2 cm", "Setpoint level_2 +2 cm"
    ]  # fmt: skip
    assert sum(words.startswith("time after the event [") for words in said) == 3
    assert said[-2:] == ["PI, phase margin", "PI, <SIMC> & detuned"]
    assert (said.count("[cm]"), said.count("[V]")) == (2, 1)


@pytest.mark.parametrize("process", catalogue_names())
def test_no_words_stand_over_others_or_beyond_the_picture(process):
    plant = cl.load(process)
    simc = cl.design.simc(plant)
    other = simc.with_values({}, name="PI by a rule whose name is longer than its place is wide")
    root = picture_of(cl.study(plant, [simc, other]))
    _, _, wide, high = map(float, root.get("viewBox").split())
    boxes = {text: box_of(text, root.get("font-size")) for text in words_of(root)}
    for text, (left, top, right, bottom) in boxes.items():
        assert left >= 0.0 and top >= 0.0 and right <= wide and bottom <= high, text.text
    for one, other in combinations(boxes, 2):
        assert not overlap(boxes[one], boxes[other]), (one.text, other.text)


def test_a_report_loads_no_library_of_pictures(tmp_path):
    script = """
import sys
import clepsydra as cl
plant = cl.load("quadruple-tank")
cl.study(plant, [cl.design.simc(plant)]).report(sys.argv[1])
print("matplotlib" in sys.modules)
"""
    command = [sys.executable, "-c", script, str(tmp_path / "report.html")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
    assert "</svg>" in (tmp_path / "report.html").read_text(encoding="utf-8")
