"""The page of a study as its reader handles it."""

import json
import re

import pytest

from clepsydra.process.catalogue_names import catalogue_names

pytestmark = pytest.mark.browser
PROCESS = "quadruple-tank"


@pytest.fixture
def page(report, opened):
    return opened(report(PROCESS))


def data_of(page):
    return json.loads(page.locator("#data").inner_text())


def row(page, name):
    return page.locator(".ranking tbody tr").filter(has=page.get_by_text(name, exact=True))


def legend(page):
    return page.locator(".legend span:not(.hint)").all_inner_texts()


def readout(page, event, signal):
    section = page.locator("#overlay section").filter(has=page.get_by_text(event, exact=True))
    return section.locator(".chart").filter(has_text=signal).locator(".readout")


def beyond(page):
    """Return by how much a page is wider than its window [px]."""
    return page.evaluate("document.documentElement.scrollWidth - window.innerWidth")


@pytest.mark.parametrize("process", catalogue_names())
def test_each_process_has_a_page_that_is_whole_at_each_width(report, opened, look, process):
    page = opened(report(process), **look)
    assert page.locator("h1").inner_text().startswith("Use ")
    assert page.locator(".chart canvas").first.is_visible()
    assert beyond(page) <= 0


@pytest.mark.parametrize("process", catalogue_names())
def test_a_page_is_small_and_prints_on_six_sheets_at_most(report, opened, printed, process):
    path = report(process)
    assert path.stat().st_size < 1e6
    assert printed(opened(path)) <= 6


def test_everyone_can_read_it(report, opened, look, findings):
    page = opened(report(PROCESS), **look)
    assert findings(page) == []
    for fold in page.locator("#details > details > summary").all()[:2]:
        fold.click()
    assert findings(page) == []
    assert beyond(page) <= 0


def test_the_first_screen_shows_the_recommended_and_its_rival(page):
    recommended = page.locator("h1").inner_text().partition(": ")[0].removeprefix("Use ")
    assert legend(page)[0] == recommended
    assert len(legend(page)) == 2
    titles = page.locator("#overlay > .events h3").all_inner_texts()
    assert titles[0] == "Setpoint level_1 +2 cm" and titles[-1] == "Measurement noise"


def test_the_ranking_sorts_by_the_numbers_of_a_column_both_ways(page):
    head = page.get_by_role("columnheader", name="settles")
    cells = page.locator(".ranking tbody td:nth-child(5)")

    def values():
        found = cells.evaluate_all("cells => cells.map(cell => cell.dataset.value)")
        return [float(value) for value in found]

    before = values()
    head.get_by_role("button").click()
    assert values() == sorted(before) != before
    assert head.get_attribute("aria-sort") == "ascending"
    head.get_by_role("button").click()
    assert values() == sorted(before, reverse=True)


def test_a_tick_shows_a_controller_in_all_pictures_and_takes_it_away(page):
    name = "PI, AMIGO"
    tick = row(page, name).get_by_role("checkbox")
    point = page.locator(".point[title*='. PI, AMIGO:']")
    tick.check()
    assert legend(page)[-1] == name
    assert point.get_attribute("aria-pressed") == "true"
    page.locator(".chart .u-over").first.hover()
    assert readout(page, "Setpoint level_1 +2 cm", "tank_1.level").locator(
        "span:not(.when)"
    ).count() == 3  # fmt: skip
    point.click()
    assert not tick.is_checked() and name not in legend(page)


def test_one_cursor_stands_in_all_charts(page):
    page.locator(".chart .u-over").nth(1).hover()
    times = {
        signal: readout(page, event, signal).locator(".when").inner_text()
        for event, signal in (
            ("Setpoint level_1 +2 cm", "tank_1.level"),
            ("Setpoint level_1 +2 cm", "pump_2"),
            ("Setpoint level_2 +2 cm", "tank_2.level"),
        )
    }
    (seconds,) = {float(re.match(r"([\d.]+) s", words).group(1)) for words in times.values()}
    assert seconds > 0.0


