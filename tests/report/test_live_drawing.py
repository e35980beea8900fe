"""The drawing of a page that moves it says of everything what it is."""

import re

import pytest
from drawn_plants import CHAINS, FILES, PLANTS, loaded

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.drawing.scene import LONG_FLOW, LONG_STATE

SHORT = ["quadruple-tank", "wet-well", "splitter behind a splitter", "many-shapes"]
EVERY = [
    name if name in SHORT else pytest.param(name, marks=pytest.mark.thorough)
    for name in (*catalogue_names(), *PLANTS, *CHAINS, *FILES)
]


@pytest.fixture(params=EVERY)
def alive(request, tmp_path):
    process = loaded(request.param, tmp_path)
    return process, process_drawing(process, find_equilibrium(process), alive="rig-0")


def process_names(process):
    return {element.name for element in process.elements}


def told(drawing, *names):
    """Return the attributes of each element that has all of them."""
    tags = re.findall(r"<\w+ [^>]*>", drawing)
    found = [dict(re.findall(r'data-(\w+)="([^"]*)"', tag)) for tag in tags]
    return [each for each in found if all(name in each for name in names)]


def test_every_pipe_carries_a_flow_of_the_plant(alive):
    process, drawing = alive
    pipes = told(drawing, "pipe", "from", "to")
    paths = process.motion.flow_paths
    for pipe in pipes:
        of, begins, ends = pipe["pipe"], pipe["from"], pipe["to"]
        assert any(
            path.element == of and begins in (of, path.source) and ends in (of, path.destination)
            for path in paths
        ), pipe
    drawn = {pipe["pipe"] for pipe in pipes}
    assert {path.element for path in paths if path.element in process_names(process)} <= drawn


def test_numbers_have_a_place_and_only_known_words(alive):
    process, drawing = alive
    values = [each["value"] for each in told(drawing, "value")]
    assert set(process.levels) <= set(values)
    moved = {u.name for u in process.inputs if u.name in process_names(process)}
    assert moved <= set(values)
    states = {each["state"] for each in told(drawing, "state")}
    assert states == {*process.levels, *moved}
    for mark in ("pour", "extra", "spills"):
        assert [f"{each[mark]}.level" for each in told(drawing, mark)] == list(process.levels)
    assert LONG_FLOW not in drawing
    assert LONG_STATE not in drawing
