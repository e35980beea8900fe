"""Register maps that users write: read back as they were, and refused with the line."""

from dataclasses import replace

import pytest
from refusals import refused

from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.map_file import read_map, write_map
from clepsydra.rig.doors.modbus.register_map import RegisterMap, Server, default_map, map_of_plc
from clepsydra.rig.doors.modbus.table import Table

HEAD = "tag,table,address,encoding\n"


@pytest.fixture
def reads(tags, tmp_path):
    """Read a map of these rows."""

    def read(rows: str, server: Server = Server.RIG) -> RegisterMap:
        file = tmp_path / "map.csv"
        file.write_text(HEAD + rows, encoding="utf-8")
        return read_map(file, tags, server)

    return read


#: Those of measured values.
ENCODINGS = [each for each in Encoding if each.is_of_values]


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_default_map_is_read_as_it_was_written(tags, tmp_path, encoding) -> None:
    for made in (default_map(tags, encoding), map_of_plc(tags, encoding)):
        write_map(made, tmp_path / "map.csv")
        assert set(read_map(tmp_path / "map.csv", tags, made.server).entries) == set(made.entries)


def test_every_tag_has_its_place_in_a_default_map(tags) -> None:
    made = default_map(tags)
    assert {entry.tag.name for entry in made.entries} == {tag.name for tag in tags}
    for tag in tags:
        assert (tag.name in made.written) is (tag.writer.value != "plant")


def test_a_large_process_moves_what_begins_at_a_hundred(tags) -> None:
    level = tags[0]
    many = [
        replace(level, name=f"{writer.value}.{number}", writer=writer)
        for writer in dict.fromkeys(tag.writer for tag in tags)
        for number in range(400)
    ]
    made = default_map(many)
    first = {tag.writer: made.by_tag[tag.name].address for tag in reversed(many)}
    # 400 floats of the controller are 800 registers, then 800 of the operator; then the copies.
    assert sorted(first.values()) == [0, 0, 800]
    copies = [entry for entry in made.entries if entry.tag is many[0]]
    assert [entry.address for entry in copies] == [0, 1600]


def test_own_addresses_orders_of_words_and_other_columns(tags, tmp_path) -> None:
    file = tmp_path / "map.csv"
    file.write_text(
        "Address;note;Encoding;Tag;Table\n"
        "4;;float32-low-word-first;level_1.pv;holding register\n\n"
        "7;of ours;BIT;level_1.good;Coil\n",
        encoding="utf-8",
    )
    found = read_map(file, tags).entries
    assert [(e.reference, e.encoding, e.tag.name) for e in found] == [
        ("40005", Encoding.FLOAT32_LOW_WORD_FIRST, "level_1.pv"),
        ("00008", Encoding.BIT, "level_1.good"),
    ]


WRONG = {
    "overlap": (
        "level_1.pv,input register,0,float32\nlevel_2.pv,input register,1,float32\n",
        {"place": "line 3", "expected": "level_1.pv leaves free", "remedy": "another address"},
    ),
    "twice": (
        "pump_1.out,holding register,5,float32\npump_1.out,holding register,5,float32\n",
        {"place": "line 3", "expected": "(", "remedy": "takes 2 from 5 on"},
    ),
    "address beyond": (
        "level_1.pv,input register,65536,counts-27648\n",
        {"place": "line 2", "value": 65536, "expected": "from 0 to 65535"},
    ),
    "second word beyond": (
        "level_1.pv,input register,65535,float32\n",
        {"place": "line 2", "value": 65535, "expected": "from 0 to 65534"},
    ),
    "no address": (
        "level_1.pv,input register,-1,float32\n",
        {"place": "line 2, column 'address'", "value": "-1", "remedy": "counted from 0"},
    ),
    "unknown tag": (
        "level_11.pv,input register,0,float32\n",
        {"place": "line 2, column 'tag'", "value": "level_11.pv", "remedy": "'level_1.pv' was"},
    ),
    "unknown table": (
        "level_1.pv,input registers,0,float32\n",
        {"place": "line 2, column 'table'", "remedy": "'input register' was meant"},
    ),
    "unknown encoding": (
        "level_1.pv,input register,0,real\n",
        {"place": "line 2, column 'encoding'", "expected": "float32, float32-low-word-first"},
    ),
    "value in a coil": (
        "level_1.pv,coil,0,bit\n",
        {"place": "line 2", "expected": "no coil", "remedy": "input register"},
    ),
    "value as a whole number": (
        "level_1.pv,input register,0,uint16\n",
        {"place": "line 2", "value": "uint16", "expected": "as float32 or"},
    ),
    "switch as a float": (
        "level_1.good,input register,0,float32\n",
        {"place": "line 2", "value": "float32", "remedy": "the encoding uint16"},
    ),
    "command that nobody can write": (
        "pump_1.out,input register,0,float32\n",
        {"place": "line 2", "value": "input register", "remedy": "holding register"},
    ),
    "missing field": ("level_1.pv,input register,0\n", {"place": "line 2", "value": "3 fields"}),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_in_a_map_is_told_with_its_line(reads, case) -> None:
    rows, told = WRONG[case]
    with refused(**told):
        reads(rows)


def test_a_missing_column(tags, tmp_path) -> None:
    file = tmp_path / "map.csv"
    file.write_text("tag,table,address\nlevel_1.pv,coil,0\n", encoding="utf-8")
    with refused(place="line 1", expected="the columns tag, table, address, encoding"):
        read_map(file, tags)


def test_the_rig_writes_what_a_plc_lets_be_written(reads) -> None:
    # The other way round as in a map of the rig: the plant's tags have to be writable.
    with refused(value="input register", expected="the rig writes level_1.pv"):
        reads("level_1.pv,input register,0,float32\n", Server.PLC)
    found = reads("pump_1.out,input register,0,float32\n", Server.PLC)
    assert (found.by_tag.keys(), found.written) == ({"pump_1.out"}, {})


def test_a_range_without_end_has_no_counts(tags) -> None:
    level = tags[0]
    open_ended = replace(level, signal=replace(level.signal, high=float("inf")))
    with refused(expected="counts are a share", remedy="float32"):
        Entry(open_ended, Table.INPUT_REGISTERS, 0, Encoding.MICROAMPERES)
    made = default_map([open_ended], Encoding.COUNTS_27648)
    assert made.entries[0].encoding is Encoding.FLOAT32


def test_a_counter_beyond_a_word(tags) -> None:
    counter = next(tag for tag in tags if tag.signal.kind == "integer")
    for high, encoding, remedy in ((70000.0, "UINT16", "uint32"), (2.0**32, "UINT32", "float32")):
        long = replace(counter, signal=replace(counter.signal, high=high))
        with refused(expected="within 0 to", remedy=f"the encoding {remedy}"):
            Entry(long, Table.INPUT_REGISTERS, 0, Encoding[encoding])


@pytest.mark.parametrize(
    ("encoding", "word", "long"),
    [
        (Encoding.FLOAT32_LOW_WORD_FIRST, "uint16", "uint32-low-word-first"),
        (Encoding.COUNTS_27648, "uint16", "uint32"),
    ],
)
def test_whole_numbers_are_as_long_as_they_have_to_be(tags, encoding, word, long) -> None:
    made = default_map(tags, encoding)
    assert made.by_tag["controller.heartbeat"].encoding.value == word
    assert made.by_tag["pump_1.status"].encoding.value == long
