"""Pumps on a header, late sensors, odd vessels and alarms: the same bits on every target.

FMUs and controllers are proved with the studies of these plants, in tests/whole_plants.
"""

from pathlib import Path

import pytest
from plants import plant
from spoilt_programs import FMUS, quickly
from tools import need, need_compiler, need_grammar

from clepsydra.deploy.exported_alarms import alarm_items
from clepsydra.deploy.proof.item import process_item
from clepsydra.deploy.proof.proof import prove

TESTS = Path(__file__).parents[2]
HOTWELL = TESTS.parent / "docs" / "examples" / "hotwell.toml"
PLANTS = sorted((TESTS / "whole_plants").glob("*.toml"))
#: Each way in which pumps stand before a valve, whatever else is sampled.
PUMPED = (HOTWELL, f"{HOTWELL}:open-line", f"{TESTS / 'whole_plants'}/pumping-station.toml:unlike")
EVERY_FMU = (*FMUS, *(f"{name} exchange" for name in FMUS))


def check(subject, monkeypatch):
    need_compiler()
    need_grammar()
    need("wasmtime")
    quickly(monkeypatch, 500, without=EVERY_FMU)
    point = plant(subject).point
    proof = prove([process_item(point), *alarm_items(point)], scans=500)
    assert proof.holds, proof.failures
    assert {row.target for row in proof.rows} == {
        "C", "Structured Text", "Structured Text, codesys", "Structured Text, matiec",
        "Structured Text, scl", "WebAssembly",
    } - (set() if point.process.alarms else {"Structured Text"})  # fmt: skip


@pytest.mark.parametrize("subject", PUMPED, ids=lambda subject: str(subject).rpartition("/")[2])
def test_pumps_before_a_valve(subject, monkeypatch):
    check(subject, monkeypatch)


@pytest.mark.sampled
@pytest.mark.parametrize("subject", PLANTS, ids=lambda subject: subject.stem)
def test_a_whole_plant(subject, monkeypatch):
    check(subject, monkeypatch)
