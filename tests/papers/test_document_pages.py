"""The pages of the documents agree with one another and lie whole in their folder.

That the counts of a page are those of the audit is tested where the audit of its document runs.
"""

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from clepsydra.papers.audit import summary_of
from clepsydra.papers.document import documents, load_document
from clepsydra.papers.row import COUNTED, VERDICTS

FOLDER = Path(__file__).parents[2] / "docs" / "papers"
LARGEST_PICTURE = 100_000  # bytes


def page(key):
    return (FOLDER / f"{key}.md").read_text("utf-8")


def overview():
    """Key to the numbers of its line in the table of all documents."""
    lines = re.findall(r"^\| \[[^]]+\]\(([a-z-]+)\.md\) \|(.+)\|$", page("README"), re.MULTILINE)
    return {
        key: tuple(map(int, re.findall(r"\| *(\d+) *(?=\|)", f"|{row}|"))) for key, row in lines
    }


def headline_claims():
    """Key, or "together", to how many headline claims there are, hold, fail and are left open."""
    text = page("README")
    table = text[text.index("| headline claims |") :].split("\n\n")[0]
    lines = re.findall(r"^\| ([a-z-]+) \|([\d |]+)\|$", table, re.MULTILINE)
    return {key: tuple(map(int, numbers.split("|"))) for key, numbers in lines}


def sentence(columns, headlines):
    """What a page says of the numbers of its lines in both tables, each first their sum."""
    rows, reproduced, bare, *counts = columns
    given = dict(zip(VERDICTS, (reproduced, *counts), strict=True))
    assert rows == sum(given[verdict] for verdict in COUNTED) and bare <= reproduced
    total, *found = headlines
    assert total == sum(found)
    judged = ("claim holds", "claim fails", "remark")
    return summary_of(given, bare, dict(zip(judged, found, strict=True)))


def sums_of(table):
    return tuple(map(sum, zip(*table.values(), strict=True)))


def test_every_document_has_its_line_in_both_tables_and_says_its_counts():
    table, headlines = overview(), headline_claims()
    assert set(table) == set(documents()) == set(headlines) - {"together"}
    for key, columns in table.items():
        assert sentence(columns, headlines[key]) in page(key)


def test_the_sums_below_the_tables_are_those_of_their_lines():
    (line,) = re.findall(r"^\| all \|(.+)$", page("README"), re.MULTILINE)
    assert tuple(map(int, re.findall(r"\d+", line))) == sums_of(overview())
    headlines = headline_claims()
    assert headlines.pop("together") == sums_of(headlines)


def test_the_first_page_of_the_project_has_the_sums():
    text = (FOLDER.parents[1] / "README.md").read_text("utf-8")
    assert sentence(sums_of(overview()), headline_claims()["together"]) in text


def test_no_page_tells_of_its_own_history():
    for key in ("README", *documents()):
        assert not re.search(
            r"what changed|this audit was|was read again", page(key), re.IGNORECASE
        )


@pytest.mark.parametrize("key", documents())
def test_a_page_names_its_document_and_its_command(key):
    text, document = page(key), load_document(key)
    assert document.title.casefold() in text.casefold()
    assert f"`clepsydra papers {key}`" in text


@pytest.mark.parametrize("key", ["README", "runs", *documents()])
def test_what_a_page_points_to_is_there_and_every_picture_is_shown(key):
    links = re.findall(r"\]\(([^)#]+)\)", page(key))
    for link in links:
        assert link.startswith("http") or (FOLDER / link).is_file(), link
    shown = {link for link in links if link.endswith(".svg")}
    assert shown == {path.name for path in FOLDER.glob(f"{key}-*.svg")}


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.svg")), ids=lambda path: path.stem)
def test_a_picture_is_small_and_whole(path):
    assert path.stat().st_size < LARGEST_PICTURE
    assert ElementTree.fromstring(path.read_bytes()).tag.endswith("svg")
