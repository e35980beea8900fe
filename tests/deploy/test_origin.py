"""Where numbers come from, as heads and comments say it."""

import re
import textwrap

import casadi
import pytest
from families import family

from clepsydra import Signal
from clepsydra.deploy.printing.heading import (
    comment,
    heading,
    number_comment,
    table_comment,
    written_with,
)
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Block, Program

NOTHING = Program("law", (), (), (), (), Block(0, (), ()))
ORIGIN = Origin(
    "PI, SIMC", "Two tanks (two-tanks.toml)", "SIMC rules with a closed-loop time of 20 s.", 0.1,
    {"pump_1.low_limit": "range of pump_1", "late": "at the operating point"}, "SIMC rules",
)  # fmt: skip


def test_a_number_s_source_goes_before_the_default():
    assert ORIGIN.source_of(Signal("pump_1.low_limit")) == "range of pump_1"
    assert ORIGIN.source_of(DelayRing(Signal("late"), 3)) == "at the operating point"
    assert ORIGIN.source_of(Signal("pump_1.high_limit")) == "SIMC rules"
    assert Origin("a", "b", "", 1.0).source_of(Signal("k")) == ""


@pytest.mark.parametrize(
    ("period", "said"),
    [(0.1, "0.1 s"), (1.0, "1 s"), (1 / 3, "0.333333333333 s"), (3600.0, "3600 s")],
)
def test_the_sampling_period_is_given_in_seconds(period, said):
    lines = Origin("PI", "tank.toml", "", period).lines()
    assert lines == [f"PI for tank.toml, sampled every {said}."]


def test_a_process_has_no_design():
    assert len(ORIGIN.lines()) == 2 and ORIGIN.lines()[1].startswith("Design: SIMC rules with")
    assert len(Origin("the process", "tank.toml", "", 1.0).lines()) == 1


def test_the_head_says_all_of_it_on_lines_that_can_be_read():
    origin = Origin("PI", "tank.toml", "words " * 60 + "end.", 1.0)
    plain, told = heading(NOTHING, "C99", ("note",)), heading(NOTHING, "C99", ("note",), origin)
    added = [line for line in told if line not in plain]
    assert [line for line in told if line not in added] == plain
    said = textwrap.dedent("\n".join(added)).split()
    assert said == " ".join(origin.lines()).split()
    assert max(map(len, told)) <= 94


def test_comments_carry_unit_range_description_and_source():
    gain = Signal("gain", "V/m", low=0.0, high=5.0, description="gain of level_1")
    hand = Signal("by_hand", kind="boolean")
    assert comment(gain) == "[V/m] 0 to 5; gain of level_1"
    assert comment(gain, source="SIMC rules") == "[V/m] 0 to 5; gain of level_1; SIMC rules"
    assert comment(hand, source="default") == "truth value; default"
    ring = DelayRing(Signal("flow", "m^3/s"), 3)
    assert comment(ring, source="at rest") == "[m^3/s]; delayed by 3 samples; at rest"
    assert comment(ring, counted="turn") == "[m^3/s]; delayed by 3 turns"
    assert number_comment(gain) == "[V/m]" and number_comment(hand) == "truth value"
    assert number_comment(ring, "at rest") == "[m^3/s] at rest"
    assert number_comment(hand, "default") == "truth value; default"
    assert table_comment(ORIGIN).endswith("; SIMC rules")


def test_nothing_leaves_a_comment():
    hostile = "a */ b *) c\n(* d /* e"
    for text in (
        comment(Signal("k", hostile, description=hostile), source=hostile),
        number_comment(Signal("k", hostile), hostile),
        table_comment(Origin("", "", "", 1.0, {}, hostile)),
        *heading(NOTHING, "C99", (), Origin(hostile, hostile, hostile, 1.0)),
    ):
        assert not any(mark in text for mark in ("/*", "*/", "(*", "*)", "\n"))


def test_the_versions_that_decide_a_digest_stand_beside_it(monkeypatch):
    line = heading(NOTHING, "C99", ())[1]
    assert re.fullmatch(rf"Printed by {re.escape(written_with())}; program digest \w{{16}}\.", line)
    monkeypatch.setattr(casadi.CasadiMeta, "version", lambda: "3.7.0")
    assert heading(NOTHING, "C99", ())[1] != line


def test_the_json_of_an_export_names_them_too():
    assert family("PI, SIMC")[1].facts["written_with"] == written_with()
