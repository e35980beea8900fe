"""The pages of the documents agree with one another and lie whole in their folder.

That the counts of a page are those of the audit is tested where the audit of its document runs.
"""

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from clepsydra.papers.document import documents, load_document

FOLDER = Path(__file__).parents[2] / "docs" / "papers"
SENTENCE = re.compile(
    r"Of (\d+) printed numbers and formulas (\d+) are reproduced, (\d+) are misprints, and "
    r"(\d+) cannot be reproduced; of (\d+) claims (\d+) hold\. Outside the count stand "
    r"(\d+) rows that are consistent with what they were solved from, (\d+) that the text's "
    r"conversion seems to have damaged, and (\d+) remarks of ours\."
)
LARGEST_PICTURE = 100_000  # bytes


def page(key):
    return (FOLDER / f"{key}.md").read_text("utf-8")


def counts(key):
    """Rows that count, and all verdicts, as the page of a document prints them."""
    (found,) = SENTENCE.findall(page(key))
    numbers, reproduced, misprints, others, claims, hold, *outside = map(int, found)
    assert numbers == reproduced + misprints + others
    return numbers + claims, reproduced, misprints, others, hold, claims - hold, *outside


def overview():
    """Key to the numbers of its line in the table of all documents."""
    lines = re.findall(r"^\| \[[^]]+\]\(([a-z-]+)\.md\) \|(.+)\|$", page("README"), re.MULTILINE)
    return {
        key: tuple(map(int, re.findall(r"\| *(\d+) *(?=\|)", f"|{row}|"))) for key, row in lines
    }


def test_every_document_has_its_line_in_the_table_and_its_counts_there():
    assert overview() == {key: counts(key) for key in documents()}


def test_the_sum_below_the_table_is_that_of_its_lines():
    sums = tuple(map(sum, zip(*overview().values(), strict=True)))
    (line,) = re.findall(r"^\| all \|(.+)$", page("README"), re.MULTILINE)
    assert tuple(map(int, re.findall(r"\d+", line))) == sums


def test_the_first_page_of_the_project_has_the_sums():
    text = (FOLDER.parents[1] / "README.md").read_text("utf-8")
    (found,) = SENTENCE.findall(text)
    rows, reproduced, misprints, others, hold, fail, *outside = map(
        sum, zip(*overview().values(), strict=True)
    )
    assert rows == reproduced + misprints + others + hold + fail
    numbers = rows - hold - fail
    assert tuple(map(int, found)) == (
        numbers, reproduced, misprints, others, hold + fail, hold, *outside,
    )  # fmt: skip


@pytest.mark.parametrize("key", documents())
def test_a_page_names_its_document_and_its_command(key):
    text, document = page(key), load_document(key)
    assert document.title.casefold() in text.casefold()
    assert f"`clepsydra papers {key}`" in text


@pytest.mark.parametrize("key", ["README", *documents()])
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
