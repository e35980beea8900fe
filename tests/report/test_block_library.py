"""The pages of the block library show the blocks that are printed, with their ports."""

import re
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from benchmarks.exported import library

REMEDY = "run python -m benchmarks.exported.library and look at the pictures"


@pytest.fixture(scope="module")
def pages():
    return {page: page.read_text(encoding="utf-8") for page in library.PAGES}


def test_every_block_stands_on_one_page(pages):
    shown = [n for text in pages.values() for _, names, _ in library.MARKED.findall(text)
             for n in names.split()]  # fmt: skip
    assert sorted(shown) == sorted(library.library())


def test_ports_and_words_are_those_of_the_code(pages):
    for page, text in pages.items():
        assert library.filled(page) == text, REMEDY


def test_pictures_are_those_of_the_code(pages):
    there = {path.name: path.read_text(encoding="utf-8") for path in library.PICTURES.glob("*.svg")}
    drawn = library.pictures()
    assert there.keys() == drawn.keys(), REMEDY
    assert [name for name in drawn if drawn[name] != there[name]] == [], REMEDY
    asked = re.findall(r"\]\(blocks/(.+?)\)", "".join(pages.values()))
    assert sorted(asked) == sorted(drawn)


def test_every_section_of_blocks_has_an_equation(pages):
    for text in pages.values():
        for section in re.split(r"^##+ ", text, flags=re.MULTILINE)[1:]:
            if library.MARKED.search(section):
                assert re.search(r"^    \S.*[=:]", section, re.MULTILINE), section.splitlines()[0]
