"""`clepsydra hil`: the proof on a real rig, soft PLCs and wires; and its mistakes."""

import json
import os
import pickle
import shutil

import pytest
from tools import need, need_compiler

import clepsydra as cl

#: Of a busy machine.
SPEED = "10"


@pytest.mark.thorough
def test_every_case_holds_on_every_wire(command):
    need("pymodbus", "asyncua")
    need_compiler()
    status, told, errors = command("hil", "quadruple-tank", "--speed", SPEED, "--json")
    found = json.loads(told)
    assert status == 0 and found["holds"], told + errors
    # matiec is on few machines; without it that is said.
    has_matiec = bool(os.environ.get("CLEPSYDRA_MATIEC") or shutil.which("iec2c"))
    assert len(found["tried"]) == (4 if has_matiec else 2)
    assert [each["plc"] for each in found["left_out"]] == ([] if has_matiec else ["st"])
    for trial in found["tried"]:
        assert len(trial["cases"]) == 9 and all(case["holds"] for case in trial["cases"])
        assert trial["law"]["differing"] == trial["plant"]["differing"] == 0
        assert trial["wires_carried"]["misread"] == 0 and trial["wires_carried"]["read"] > 500


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("process", "speed", "encoding"),
    [("three-tanks", SPEED, "float32"), ("averaging-tank", "1", "counts-27648")],
)
def test_one_screen_says_what_holds(command, process, speed, encoding):
    """Also of the tank that the first document wants to see in the loop, in real time."""
    need("pymodbus")
    need_compiler()
    asked = ["--plc", "c", "--wires", "modbus", "--speed", speed, "--encoding", encoding]
    status, told, _ = command("hil", process, *asked)
    assert status == 0, told
    assert "holds on its wires: all 9 cases" in " ".join(told.split()) and "C, Modbus TCP" in told
    assert len(told.splitlines()) <= 24 and "sensor pulled" in told


@pytest.mark.thorough
def test_what_it_finds_goes_to_another_process_and_prints_itself():
    need("pymodbus")
    need_compiler()
    found = cl.run_hil("quadruple-tank", plcs=["c"], wires=["modbus"], speed=float(SPEED))
    again = pickle.loads(pickle.dumps(found))
    assert repr(again) == repr(found) and again.as_dict() == found.as_dict()
    assert "holds on its wires" in repr(found)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--plc", "st,fortran"], "--plc: got 'fortran'"),
        (["--wires", "profibus"], "--wires: got 'profibus'"),
        (["--precision", "half"], "--precision: got 'half'"),
        (["--encoding", "bcd"], "--encoding: got 'bcd'"),
        (["--speed", "0"], "--speed"),
        (["--speed", "5000"], "--speed"),
        (["--controller", "PI, NOBODY"], "PI, NOBODY"),
    ],
)
def test_a_mistake_is_one_message_with_a_remedy(command, options, words):
    need("pymodbus")
    status, _, told = command("hil", "quadruple-tank", *options)
    assert status == 2 and words in told and "Traceback" not in told


def test_a_plc_that_cannot_be_had_is_named_with_what_it_needs(command, monkeypatch):
    need("pymodbus")
    monkeypatch.setenv("CLEPSYDRA_MATIEC", "")
    monkeypatch.setattr(shutil, "which", lambda name: None)
    status, _, told = command("hil", "quadruple-tank", "--plc", "st")
    assert status == 2 and "iec2c" in told and "install what is missing" in told
