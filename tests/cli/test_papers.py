"""The audit from the command line."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from clepsydra.papers import audit as audits
from clepsydra.papers.documents import load_document
from clepsydra.papers.experiment import Document, Experiment, Findings
from clepsydra.papers.row import VERDICTS

NAMES = [
    "document",
    "place",
    "name",
    "printed",
    "computed",
    "unit",
    "difference",
    "verdict",
    "reason",
]


@pytest.mark.thorough
def test_json_is_a_list_of_rows_with_these_names(command):
    status, out, _ = command("papers", "three-tanks", "--json")
    rows = json.loads(out)
    assert status == 0 and not Path("papers.html").exists()
    assert all(list(row) == NAMES for row in rows)
    assert {row["document"] for row in rows} == {"three-tanks"}
    assert {row["verdict"] for row in rows} <= set(VERDICTS)
    period = next(row for row in rows if row["name"] == "Pu")
    assert period["printed"] == 0.034 and period["verdict"] == "misprint"
    assert period["difference"] == pytest.approx(period["computed"] / 0.034 - 1.0)
    assert not any(row["reason"] == "" for row in rows if row["verdict"] != "reproduced")


@pytest.mark.thorough
def test_the_page_shows_every_row_and_every_figure(command):
    status, out, _ = command("papers", "three-tanks")
    page = Path("papers.html").read_text("utf-8")
    assert status == 0 and "what is not as printed" in out and "papers.html" in out
    assert all(len(line) <= 100 for line in out.splitlines())
    figures = ["4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14"]
    assert all(f"Fig. {number}: " in page for number in figures)
    assert page.count("<svg") == len(figures)
    for part in page.split("<svg")[1:]:
        ElementTree.fromstring("<svg" + part.split("</svg>")[0] + "</svg>")
    for row in audits.audit(["three-tanks"]).rows:
        assert page.count(f">{row.place}<") > 0


def test_an_unknown_document_is_refused_with_the_names_that_there_are(command):
    status, out, error = command("papers", "three-tank")
    assert status == 2 and out == "" and "Traceback" not in error
    assert "perhaps 'three-tanks' was meant" in " ".join(error.split())


def test_two_rows_of_one_name_are_a_mistake(monkeypatch):
    from clepsydra.papers.comparison import claimed

    row = claimed("t", "n", "c", True, "1", reason="r")
    twice = Document("d", "d", "d", (Experiment("e", "e", lambda: Findings((row, row))),))
    monkeypatch.setattr(audits, "load_document", lambda key: twice)
    with pytest.raises(AssertionError, match="more than once"):
        audits.audit(["d"])


@pytest.mark.thorough
def test_processes_share_the_work_and_find_the_same(monkeypatch):
    told = []
    alone = audits.audit(["three-tanks"])
    shared = audits.audit(["three-tanks"], workers=2, progress=told.append)
    assert shared.rows == alone.rows
    parts = len(load_document("three-tanks").experiments)
    assert [each.done for each in told] == list(range(1, parts + 1))
    assert {each.of for each in told} == {parts}
