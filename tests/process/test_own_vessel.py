"""A vessel of one's own is a vessel by what it says it stores, however it is drawn."""

from pathlib import Path

import pytest

import clepsydra as cl

VESSEL = """
from clepsydra.process.elements.tank import Tank

class Pond(Tank):
    kind, table, symbol, place = "pond", "ponds", "{symbol}", 50
"""
ONE_TANK = (Path(__file__).parents[1] / "one-tank.toml").read_text(encoding="utf-8")


@pytest.fixture(params=["box", "tank", "reservoir"])
def pond(request, tmp_path):
    """One tank, written as an own element that is drawn by some symbol."""
    (tmp_path / "pond.py").write_text(VESSEL.format(symbol=request.param), "utf-8")
    text = ONE_TANK.replace("[reservoirs", 'elements = "pond.py"\n[reservoirs', 1)
    (tmp_path / "plant.toml").write_text(text.replace("[tanks.", "[ponds."), "utf-8")
    return cl.load(tmp_path / "plant.toml")


def test_it_begins_empty(pond):
    """From empty it follows the same course as the tank of which it is a copy."""
    assert pond.process.levels == ("tank_1.level",)
    run = cl.simulate(pond, start="empty", duration="2 min")
    tank = cl.simulate(Path(__file__).parents[1] / "one-tank.toml", start="empty", duration="2 min")
    assert run.values["tank_1.level"][0] == 0.0
    assert run.values["tank_1.level"].tolist() == tank.values["tank_1.level"].tolist()


def test_it_is_no_lag_of_an_instrument(pond, tmp_path):
    """A vessel that settles within a sample needs short steps, and is never taken for settled."""
    text = (tmp_path / "plant.toml").read_text("utf-8")
    small = text.replace('area = "28 cm^2"', 'area = "0.01 cm^2"', 1)
    (tmp_path / "small.toml").write_text(small, "utf-8")
    plain = small.replace("[ponds.", "[tanks.").replace('elements = "pond.py"\n', "")
    (tmp_path / "plain.toml").write_text(plain, "utf-8")
    steps = [
        cl.simulate(tmp_path / f"{name}.toml", duration="5 s").substeps
        for name in ("small", "plain")
    ]
    assert steps[0] == steps[1] > 100
