"""``clepsydra verify``: its table, its files, its exit status."""

import json
from pathlib import Path

import pytest

from clepsydra.deploy.c99 import printer

STUDY = 'process = "equalisation-tank"\n[controllers.slow]\ndesign = "arrest_time"\n'


@pytest.mark.thorough
def test_a_controller_and_its_process_are_proved(command):
    Path("one.toml").write_text(STUDY, "utf-8")
    status, out, _ = command("verify", "one.toml")
    assert status == 0 and out.startswith("The proof holds")
    assert all(len(line) <= 100 for line in out.splitlines())
    document = json.loads(Path("one-proof.json").read_text("utf-8"))
    targets = {row["target"] for row in document["rows"] if row["subject"] == "slow"}
    assert {"C", "FMU 3.0", "FMU 2.0"} <= targets
    assert any(target.startswith("Structured Text") for target in targets)
    assert {row["verdict"] for row in document["rows"]} <= {"equal", "reported"}
    assert "slow" in Path("one-proof.md").read_text("utf-8")


@pytest.mark.thorough
def test_a_printer_that_errs_ends_in_status_1(command, monkeypatch):
    """The sum of the printed C is a difference: the proof has to see it and say so."""
    right = printer.print_c

    def wrong(program, **chosen):
        printed = right(program, **chosen)
        spoilt = printed.source.replace(" + ", " - ")
        assert spoilt != printed.source
        return printer.CSource(printed.name, printed.header, spoilt)

    monkeypatch.setattr("clepsydra.deploy.proof.compiled_c.print_c", wrong)
    Path("one.toml").write_text(STUDY, "utf-8")
    status, out, _ = command("verify", "one.toml", "--json")
    document = json.loads(out)
    assert status == 1 and not document["holds"]
    differing = {row["target"] for row in document["rows"] if row["verdict"] == "differs"}
    assert "C" in differing and "FMU 3.0" not in differing


def test_too_few_scans_are_refused_before_any_work(command):
    status, out, error = command("verify", "quadruple-tank", "--scans", "100")
    assert status == 2 and out == "" and "10000" in error


def test_a_controller_that_does_not_apply_is_refused_and_nothing_is_proved(command, tmp_path):
    status, out, error = command("verify", "quadruple-tank", "--controller", "Start/stop levels")
    assert status == 2 and out == "" and "does not" in error
    assert not list(tmp_path.iterdir())
