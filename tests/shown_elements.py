"""Elements as the pages on process files show them, and a small plant into which each is put."""

import re
from pathlib import Path

from clepsydra import Element

DOCS = Path(__file__).parents[1] / "docs"
#: Every page on process files by its name below docs, those of elements among them.
PAGES = {
    path.relative_to(DOCS).with_suffix("").as_posix(): path.read_text(encoding="utf-8")
    for path in (
        *(DOCS / f"{name}.md" for name in ("process-files", "variants", "switches")),
        *sorted((DOCS / "elements").glob("*.md")),
    )
}
PAGE = "".join(PAGES.values())
#: The sections of the general pages, and the page of each element as one.
SECTIONS = {
    heading: text
    for name, page in PAGES.items()
    for heading, text in re.findall(
        r"^# (.+?)\n(.*)" if name.startswith("elements/") else r"^## (.+?)\n(.*?)(?=^## |\Z)",
        page, re.MULTILINE | re.DOTALL,
    )
}  # fmt: skip

#: A small plant into which the examples are put; an example takes the place of tables that it has.
PLANT = """
[components.salt]
range = ["0 g/l", "50 g/l"]

[reservoirs.basin]

[tanks.tank_1]
area = "28 cm^2"
height = "20 cm"

[tanks.tank_2]
area = "28 cm^2"
height = "20 cm"

[orifices.outlet_1]
source = "tank_1"
destination = "basin"
area = "0.071 cm^2"

[orifices.outlet_2]
source = "tank_2"
destination = "channel_1"
area = "0.071 cm^2"

[delays.channel_1]
destination = "basin"
time = "10 s"

[pumps.pump_1]
source = "basin"
destination = "tank_1"
gain = "3.33 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "2 V"

[pumps.pump_2]
source = "basin"
destination = "splitter_1"
gain = "3.33 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "1 V"

[splitters.splitter_1]
fractions = { tank_1 = 0.5, tank_2 = 0.5 }

[flows.feed]
destination = "tank_1"
range = ["0 cm^3/s", "5 cm^3/s"]
nominal = "0 cm^3/s"
concentration = { salt = "10 g/l" }

[sensors.level_1]
tank = "tank_1"
range = ["0 cm", "20 cm"]
"""


def tables(text: str) -> dict[str, str]:
    """Return the tables of a TOML text, each by its name."""
    return {part.split("]")[0]: f"[{part}" for part in re.split(r"^\[", text, flags=re.M)[1:]}


def plant_with(part: str) -> str:
    """Return the plant with an example in it."""
    own = tables(part)
    controlled = re.findall(r"^\[sensors\.(\w+)\]", part, re.M) or ["level_1"]
    kept = [text for name, text in tables(PLANT).items() if name not in own]
    return (
        f'name = "plant"\nsampling_period = "1 s"\ncontrolled = ["{controlled[0]}"]\n'
        + "\n".join([*kept, *own.values()])
    )


def title(kind: type[Element]) -> str:
    return kind.kind[0].upper() + kind.kind[1:]


def _written(section: str) -> str:
    assert section in SECTIONS, f"docs/elements: write a page # {section} with an example"
    return SECTIONS[section]


def examples(section: str) -> list[str]:
    """Return the parts of a file that a section shows, whole ones left out."""
    found = re.findall(r"^```toml\n(.*?)^```", _written(section), re.MULTILINE | re.DOTALL)
    return [part for part in found if not part.startswith("name = ")]
