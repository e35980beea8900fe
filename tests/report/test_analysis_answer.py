"""What an analysis says first, and what on request."""

import io

import pytest
from rich.console import Console

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.report.screen import Screen


def screen(analysis, width, **more):
    stream = io.StringIO()
    Console(file=stream, width=width).print(Screen(analysis.answer(**more)))
    return [line.rstrip() for line in stream.getvalue().splitlines()]


@pytest.mark.parametrize("width", [80, 100])
@pytest.mark.parametrize("name", catalogue_names())
def test_the_analysis_of_every_process_answers_in_a_screen(name, width):
    plant = cl.load(name)
    lines = screen(plant.analysis, width)
    assert len(lines) <= 25 and max(map(len, lines)) <= width
    for signal in (*plant.process.controlled, *(each.name for each in plant.process.inputs)):
        assert any(line.startswith(f"{signal} ") for line in lines)
    for output, moved in plant.analysis.pairing:
        assert any(line.startswith(f"{output} by {moved} ") for line in lines)
    assert lines[-1].startswith("Next: clepsydra study ")


def test_what_is_left_out_is_counted_and_shown_on_request():
    analysis = cl.load("quadruple-tank-nonminimum-phase").analysis
    short, whole = screen(analysis, 100), " ".join(screen(analysis, 100, every=True))
    assert "2 more to know, and every signal, pole, zero and gain: --all" in short
    assert all(" ".join(words.split()) in " ".join(whole.split()) for words in analysis.words)
    assert "tank_3.level" in whole and "tank_3.level" not in " ".join(short)
    assert "--all" not in whole


def test_equal_time_constants_are_told_once():
    assert "Its 8 time constants are 120 s." in cl.load("eight-tanks").analysis.words


def test_what_a_valve_cannot_give_stands_first(tmp_path):
    """A feed of 10 kg/s of water and a valve that gives 8.8 m³/h at 1 m: a load of 3 more."""
    path = tmp_path / "tank.toml"
    path.write_text(
        """
name = "tank"
sampling_period = "10 s"
controlled = ["LT1"]
[reservoirs.sump]
[tanks.T]
area = "1 m^2"
height = "2 m"
[flows.feed]
destination = "T"
range = ["0 m^3/h", "12 m^3/h"]
nominal = "6 m^3/h"
step = "4 m^3/h"
[valves.LV]
source = "T"
destination = "sump"
kv = "28 m^3/h"
range = ["0 %", "100 %"]
[sensors.LT1]
tank = "T"
range = ["0 m", "2 m"]
[operating_point]
LT1 = "1 m"
""",
        encoding="utf-8",
    )
    plant = cl.load(path)
    # 28 m³/h √(9.81 · 1 m/100) = 8.77 m³/h.
    words = "LV gives at most 8.77 m³/h, and 10 m³/h are needed to hold the load step of feed by 4"
    first = cl.analyse(plant).answer().parts[0]
    assert first.text.startswith(words)
    verdict = cl.study(plant, [cl.design.simc(plant)]).verdict
    assert verdict.startswith(words)
