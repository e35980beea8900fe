"""The process file to begin with explains every key, and what it shows may be written."""

import re
import tempfile
import tomllib

import pytest
from json_schema import faults

import clepsydra as cl
from clepsydra.base.units import to_si
from clepsydra.process.declared import Quantity, declared, table_schema
from clepsydra.process.kinds import kinds
from clepsydra.process.reader import GENERAL_KEYS, load_process

with tempfile.TemporaryDirectory() as folder:
    TEMPLATE = cl.new_process("my-plant", folder=folder).read_text(encoding="utf-8")


def test_the_template_explains_every_key():
    for key in GENERAL_KEYS:
        assert re.search(rf"^(# )?(\[)?{key}\b", TEMPLATE, re.MULTILINE), key
    for kind in kinds():
        place = re.search(rf"^(# )?\[{kind.table}\.", TEMPLATE, re.MULTILINE)
        assert place, f"interface/new_process.toml: write [{kind.table}.NAME] with every key"
        rest = TEMPLATE[place.start() :]
        for key in kind.keys:
            assert re.search(rf"\b{key} = ", rest) or re.search(rf"\b{key} = ", TEMPLATE), (
                f"interface/new_process.toml: explain {key} below [{kind.table}.NAME]"
            )


#: A key with its value, and words beside it.
_KEY = re.compile(r"(?:# )?(\w+) = (\".*?\"|\[.*?\]+|{.*?}|[\w.]+)(?:   *(.*))?$")


def shown_keys():
    """Yield every key that the template shows of an element, also in comments.

    With its kind, its value, and the comment above it.
    """
    kind, above, begun = None, "", False
    for line in TEMPLATE.splitlines():
        if heading := re.match(r"(?:# )?\[(\w+)", line):
            kind = next((each for each in kinds() if each.table == heading[1]), None)
            above = ""
        elif shown := re.match(
            r"(?:# )?(\w+) = (\".*?\"|\[.*?\]+|{.*?}|[\w.]+)(?:   *(.*))?$", line
        ):
            if kind is not None:
                value = tomllib.loads(f"value = {shown[2]}")["value"]
                yield pytest.param(kind, shown[1], value, above, id=line.strip("# "))
            begun = False
        elif line.startswith("# "):
            above = f"{above} {line[2:]}" if begun else line[2:]
            begun = True


@pytest.mark.parametrize(("kind", "key", "value", "comment"), [*shown_keys()])
def test_what_the_template_says_of_a_key_is_what_its_declaration_says(kind, key, value, comment):
    """Its unit, its bounds, its choices, its default where that is said, and its words."""
    schema = table_schema(kind)["properties"][key]
    assert list(faults(value, schema)) == []
    quantity = declared(kind).get(key)
    told = schema["description"]
    if isinstance(quantity, Quantity):
        told += f" {quantity.words}"
        unit = quantity.unit_of(dict.fromkeys(("unit", "per_unit"), "V"))
        number = to_si(value, unit, key)
        low, high = quantity.low, quantity.high
        assert (low < number if quantity.strict else low <= number) and number <= high
        if left_out := re.search(r"([\d.]+) if left out", comment):
            assert f"{float(left_out[1]):g} if left out" in told
    words = set(re.findall(r"[a-z]{4,}", told.lower()))
    assert not comment or words & set(re.findall(r"[a-z]{4,}", comment.lower()))


@pytest.mark.parametrize("table", sorted({kind.table for kind in kinds()}))
def test_what_the_template_shows_in_comments_can_be_written(table, tmp_path):
    """Uncomment one table of the template at a time: its keys are known and its values right."""
    block = re.search(rf"^# \[{table}\.[a-z_0-9]+\]\n(# .*\n)+", TEMPLATE, re.MULTILINE)
    if block is None:
        assert re.search(rf"^\[{table}\.", TEMPLATE, re.MULTILINE)
        return
    lines = [line[2:] for line in block.group().splitlines()]
    # Words after a value are for the reader, and some keys exclude others.
    lines = [re.sub(r'^(\w+ = ("[^"]*"|\[.*\]|\{.*\}|\S+))\s{2,}.*$', r"\1", x) for x in lines]
    lines = [x for x in lines if not x.startswith(("rangeability", "backlash", "pump"))]
    text = TEMPLATE.replace(block.group(), "\n".join(lines) + "\n")
    outlet = 'source = "tank_1"\ndestination = "basin"'
    if table == "splitters":
        # The outlet feeds it, and it feeds a second reservoir instead of the tank.
        text = text.replace(outlet, outlet.replace("basin", "splitter_1"), 1)
        sump = "fractions = { sump = 0.7, basin = 0.3 }\n[reservoirs.sump]"
        text = text.replace("fractions = { tank_1 = 0.7, basin = 0.3 }", sump)
    if table == "delays":
        text = text.replace(outlet, outlet.replace("basin", "channel_1"), 1)
        text = text.replace('destination = "tank_1"\ntime', 'destination = "basin"\ntime')
    (tmp_path / "plant.toml").write_text(text, encoding="utf-8")
    name = re.match(r"\[\w+\.(\w+)\]", lines[0]).group(1)
    assert name in {e.name for e in load_process(tmp_path / "plant.toml").elements}


@pytest.mark.thorough
def test_its_first_study_has_nothing_to_watch(tmp_path):
    found = cl.study(cl.new_process("my-plant", folder=tmp_path))
    assert " !  " not in repr(found)
    assert not found.recommended.warnings and not found.recommended.caveats
    assert found.recommended.standing.name == "ROBUST"
