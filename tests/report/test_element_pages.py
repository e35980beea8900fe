"""The pages of elements: each has its picture, equation, source and computed example."""

import re
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import element_pictures as drawn

ROOT = drawn.ROOT
REMEDY = "run python tools/element_pictures.py and look at the pictures"
#: Of each row its picture and its page, without their endings.
GALLERY = re.findall(
    r"^\| (?:!\[\]\(|<img src=\")elements/(\S+)\.svg.+? \| \[.+?\]\(elements/(\S+)\.md\)",
    drawn.GALLERY.read_text(encoding="utf-8"),
    re.MULTILINE,
)
TEXTS = {page: (ROOT / page).read_text(encoding="utf-8") for page in drawn.PAGES}


@pytest.mark.parametrize("page", drawn.PAGES)
def test_a_page_has_table_picture_equation_example_and_source(page):
    """In this order."""
    parts = (
        r"^`\[\w+\.NAME(\.\w+)?\]`", r"^!\[.+\]\(", r"^> .*[=≥]", r"^\| key \|",
        r"^## A computed example", r"[Bb]y hand", r"^```pycon", r"^## Source",
    )  # fmt: skip
    places = [re.search(part, TEXTS[page], re.MULTILINE) for part in parts]
    assert all(places), [part for part, place in zip(parts, places, strict=True) if not place]
    assert sorted(place.start() for place in places) == [place.start() for place in places]


@pytest.mark.parametrize("page", drawn.PAGES)
def test_pictures_are_those_of_the_code_and_examples_hold(page):
    for name, svg in drawn.pictures(page).items():
        assert (drawn.FOLDER / name).read_text(encoding="utf-8") == svg, f"{name}: {REMEDY}"


def test_every_picture_is_shown_on_a_page():
    shown = {
        (drawn.FOLDER / link).resolve()
        for text in TEXTS.values()
        for link in re.findall(r"\]\((\S+\.svg)\)", text)
    }
    shown |= {ROOT / "docs" / "elements" / f"{picture}.svg" for picture, _ in GALLERY}
    assert shown == set(drawn.FOLDER.rglob("*.svg")), REMEDY


def test_the_gallery_shows_every_page_with_a_picture_of_its_own():
    assert sorted(page for _, page in GALLERY) == [Path(page).stem for page in drawn.PAGES]
    assert all(Path(picture).name.startswith(page) for picture, page in GALLERY)
