"""Plants and designs of them, each made once for all tests."""

import re
import tempfile
from functools import cache
from pathlib import Path

from pages import blocks

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_names

#: The smallest plant: one tank, one pump, one sensor.
ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"

#: Processes and variants with different equations; the others have other numbers or units.
STRUCTURES = (
    "averaging-tank", "averaging-tank:all-inputs", "eight-tanks", "equalisation-tank",
    "equalisation-tank:dosing", "equalisation-tank:relief", "laboratory-four-tanks",
    "quadruple-tank", "three-tanks", "wet-well", "wet-well:flow-meters", "wet-well:start-stop",
)  # fmt: skip

plant = cache(cl.load)


def every_variant() -> list[str]:
    """Return the processes of the catalogue, each followed by its variants."""
    names = []
    for name in catalogue_names():
        names += [name, *(f"{name}:{variant}" for variant in plant(name).process.variants)]
    return names


@cache
def designed(design: str, name: str | Path, **options: object) -> cl.Controller:
    """`cl.design.NAME(plant, …)` by the names of the two."""
    return getattr(cl.design, design)(plant(name), **options)


#: Signals of the quadruple tank to the tags that docs/plc.md gives them.
TAGS = {
    name: element["tag"]
    for elements in blocks("docs/plc.md", "toml")[0].table.values()
    for name, element in elements.items()
}


@cache
def tagged() -> cl.Plant:
    """The quadruple tank as docs/plc.md has it: a copy in which signals have tags."""
    with tempfile.TemporaryDirectory() as folder:
        path = cl.new_process("quadruple-tank", copy_of="quadruple-tank", folder=folder)
        text = path.read_text(encoding="utf-8")
        for name, tag in TAGS.items():
            text, count = re.subn(rf"(?m)^(\[\w+\.{name}\])$", rf'\1\ntag = "{tag}"', text)
            assert count == 1, name
        path.write_text(text, encoding="utf-8")
        return cl.load(path)
