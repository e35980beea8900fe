"""The process file to begin with explains every key, and what it shows may be written."""

import re
import tempfile

import pytest

import clepsydra as cl
from clepsydra.process.kinds import KINDS
from clepsydra.process.reader import _GENERAL_KEYS, load_process

with tempfile.TemporaryDirectory() as folder:
    TEMPLATE = cl.new_process("my-plant", folder=folder).read_text(encoding="utf-8")


def test_the_template_explains_every_key():
    for key in _GENERAL_KEYS:
        assert re.search(rf"^(# )?(\[)?{key}\b", TEMPLATE, re.MULTILINE), key
    for kind in KINDS:
        place = re.search(rf"^(# )?\[{kind.table}\.", TEMPLATE, re.MULTILINE)
        assert place, kind.table
        rest = TEMPLATE[place.start() :]
        for key in kind.keys:
            assert re.search(rf"\b{key} = ", rest) or re.search(rf"\b{key} = ", TEMPLATE), key


@pytest.mark.parametrize("table", sorted({kind.table for kind in KINDS}))
def test_what_the_template_shows_in_comments_can_be_written(table, tmp_path):
    """Uncomment one table of the template at a time: its keys are known and its values right."""
    block = re.search(rf"^# \[{table}\.[a-z_0-9]+\]\n(# .*\n)+", TEMPLATE, re.MULTILINE)
    if block is None:
        assert re.search(rf"^\[{table}\.", TEMPLATE, re.MULTILINE)
        return
    lines = [line[2:] for line in block.group().splitlines()]
    # Words after a value are for the reader, and some keys exclude others.
    lines = [re.sub(r'^(\w+ = ("[^"]*"|\[.*\]|\{.*\}|\S+))\s{2,}.*$', r"\1", x) for x in lines]
    lines = [x for x in lines if not x.startswith(("rangeability", "backlash"))]
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
