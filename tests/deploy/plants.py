"""Plants and designs of them, each made once for all tests."""

from functools import cache
from pathlib import Path

import clepsydra as cl

#: The smallest plant: one tank, one pump, one sensor.
ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"

#: Processes and variants with different equations; the others have other numbers or units.
STRUCTURES = (
    "averaging-tank", "averaging-tank:all-inputs", "eight-tanks", "equalisation-tank",
    "equalisation-tank:dosing", "equalisation-tank:relief", "laboratory-four-tanks",
    "quadruple-tank", "three-tanks", "wet-well", "wet-well:flow-meters", "wet-well:start-stop",
)  # fmt: skip

plant = cache(cl.load)


@cache
def designed(design: str, name: str | Path, **options: object) -> cl.Controller:
    """`cl.design.NAME(plant, …)` by the names of the two."""
    return getattr(cl.design, design)(plant(name), **options)