def test_the_readout_is_the_value_of_the_run_and_its_difference_from_a_mark(page):
    data = data_of(page)
    event, place = data["events"][0], data["first"][0]
    trace, total, curve = event["traces"][0], 0, []
    for difference in trace["curves"][place]:
        total += difference
        curve.append(total * trace["step"])
    chart = page.locator(".chart").first
    over = chart.locator(".u-over")
    width = over.bounding_box()["width"]
    readouts = readout(page, event["title"], data["signals"][0]["name"])
    value = readouts.locator("span:not(.when)").first

    def told():
        return float(value.inner_text().split(" ")[0].replace("−", "-"))

    over.hover(position={"x": 2, "y": 20})
    start = told()
    assert start == pytest.approx(curve[0], abs=0.01)
    over.click(position={"x": 2, "y": 20})
    over.hover(position={"x": width - 2, "y": 20})
    assert told() == pytest.approx(14.26, abs=0.02)  # 2 cm above where it rests
    difference = re.search(r"\(([+−][\d.]+)\)", value.inner_text()).group(1)
    assert float(difference) == pytest.approx(told() - start, abs=0.011)
    over.click(position={"x": 2, "y": 20})
    over.hover(position={"x": width - 2, "y": 20})
    assert "(" not in value.inner_text()


def test_a_drag_zooms_all_charts_of_an_event_and_a_double_click_goes_back(page):
    charts = page.locator("#overlay section").first.locator(".chart .u-over")
    box = charts.first.bounding_box()

    def when(chart, share):
        width = chart.bounding_box()["width"]
        chart.hover(position={"x": share * width, "y": 20})
        words = page.locator("#overlay section").first.locator(".when").first.inner_text()
        return float(words.split(" ")[0].replace("−", "-"))

    whole = when(charts.nth(2), 0.9)
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 25, steps=4)
    page.mouse.up()
    assert when(charts.nth(2), 0.9) < 0.5 * whole
    charts.first.dblclick()
    assert when(charts.nth(2), 0.9) == pytest.approx(whole, rel=0.01)


def test_the_keyboard_moves_the_cursor_marks_and_zooms(page):
    chart = page.locator(".chart [role=img]").first
    chart.focus()
    when = page.locator(".when").first
    for _ in range(3):
        page.keyboard.press("Shift+ArrowRight")
    later = float(when.inner_text().split(" ")[0])
    assert later > 0.0
    page.keyboard.press("Enter")
    page.keyboard.press("ArrowRight")
    assert "(+" in when.inner_text()
    page.keyboard.press("Escape")
    page.keyboard.press("ArrowRight")
    assert "(" not in when.inner_text()


def test_the_settings_are_copied_as_a_table(page):
    page.get_by_role("button", name="Copy the settings").click()
    page.get_by_text("Copied").wait_for()
    copied = page.evaluate("navigator.clipboard.readText()")
    lines = [line.split("\t") for line in copied.splitlines()]
    assert lines[0] == ["", "level_1 by pump_1", "level_2 by pump_2"]
    assert [line[0] for line in lines[1:]] == ["K", "K [%/%]", "Ti", "b", "ISA form, every 1 s."]


def test_what_is_folded_is_filled_when_it_is_opened(page):
    fold = page.locator("#details > details").first
    assert fold.locator("table").count() == 0
    fold.locator("summary").first.click()
    fold.locator("table").first.wait_for()
    assert page.locator("details[open]").count() == 1


def test_folded_parts_have_at_most_20_000_words_and_300_kb(page):
    folded = "[...document.querySelectorAll('#details template')].map(each => each.innerHTML)"
    texts = page.evaluate(folded)
    assert sum(map(len, texts)) < 300e3
    words = re.sub(r"<[^>]*>", " ", " ".join(texts)).split()
    assert 5_000 < len(words) < 20_000


def test_without_script_first_screen_and_ranking_are_there_with_a_still_picture(report, opened):
    page = opened(report(PROCESS), script=False)
    assert page.locator(".cards").is_visible()
    assert page.locator(".still svg").is_visible()
    assert page.locator(".ranking tbody tr").count() > 20
    assert page.locator(".uplot").count() == 0
