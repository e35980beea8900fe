"""mbpoll, which is libmodbus, against the door of a rig."""

import re
import shutil
import subprocess

import pytest
from tools import without

from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.register_map import default_map


@pytest.fixture
def mbpoll():
    """Run mbpoll once, with addresses from 0, and return what it printed and its status."""
    program = shutil.which("mbpoll")
    if program is None:
        without("mbpoll is not installed (apt-get install mbpoll)", "CLEPSYDRA_REQUIRE_MBPOLL")

    def run(served, *arguments: str, writes: tuple[str, ...] = ()) -> tuple[str, int]:
        line = [program, "-0", "-1", "-p", str(served.port), *arguments, served.host, *writes]
        done = subprocess.run(line, capture_output=True, text=True, timeout=60, check=False)
        return done.stdout + done.stderr, done.returncode

    return run


def shown(printed: str) -> dict[int, str]:
    """Return what mbpoll shows, by address."""
    return {int(n): value for n, value in re.findall(r"^\[(\d+)\]:\s+(\S+)", printed, re.M)}


@pytest.mark.parametrize(
    ("encoding", "order"),
    [(Encoding.FLOAT32, ["-B"]), (Encoding.FLOAT32_LOW_WORD_FIRST, [])],
)
def test_floats_in_both_orders(mbpoll, serving, told, table, tags, encoding, order) -> None:
    told(level_1=1.5, level_2=6.25)
    with serving(default_map(tags, encoding)) as served:
        printed, status = mbpoll(served, "-t", "3:float", *order, "-r", "0", "-c", "2")
        assert (shown(printed), status) == ({0: "1.5", 2: "6.25"}, 0)
        _, status = mbpoll(served, "-t", "4:float", *order, "-r", "0", writes=("3.5", "4.25"))
    assert status == 0
    assert table.read(table.tags["pump_1.out"]).value == 3.5
    assert table.read(table.tags["pump_2.out"]).value == 4.25


def test_words_and_bits(mbpoll, serving, told, table) -> None:
    told(**{"plant.watchdog": 500.0})
    with serving() as served:
        assert shown(mbpoll(served, "-t", "3", "-r", "12")[0]) == {12: "500"}
        assert shown(mbpoll(served, "-t", "1", "-r", "0", "-c", "4")[0]).keys() == {0, 1, 2, 3}
        assert mbpoll(served, "-t", "0", "-r", "1", writes=("1",))[1] == 0
        assert mbpoll(served, "-t", "4", "-r", "8", writes=("17",))[1] == 0
        assert shown(mbpoll(served, "-t", "4", "-r", "8")[0]) == {8: "17"}
        assert shown(mbpoll(served, "-t", "0", "-r", "0", "-c", "2")[0]) == {0: "0", 1: "1"}
    assert table.read(table.tags["operator.remote"]).value == 1.0


def test_refusals_are_told_by_their_names(mbpoll, serving, told) -> None:
    told()
    with serving() as served:
        assert "Illegal data address" in mbpoll(served, "-t", "3", "-r", "400")[0]
        assert "Illegal data address" in mbpoll(served, "-t", "4", "-r", "0", writes=("1",))[0]
        beyond = mbpoll(served, "-t", "4:float", "-B", "-r", "0", writes=("50",))
        assert "Illegal data value" in beyond[0]
    with serving(read_only=True) as served:
        told_off = mbpoll(served, "-t", "4:float", "-B", "-r", "0", writes=("5",))
        assert "Illegal function" in told_off[0]
