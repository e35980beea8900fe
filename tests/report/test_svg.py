import re
from xml.etree import ElementTree

import pytest

from clepsydra.report.page import svg_text
from clepsydra.report.recording import controlled_panels
from clepsydra.report.trends import trend_figure


@pytest.fixture(scope="module")
def pictures(run):
    return [
        svg_text(trend_figure(run, controlled_panels(run)), "a < b", prefix)
        for prefix in ("one", "two")
    ]


def test_the_text_is_one_well_formed_element_with_its_title(pictures):
    root = ElementTree.fromstring(pictures[0])
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert root[0].text == "a < b"
    assert root.get("role") == "img"


def test_ids_of_two_pictures_on_a_page_differ_and_references_lead_somewhere(pictures):
    ids = [set(re.findall(r'\bid="([^"]+)"', text)) for text in pictures]
    assert ids[0] and not ids[0] & ids[1]
    for own, text in zip(ids, pictures, strict=True):
        wanted = set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', text))
        assert wanted
        assert {first or second for first, second in wanted} <= own


def test_the_same_figure_gives_the_same_text(run, pictures):
    assert svg_text(trend_figure(run, controlled_panels(run)), "a < b", "one") == pictures[0]


def test_coordinates_are_rounded_and_comments_and_dates_are_gone(pictures):
    assert not re.search(r' d="[^"]*\d\.\d{3}', pictures[0])
    assert "<!--" not in pictures[0]
    assert "metadata" not in pictures[0]
