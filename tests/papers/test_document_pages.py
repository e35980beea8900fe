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


def without_headlines(text):
    """A text without how many headline claims hold, which the audit of a document alone tells."""
    return re.sub(r" Of the \d+ headline claims [^.]+\.", "", text)


def sentence(columns):
    """What a page says of the numbers of a line of the table, of which the first is their sum."""
    rows, reproduced, bare, *counts = columns
    given = dict(zip(VERDICTS, (reproduced, *counts), strict=True))
    assert rows == sum(given[verdict] for verdict in COUNTED) and bare <= reproduced
    return summary_of(given, bare)


def test_every_document_has_its_line_in_the_table_and_says_its_counts():
    table = overview()
    assert set(table) == set(documents())
    for key, columns in table.items():
        assert sentence(columns) in without_headlines(page(key))


def test_the_sum_below_the_table_is_that_of_its_lines():
    sums = tuple(map(sum, zip(*overview().values(), strict=True)))
    (line,) = re.findall(r"^\| all \|(.+)$", page("README"), re.MULTILINE)
    assert tuple(map(int, re.findall(r"\d+", line))) == sums


def test_the_first_page_of_the_project_has_the_sums():
    text = (FOLDER.parents[1] / "README.md").read_text("utf-8")
    sums = tuple(map(sum, zip(*overview().values(), strict=True)))
    assert sentence(sums) in without_headlines(text)


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
