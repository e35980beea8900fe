"""The page of a controller on many plants, as a browser shows it."""

import pytest

import clepsydra as cl

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("robustness") / "robustness.html"
    plant = cl.load("quadruple-tank")
    cl.robustness(cl.design.simc(plant), plant, draws=80).report(path)
    return path


def test_it_is_for_everyone_at_every_width(page, opened, look, findings):
    shown = opened(page, **look)
    assert findings(shown) == []
    wide = shown.evaluate("document.documentElement.scrollWidth - innerWidth")
    assert wide <= 0
    pictures = shown.locator("figure svg")
    assert pictures.count() == 4
    for place in range(4):
        box = pictures.nth(place).bounding_box()
        assert box["height"] > 40.0 and box["width"] > 300.0


def test_what_is_folded_opens(page, opened):
    shown = opened(page, script=False)
    table = shown.get_by_text("What varies", exact=True)
    assert not shown.get_by_role("row", name="tank_3.area").last.is_visible()
    table.first.click()
    assert shown.get_by_text("uniform within 10 %, 25.2 to 30.8 cm²").first.is_visible()
