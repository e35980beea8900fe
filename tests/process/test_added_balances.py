"""An element of one file adds to the balances of a tank that it does not own."""

import sys
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError
from clepsydra.process import elements
from clepsydra.process.kinds import kinds
from clepsydra.process.reader import load_process

LEAK = '''
from dataclasses import dataclass
from typing import ClassVar
import casadi as ca
from clepsydra import Element, link, quantity

@dataclass(frozen=True)
class Leak(Element):
    """A crack in the floor of a tank, q = k h, and what the liquid takes with it."""

    kind: ClassVar[str] = "leak"
    table: ClassVar[str] = "leaks"

    tank: str = link("the name of a tank", "tank", carries_flow=False)
    coefficient: float = quantity(
        "m^2/s", "a flow per level", "leak per level of", above=0.0, remedy="measure it")

    def rates(self, symbols, received, given):
        level = ca.fmax(symbols[f"{self.tank}.level"], 0)
        flow = symbols[f"{self.name}.coefficient"] * level
        salt = flow * symbols[f"{self.tank}.salt"]
        return {
            f"{self.tank}.level": -flow / symbols[f"{self.tank}.area"],
            f"{self.tank}.salt_amount": -salt,
            "balance.left.liquid": flow,
            "balance.left.salt": salt,
        }
'''
PLANT = """
name = "leaking-tank"
sampling_period = "1 s"
controlled = ["level_1"]
elements = "leak.py"

[components.salt]
range = ["0 g/l", "50 g/l"]

[reservoirs.brine]
concentration = { salt = "20 g/l" }

[tanks.tank_1]
area = "100 cm^2"
height = "40 cm"

[linear_outlets.outlet_1]
source = "tank_1"
destination = "brine"
coefficient = "2 cm^2/s"

[leaks.leak_1]
tank = "tank_1"
coefficient = "1 cm^2/s"

[pumps.pump_1]
source = "brine"
destination = "tank_1"
gain = "10 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "6 V"

[sensors.level_1]
tank = "tank_1"
range = ["0 cm", "40 cm"]
"""


@pytest.fixture
def write(tmp_path: Path):
    def written(leak: str = LEAK, plant: str = PLANT) -> Path:
        (tmp_path / "leak.py").write_text(leak, encoding="utf-8")
        path = tmp_path / "plant.toml"
        path.write_text(plant, encoding="utf-8")
        return path

    return written


def test_a_leak_takes_from_level_and_component(write) -> None:
    process = load_process(write())
    leak = process.signal("leak_1.coefficient")
    assert (leak.initial, leak.unit, leak.display_unit) == (1e-4, "m^2/s", "cm^2/s")
    rate = process.dynamics([0.1, 5.0], [6.0], [], process.parameter_values)
    # dh/dt = (60 - 20 - 10) cm³/s over 100 cm²; the salt of what comes in mixes with 1 l.
    assert np.array(rate).ravel() == pytest.approx([30e-6 / 1e-2, 60e-6 * (20.0 - 5.0) / 1e-3])


def test_the_mass_balance_closes(write) -> None:
    motion = load_process(write()).motion
    totals = [signal.name for signal in motion.totals]
    p = load_process(write()).parameter_values
    content = np.array([0.1, 5.0 * 1e-3])
    contents, _, crossing = (
        np.array(v).ravel() for v in motion.rates(content, [], [], [6.0], [], p)
    )
    across = dict(zip(totals, crossing, strict=True))
    gained = {"liquid": contents[0] * 1e-2, "salt": contents[1]}
    for name, rate in gained.items():
        entered, left = (across[f"balance.{way}.{name}"] for way in ("entered", "left"))
        assert rate == pytest.approx(entered - left, rel=1e-12)
    assert across["balance.left.liquid"] == pytest.approx(30e-6)


def test_a_file_of_the_folder_is_known(write, tmp_path, monkeypatch) -> None:
    write()
    monkeypatch.setattr(elements, "__path__", [*elements.__path__, str(tmp_path)])
    kinds.cache_clear()
    try:
        path = write(plant=PLANT.replace('elements = "leak.py"\n', ""))
        assert load_process(path).elements[-1].kind == "leak"
    finally:
        kinds.cache_clear()
        sys.modules.pop(f"{elements.__name__}.leak")


def test_a_study_runs_with_it(write) -> None:
    plant = cl.load(write())
    assert cl.study(plant, [cl.design.simc(plant)]).best.rank == 1


def test_a_rate_of_nothing_is_refused(write) -> None:
    with pytest.raises(InputError) as caught:
        load_process(write(LEAK.replace('f"{self.tank}.level": -', 'f"{self.tank}.levl": -')))
    assert caught.value.place == "leaks.leak_1"
    assert caught.value.value == "a rate of tank_1.levl"
    assert "tank_1.level" in caught.value.remedy


def test_its_key_is_checked_as_those_of_the_house(write) -> None:
    with pytest.raises(InputError) as caught:
        load_process(write(plant=PLANT.replace('"1 cm^2/s"', '"-1 cm^2/s"')))
    assert caught.value.place.endswith("line 24, leaks.leak_1.coefficient")
    assert caught.value.expected == "a flow per level above 0 cm^2/s"
