"""The audit from the command line."""

import json
import os
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

PAGE = Path(__file__).parents[2] / "docs/papers/against-the-limit.md"
NAMES = [
    "document",
    "place",
    "line",
    "name",
    "printed",
    "computed",
    "unit",
    "difference",
    "verdict",
    "reason",
    "text",
]


VERDICTS = {
    "reproduced", "misprint", "not reproducible", "claim holds", "claim fails", "consistent",
    "damaged text", "remark",
}  # fmt: skip


@pytest.mark.thorough
def test_document_and_page_show_every_row_and_every_figure(command, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)  # others would load everything anew
    status, out, _ = command("papers", "three-tanks", "--json")
    rows = json.loads(out)
    assert status == 0 and not Path("papers.html").exists()
    assert all(list(row) == NAMES for row in rows)
    assert {row["document"] for row in rows} == {"three-tanks"}
    assert {row["verdict"] for row in rows} <= VERDICTS
    period = next(row for row in rows if row["name"] == "Pu")
    assert period["printed"] == 0.034 and period["verdict"] == "misprint"
    assert period["difference"] == pytest.approx(period["computed"] / 0.034 - 1.0)
    assert not any(row["reason"] == "" for row in rows if row["verdict"] != "reproduced")

    status, out, _ = command("papers", "three-tanks", "--all")
    page = Path("papers.html").read_text("utf-8")
    assert status == 0 and "what is not as printed" in out and "papers.html" in out
    assert all(len(line) <= 100 for line in out.splitlines())
    figures = ["4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14"]
    assert all(re.search(rf">Fig\. {number} \w", page) for number in figures)
    assert page.count("<svg") == len(figures)
    assert "What it concludes" in page and "what three-tanks concludes" in out
    for part in page.split("<svg")[1:]:
        ElementTree.fromstring("<svg" + part.split("</svg>")[0] + "</svg>")
    for row in rows:
        assert f">{row['place']}<" in page, row


@pytest.mark.thorough
def test_a_document_is_judged_in_a_screen(at_widths, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    told = at_widths("papers", "three-tanks")
    for columns in (80, 100):
        lines = [line.rstrip() for line in told[columns].splitlines()]
        assert len(lines) <= 25 and max(map(len, lines)) <= columns


@pytest.mark.thorough
def test_controllers_of_a_document_and_ours_stand_beside_the_limit_as_on_the_page(
    command, monkeypatch
):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    status, out, _ = command("papers", "eight-tanks", "--limit", "--json", "--output", ".")
    rows = json.loads(out)
    assert status == 0 and {row["document"] for row in rows} == {"eight-tanks"}
    assert sum(row["published"] for row in rows) == 6
    assert sum(row["recommended"] for row in rows) == 1
    written = Path("against-the-limit.md").read_text("utf-8")
    sections = [
        re.search(r"\n### Every minute\n.*?(?=\n## )", page, re.DOTALL)[0]
        for page in (written, PAGE.read_text("utf-8"))
    ]
    words, numbers = (
        [re.findall(pattern, each) for each in sections] for pattern in (r"[^\d.]+", r"[\d.]*\d")
    )
    assert words[0] == words[1]
    # But for the last digits.
    for one, other in zip(*numbers, strict=True):
        assert float(one) == pytest.approx(float(other), rel=0.01)


def test_an_unknown_document_is_refused_with_the_names_that_there_are(command):
    status, out, error = command("papers", "three-tank")
    assert status == 2 and out == "" and "Traceback" not in error
    assert "perhaps 'three-tanks' was meant" in " ".join(error.split())
