"""Requests and answers as bytes, worked by hand from the Modbus Application Protocol V1.1b3."""

import pytest

from clepsydra.rig.doors.modbus.functions import answer
from clepsydra.rig.doors.modbus.register_map import default_map
from clepsydra.rig.doors.modbus.registers import Registers


@pytest.fixture
def asked(tags, table, told):
    """Ask the registers of a rig: the request and its answer in hexadecimal."""
    told(level_1=1.5, **{"plant.watchdog": 5.0})
    table.image.write("operator.remote", 1.0)
    registers = Registers(default_map(tags), table, read_only=False)

    def ask(request: str) -> str:
        return answer(bytes.fromhex(request), registers).hex(" ")

    return ask


def test_a_word_is_masked_as_in_the_example(asked, table) -> None:
    # Section 6.16: of 12, kept by F2 and set to 25, is made 17. Register 8 is the heartbeat.
    assert asked("06 0008 0012") == "06 00 08 00 12"
    assert asked("16 0008 00f2 0025") == "16 00 08 00 f2 00 25"
    assert table.read(table.tags["controller.heartbeat"]).value == 0x17
    # Half of a float, of which a read has its word, and nothing is written.
    assert asked("16 0000 ffff 0000") == "96 02"


def test_what_is_written_is_read_by_the_same_request(asked, table) -> None:
    # Section 6.17: the write comes first. 40400000 is 3.
    assert asked("17 0000 0002 0000 0002 04 40400000") == "17 04 40 40 00 00"
    assert table.read(table.tags["pump_1.out"]).value == 3.0
    # Registers 500 are not there: nothing is written. 40800000 would be 4.
    assert asked("17 01f4 0001 0000 0002 04 40800000") == "97 02"
    assert table.read(table.tags["pump_1.out"]).value == 3.0


def test_bits_are_packed_from_the_lowest(asked, table) -> None:
    # Coils 0 and 1: acknowledge, which is off, and remote.
    assert asked("01 0000 0002") == "01 01 02"
    assert asked("0f 0000 0002 01 01") == "0f 00 00 00 02"
    assert asked("01 0000 0002") == "01 01 01"
    assert table.read(table.tags["operator.acknowledge"]).value == 1.0
    assert table.read(table.tags["operator.remote"]).value == 0.0


def test_a_coil_is_set_by_two_values_alone(asked, table) -> None:
    assert asked("05 0001 0001") == "85 03"
    assert table.read(table.tags["operator.remote"]).value == 1.0
    assert asked("05 0001 0000") == "05 00 01 00 00"
    assert asked("05 0000 ff00") == "05 00 00 ff 00"


#: What is refused by its form, whatever the registers are.
MALFORMED = {
    "no register": ("03 0000 0000", "83 03"),
    "126 registers": ("04 0000 007e", "84 03"),
    "2001 bits": ("02 0000 07d1", "82 03"),
    "no coil": ("0f 0000 0000 00", "8f 03"),
    "124 registers written": ("10 0000 007c f8" + "0000" * 124, "90 03"),
    "bytes that are not twice the registers": ("10 0000 0002 03 000000", "90 03"),
    "fewer bytes than are told": ("10 0000 0002 04 4040", "90 03"),
    "more bytes than are told": ("10 0000 0002 04 40400000 00", "90 03"),
    "bits in too many bytes": ("0f 0000 0002 02 0100", "8f 03"),
    "122 registers written beside a read": ("17 0000 0001 0000 007a f4" + "0000" * 122, "97 03"),
    "too short": ("06 0008", "86 03"),
    "nothing behind the function": ("03", "83 03"),
    "too long": ("06 0008 0001 00", "86 03"),
    "a function that there is not": ("63 0000 0001", "e3 01"),
    "an exception": ("83 02", "83 01"),
    "over the last address": ("03 ffff 0002", "83 02"),
}


@pytest.mark.parametrize("case", MALFORMED)
def test_what_is_malformed(asked, table, case) -> None:
    request, expected = MALFORMED[case]
    before = table.image.written().tolist()
    assert asked(request) == expected
    assert table.image.written().tolist() == before
