"""The pages on process files: their keys, defaults and examples are those of the reader."""

import re
import tomllib
from pathlib import Path

import pytest
from pages import blocks
from shown_elements import PAGE, PAGES, SECTIONS, examples, plant_with, title

from clepsydra import Element, InputError
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process import reader
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.kinds import kinds
from clepsydra.process.reader import load_process

ROOT = Path(__file__).parents[2]
BLOCKS = [block.text for page in PAGES for block in blocks(f"docs/{page}.md", "toml")]
WHOLE = [block for block in BLOCKS if "name" in tomllib.loads(block)]
PARTS = [block for block in BLOCKS if block not in WHOLE]


def load(part: str, folder: Path) -> dict[str, Element]:
    """Put an example into the plant, read it, and return its elements by name."""
    path = folder / "plant.toml"
    path.write_text(plant_with(part), encoding="utf-8")
    return {element.name: element for element in load_process(path).elements}


def rows(section: str) -> dict[str, str]:
    """Return each key that the section describes, with its default; none where it is missing."""
    text = SECTIONS.get(section, "")
    found = re.findall(r"^\| `(\w+)` \|.*\| (.+?) \|$", text, re.MULTILINE)
    assert len(found) == len(dict(found)), section
    return dict(found)


def with_key(part: str, table: str, line: str) -> str:
    """Return an example with one more line at the head of one of its tables."""
    return part.replace(f"[{table}]\n", f"[{table}]\n{line}\n", 1)


def names_of(part: str, kind: type[Element]) -> list[str]:
    return list(tomllib.loads(part).get(kind.table, {}))


REQUIRED = [
    (kind, key)
    for kind in kinds()
    for key, default in rows(title(kind)).items()
    if default.startswith("required")
]
DEFAULTS = [
    (kind, key, default[1:-1])
    for kind in kinds()
    for key, default in rows(title(kind)).items()
    if re.fullmatch("`[^`]+`", default)
]


def test_the_pages_have_whole_processes_and_many_parts() -> None:
    assert len(WHOLE) >= 2
    assert len(PARTS) >= 20


def test_the_general_keys_are_those_of_the_reader() -> None:
    assert set(rows("General keys")) == set(reader.GENERAL_KEYS)


@pytest.mark.parametrize("kind", kinds(), ids=lambda kind: kind.kind)
def test_the_keys_of_a_section_are_those_of_its_kind(kind: type[Element]) -> None:
    section = title(kind)
    what = f"docs/elements: write a page # {section} with an example, and a table with a row for "
    assert set(rows(section)) == set(kind.keys), what + ", ".join(kind.keys)


@pytest.mark.parametrize("block", WHOLE, ids=lambda block: tomllib.loads(block)["name"])
def test_a_whole_process_loads_and_rests_in_every_variant(block: str, tmp_path: Path) -> None:
    path = tmp_path / "plant.toml"
    path.write_text(block, encoding="utf-8")
    variants = [None, *tomllib.loads(block).get("variants", {})]
    if len(variants) > 1:
        variants.append(variants[2:])
    for variant in variants:
        point = find_equilibrium(load_process(path, variant))
        assert all(value > 0.0 for value in point.state)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.split("]")[0][1:])
def test_a_part_loads_in_a_small_plant(part: str, tmp_path: Path) -> None:
    elements = load(part, tmp_path)
    for table, content in tomllib.loads(part).items():
        if table not in ("components", "uncertainty"):
            assert set(content) <= set(elements)


@pytest.mark.parametrize("kind", kinds(), ids=lambda kind: kind.kind)
def test_the_first_example_of_a_kind_has_just_what_is_required(kind: type[Element]) -> None:
    content = tomllib.loads(examples(title(kind))[0])
    (given,) = content[kind.table].values()
    assert set(given) == {key for of, key in REQUIRED if of is kind}


@pytest.mark.parametrize(("kind", "key"), REQUIRED)
def test_what_is_required_cannot_be_left_out(kind: type[Element], key: str, tmp_path: Path) -> None:
    first = examples(title(kind))[0]
    without = re.sub(rf"^{key} = .*\n", "", first, flags=re.MULTILINE)
    assert without != first
    with pytest.raises(InputError, match=key):
        load(without, tmp_path)


@pytest.mark.sampled
@pytest.mark.parametrize(("kind", "key", "value"), DEFAULTS)
def test_a_default_is_what_a_missing_key_means(
    kind: type[Element], key: str, value: str, tmp_path: Path
) -> None:
    """A key with its default, in the place of whatever an example has, is the same as no key."""
    tried = 0
    # A sensor that reports now and then has a page of its own.
    others = examples("Analyser") if kind is Sensor else []
    for part in [*examples(title(kind)), *others]:
        without = re.sub(rf"^{key} = .*\n", "", part, flags=re.MULTILINE)
        for name in names_of(part, kind):
            explicit = with_key(without, f"{kind.table}.{name}", f"{key} = {value}")
            try:
                found = load(explicit, tmp_path)[name]
            except InputError:
                continue  # the key belongs to another shape, law or signal
            assert found == load(without, tmp_path)[name]
            tried += 1
    assert tried


def test_the_default_of_gravity(tmp_path: Path) -> None:
    value = rows("General keys")["gravity"].strip("`")
    path = tmp_path / "plant.toml"
    found = []
    for line in ("", f"gravity = {value}\n"):
        path.write_text(line + WHOLE[0], encoding="utf-8")
        found.append(load_process(path).signal("gravity").initial)
    assert found[0] == found[1]


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_links_to_exists(page: str) -> None:
    own = ROOT / "docs" / f"{page}.md"
    for link in re.findall(r"\]\((?!https?:)([^)]+)\)", PAGES[page]):
        file, _, section = link.partition("#")
        there = own.parent / file if file else own
        assert there.exists(), link
        if section:
            headings = re.findall(r"^#+ (.+)$", there.read_text(encoding="utf-8"), re.MULTILINE)
            assert section.replace("-", " ") in {heading.lower() for heading in headings}, link


@pytest.mark.thorough
def test_signals_that_the_page_names_exist(tmp_path: Path) -> None:
    """Every `element.quantity` on a page is a signal or an event of one of the examples."""
    known = {"feed.salt"}
    texts = [*WHOLE, *map(plant_with, [*PARTS, *PLANTS_OF_SIGNALS])]
    for number, text in enumerate(texts):
        path = tmp_path / f"{number}.toml"
        path.write_text(text, encoding="utf-8")
        process = load_process(path)
        motion = process.motion
        for signals in (
            process.state, process.parameters, process.disturbances, motion.contents,
            motion.totals, motion.memories, motion.delays,
        ):  # fmt: skip
            known |= {signal.name for signal in signals}
        known |= {event.name for event in motion.events}
    stems = r"(?:tank|pump|valve|level|channel)_1|feed"
    named = set(re.findall(rf"`((?:{stems})\.\w+)`", PAGE))
    assert len(named) > 15
    assert named <= known


#: What the pages name but none of their examples has.
PLANTS_OF_SIGNALS = [
    """
[tanks.tank_1]
shape = "sphere"
diameter = "50 cm"
weir = "1 cm"

[pumps.pump_1]
source = "tank_2"
destination = "tank_1"
gain = "3.33 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "2 V"
lag = "1 s"
trip_above = { tank_1 = "15 cm" }
hysteresis = "1 cm"

[sensors.level_1]
tank = "tank_1"
range = ["0 cm", "20 cm"]
lag = "1 s"
""",
    """
[tanks.tank_1]
area = "28 cm^2"
height = "20 cm"
when_full = "inflow stops"
""",
]
