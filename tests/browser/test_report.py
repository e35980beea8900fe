"""The page of a study as its reader handles it."""

import json
import re
from itertools import pairwise

import pytest

from clepsydra.process.catalogue_names import catalogue_names

pytestmark = pytest.mark.browser
PROCESS = "quadruple-tank"
#: Dark pixels in each column of a canvas, and those that have the colour of a curve.
COLUMNS = """place => {
    const canvas = place.querySelector("canvas");
    const { data, width } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const style = getComputedStyle(document.documentElement);
    const rgb = name => style.getPropertyValue(name).match(/[0-9a-f]{2}/g).map(each => `0x${each}`);
    const ink = rgb("--ink"), curves = [0, 1, 2, 3, 4, 5, 6, 7].map(each => rgb(`--curve-${each}`));
    const near = (at, colour) => colour.every((each, n) => Math.abs(data[at + n] - each) < 24);
    const columns = new Array(width).fill(0);
    let coloured = 0;
    for (let at = 0; at < data.length; at += 4) {
        if (data[at + 3] < 100) continue;
        if (near(at, ink)) columns[(at / 4) % width] += 1;
        if (curves.some(each => near(at, each))) coloured += 1;
    }
    return [columns, coloured];
}"""


#: Keep what is written at the left of each chart, from its lowest mark to its highest, until the
#: chart is drawn once more.
MARKS = """() => {
    window.marks = new Map();
    const { clearRect: cleared, fillText: written } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.clearRect = function () {
        window.marks.delete(this.canvas);
        return cleared.apply(this, arguments);
    };
    CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
        if (this.textAlign === "right" && this.canvas.closest("#overlay")) {
            if (!window.marks.has(this.canvas)) window.marks.set(this.canvas, []);
            window.marks.get(this.canvas).push(text);
        }
        return written.apply(this, arguments);
    };
}"""
#: Whether more than five charts were drawn anew. A function, as the page's own policy forbids to
#: evaluate a text in each frame until it is so.
REDRAWN = "() => window.marks.size > 5"
#: Lets what stands for a moment stay.
LASTING = "window.setTimeout = () => 0"
#: When something was painted first [ms].
PAINTED = """() => new Promise(done => new PerformanceObserver(list => {
    for (const { name, startTime } of list.getEntries())
        if (name === "first-contentful-paint") done(startTime);
}).observe({ type: "paint", buffered: true }))"""


@pytest.fixture
def page(report, opened):
    return opened(report(PROCESS))


def drawn(page):
    """Wait until the page has answered: what the mouse does waits for a frame."""
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def data_of(page):
    return json.loads(page.locator("#data").inner_text())


def row(page, name):
    return page.locator(".ranking tbody tr").filter(has=page.get_by_text(name, exact=True))


def legend(page):
    return page.locator(".legend span:not(.hint)").all_inner_texts()


def readout(page, event, signal):
    section = page.locator("#overlay section").filter(has=page.get_by_text(event, exact=True))
    return section.locator(".chart").filter(has_text=signal).locator(".readout")


def hidden(page, what):
    """Return what of a kind is cut off at its side."""
    cut = "found => found.filter(each => each.scrollWidth > each.clientWidth)"
    return page.locator(what).evaluate_all(f"{cut}.map(each => each.innerText)")


def beyond(page):
    """Return by how much a page is wider than its window [px]."""
    return page.evaluate("document.documentElement.scrollWidth - window.innerWidth")


@pytest.mark.parametrize("process", catalogue_names())
def test_everyone_can_read_the_page_of_each_process_at_each_width(
    report, opened, look, findings, process
):
    page = opened(report(process), **look)
    assert page.locator("h1").inner_text().startswith("Use ")
    assert page.locator(".chart canvas").first.is_visible()
    assert beyond(page) <= 0
    assert findings(page) == []
    assert hidden(page, ".card .wide") == []
    heights = page.locator("#overlay > .events h3").evaluate_all(
        "found => found.map(each => Math.round(each.getBoundingClientRect().height))"
    )
    assert len(set(heights)) == 1  # or the charts of a row would not stand side by side
    paper, drawn = page.evaluate(
        """() => [
            getComputedStyle(document.body).backgroundColor,
            getComputedStyle(document.querySelector(".drawing rect.paper")).fill,
        ]"""
    )
    assert drawn == paper


@pytest.mark.parametrize("process", catalogue_names())
def test_a_page_is_small_unfolds_within_bounds_and_prints_on_six_sheets(
    report, opened, printed, process
):
    path = report(process)
    assert path.stat().st_size < 1e6
    page = opened(path)
    folded = "[...document.querySelectorAll('#details template')].map(each => each.innerHTML)"
    texts = page.evaluate(folded)
    assert sum(len(text.encode()) for text in texts) < 300e3
    words = re.sub(r"<[^>]*>", " ", " ".join(texts)).split()
    assert 3_000 < len(words) < 20_000
    sheets = printed(page)
    assert 2 <= len(sheets) <= 6
    for sheet in sheets:  # a ranking that goes on has its head again
        rows = re.search(r"^ *\d+ .*(robust|nervous|thin margins) ", sheet, re.MULTILINE)
        assert not rows or "standing" in sheet


@pytest.mark.parametrize("process", catalogue_names())
def test_the_marks_of_an_axis_have_all_their_digits(report, opened, process):
    page = opened(report(process))
    page.evaluate(MARKS)
    page.set_viewport_size({"width": 1300, "height": 900})
    page.wait_for_function(REDRAWN)
    for marks in page.evaluate("[...window.marks.values()]"):
        values = [float(text.replace("−", "-")) for text in marks]
        steps = {f"{after - before:.5e}" for before, after in pairwise(values)}
        (step,) = steps  # one, and so at least two marks
        assert float(step.partition("e")[0]) in (1.0, 2.0, 2.5, 5.0), marks


@pytest.mark.parametrize("process", catalogue_names())
def test_on_a_phone_the_first_numbers_of_the_ranking_and_small_plants_are_whole(
    report, opened, process
):
    page = opened(report(process), width=420)
    first, room = (
        page.locator(each).bounding_box()
        for each in (".ranking tbody td:nth-child(5) >> nth=0", "#ranking .wide")
    )
    padding = 6.0
    assert first["x"] + first["width"] - padding <= room["x"] + room["width"]
    plant = page.locator(".drawing svg")
    full = page.evaluate("document.querySelector('.drawing svg').viewBox.baseVal.width")
    assert plant.bounding_box()["width"] >= 0.57 * full  # words of 12 px stay above 6 px
    if full < 680:
        assert page.locator(".drawing").evaluate("each => each.scrollWidth - each.clientWidth") == 0


def test_everyone_can_read_what_is_unfolded(report, opened, look, findings):
    from playwright.sync_api import expect

    page = opened(report(PROCESS), **look)
    for fold in page.locator("#details > details > summary").all():
        fold.click()
    # A fold is filled when the browser says that it was opened; one stands within another.
    expect(page.locator("#details > details template")).to_have_count(1)
    page.get_by_text("The blocks of its export").first.click()
    page.locator(".picture svg.blocks").first.wait_for()
    paper, *blocks = page.evaluate(
        """() => [document.body, ...document.querySelectorAll(".picture svg.blocks")]
            .map(each => getComputedStyle(each).backgroundColor)"""
    )
    assert blocks and set(blocks) <= {"rgba(0, 0, 0, 0)", paper}
    assert findings(page) == []
    assert beyond(page) <= 0


def test_the_first_screen_is_painted_within_300_ms(report, opened):
    """The largest page, the best of five: what a busy machine adds is not the page's."""
    path = max(map(report, catalogue_names()), key=lambda path: path.stat().st_size)
    assert min(opened(path).evaluate(PAINTED) for _ in range(5)) < 300.0


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
    from playwright.sync_api import expect

    name = "PI, AMIGO"
    tick = row(page, name).get_by_role("checkbox")
    point = page.locator(".point[title*='. PI, AMIGO:']")
    tick.check()
    assert legend(page)[-1] == name
    assert point.get_attribute("aria-pressed") == "true"
    page.locator(".chart .u-over").first.hover()
    told = readout(page, "Setpoint level_1 +2 cm", "level_1").locator("span")
    expect(told).to_have_count(3)
    point.click()
    assert not tick.is_checked() and name not in legend(page)


def test_where_colours_are_used_again_lines_and_what_names_them_are_broken(page):
    """The ninth has the colour of the first, and a gap in each mark of it."""
    for tick in page.locator(".ranking tbody input").all():
        if not tick.is_checked() and len(legend(page)) < 9:
            tick.click()
    page.locator("#overlay .chart .u-over").first.hover()
    drawn(page)
    names = legend(page)
    marks = page.evaluate(
        """names => {
            const look = each => getComputedStyle(each, "::before").backgroundImage;
            const row = name => [...document.querySelectorAll(".ranking .shown th")]
                .find(each => each.innerText.startsWith(name));
            const of = places => [places.at(0), places.at(-1)];
            return [
                of([...document.querySelectorAll(".legend span:not(.hint)")]),
                of([...document.querySelector(".readout:has(span)").querySelectorAll("span")]),
                of(names.map(row)),
            ].map(two => two.map(look));
        }""",
        names,
    )
    for solid, broken in marks:
        assert "gradient" in solid and broken != solid
        colour = re.search(r"rgb\([^)]*\)", solid).group()
        assert colour in broken
        assert "6px" in broken and "6px" not in solid


def test_a_tick_shows_a_curve_in_each_chart(page):
    from playwright.sync_api import expect

    row(page, "PI, AMIGO").get_by_role("checkbox").check()
    for chart in page.locator("#overlay > .events .chart").all():
        chart.locator(".u-over").hover()
        expect(chart.locator(".readout span")).to_have_count(3)
    page.locator("#sensitivity .u-over").hover()
    expect(page.locator("#sensitivity .note")).to_contain_text("PI, AMIGO")


def test_a_cursor_in_the_sensitivity_stays_when_another_curve_is_shown(page):
    from playwright.sync_api import expect

    note = page.locator("#sensitivity .note")
    page.locator("#sensitivity .u-over").hover()
    expect(note).to_contain_text("rad/s")
    # By key, so that the mouse stays.
    row(page, "PI, AMIGO").get_by_role("checkbox").press("Space")
    expect(note).to_contain_text("PI, AMIGO")


@pytest.mark.parametrize("process", catalogue_names())
def test_the_map_has_errors_of_other_sizes_at_other_heights(report, opened, process):
    page = opened(report(process))
    errors = [each["error"] for each in data_of(page)["controllers"]]
    assert None not in errors and max(errors) < 1000  # else some would stand at the edge
    assert "beyond it" not in page.locator("#map").inner_text()
    tops = dict(
        page.locator(".point").evaluate_all(
            "found => found.map(each => [Number(each.textContent), parseFloat(each.style.top)])"
        )
    )
    order = sorted(tops, key=lambda number: errors[number - 1])
    for place, low in enumerate(order):
        for high in order[place:]:
            if errors[high - 1] > 10.0 * errors[low - 1]:
                assert tops[high] < tops[low], (low, high)


@pytest.mark.parametrize("process", ["quadruple-tank-nonminimum-phase", "equalisation-tank"])
def test_the_map_keeps_controllers_on_their_side_of_the_limit(report, opened, process):
    page = opened(report(process))
    peaks = [each["peak"] for each in data_of(page)["controllers"]]
    shares = page.locator(".point").evaluate_all(
        "found => found.map(each => [Number(each.textContent), parseFloat(each.style.left)])"
    )
    columns, curves = page.locator("#map").evaluate(COLUMNS)
    limit = columns.index(max(columns)) / page.evaluate("devicePixelRatio")
    inset = page.evaluate(
        """() => document.querySelector("#map .u-over").getBoundingClientRect().left
        - document.querySelector("#map canvas").getBoundingClientRect().left"""
    )
    assert max(columns) > 100 and curves == 0  # the limit is drawn, in the colour of no curve
    for number, left in shares:
        assert (left + inset <= limit + 2.0) is (peaks[number - 1] <= 2.0), number


def test_one_cursor_stands_in_all_charts(page):
    page.locator(".chart .u-over").nth(1).hover()
    drawn(page)
    for event in ("Setpoint level_1 +2 cm", "Setpoint level_2 +2 cm"):
        for signal in ("level_1", "level_2", "pump_1", "pump_2"):
            values = readout(page, event, signal).locator("span").all_inner_texts()
            assert len(values) == 2 and all(float(value) > 0.0 for value in values)
    times = set(page.locator("#overlay section:visible .when").all_inner_texts())
    (seconds,) = {float(re.fullmatch(r"([\d.]+) s", words).group(1)) for words in times}
    assert seconds > 0.0


def test_the_readout_is_the_value_of_the_run_and_its_difference_from_a_mark(page):
    from playwright.sync_api import expect

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
    value = readouts.locator("span").first

    def told():
        drawn(page)
        return float(value.inner_text().split(" ")[0].replace("−", "-"))

    over.hover(position={"x": 2, "y": 20})
    start = told()
    assert start == pytest.approx(curve[0], abs=0.01)
    over.click(position={"x": 2, "y": 20})
    drawn(page)
    over.hover(position={"x": width - 2, "y": 20})
    assert told() == pytest.approx(14.26, abs=0.02)  # 2 cm above where it rests
    drawn(page)
    difference = re.search(r"\(([+−][\d.]+)\)", value.inner_text()).group(1)
    assert float(difference) == pytest.approx(told() - start, abs=0.011)
    over.click(position={"x": 2, "y": 20})
    over.hover(position={"x": width - 2, "y": 20})
    expect(value).not_to_contain_text("(")


def test_no_chart_moves_under_the_mouse_and_a_hand_that_trembles_clicks(page):
    over = page.locator(".chart .u-over").first
    box, when = over.bounding_box(), page.locator(".when").first
    x, y = box["x"] + box["width"] / 2, box["y"] + 20
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 2, y + 1)
    page.mouse.up()
    page.mouse.move(x + 60, y)
    drawn(page)
    assert "(+" in when.inner_text()
    assert over.bounding_box() == box


def test_a_drag_zooms_all_charts_of_an_event_and_a_double_click_goes_back(page):
    charts = page.locator("#overlay section").first.locator(".chart .u-over")
    box = charts.first.bounding_box()

    def when(chart, share):
        width = chart.bounding_box()["width"]
        chart.hover(position={"x": share * width, "y": 20})
        drawn(page)
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


def test_all_that_the_mouse_does_the_keyboard_does(page):
    def press(place, key):
        place.focus()
        page.keyboard.press(key)

    head = page.get_by_role("columnheader", name="settles")
    press(head.get_by_role("button"), "Enter")
    assert head.get_attribute("aria-sort") == "ascending"
    tick = row(page, "PI, AMIGO").get_by_role("checkbox")
    press(tick, "Space")
    assert legend(page)[-1] == "PI, AMIGO"
    press(page.locator(".point[title*='. PI, AMIGO:']"), "Enter")
    assert not tick.is_checked()
    fold = page.locator("#details > details").first
    press(fold.locator("summary").first, "Enter")
    fold.locator("table").first.wait_for()
    page.evaluate(LASTING)
    press(page.get_by_role("button", name="Copy the settings"), "Enter")
    page.get_by_text("Copied").wait_for()
    chart = page.locator(".chart [role=img]").first
    press(chart, "Shift+ArrowRight")
    when = page.locator(".when").first
    whole = float(when.inner_text().split(" ")[0])
    press(chart, "+")
    page.keyboard.press("Shift+ArrowRight")
    near = float(when.inner_text().split(" ")[0])
    assert 0.0 < near - whole < whole + 0.1
    page.keyboard.press("Escape")
    page.keyboard.press("Shift+ArrowRight")
    assert float(when.inner_text().split(" ")[0]) > near


def test_the_settings_are_copied_as_a_table(page):
    page.evaluate(LASTING)
    page.get_by_role("button", name="Copy the settings").click()
    page.get_by_text("Copied").wait_for()
    copied = page.evaluate("navigator.clipboard.readText()")
    lines = [line.split("\t") for line in copied.splitlines()]
    assert lines[0] == ["", "level_1 by pump_1", "level_2 by pump_2"]
    ending = ("action", "ISA form, every 1 s.")
    assert [line[0] for line in lines[1:]] == ["K", "K [%/%]", "Ti", "b", *ending]


def test_what_is_folded_is_filled_when_it_is_opened(page):
    fold = page.locator("#details > details").first
    assert fold.locator("table").count() == 0
    fold.locator("summary").first.click()
    fold.locator("table").first.wait_for()
    assert page.locator("details[open]").count() == 1


@pytest.mark.parametrize("process", catalogue_names())
def test_without_script_first_screen_and_ranking_are_there_with_a_still_picture(
    report, opened, process
):
    page = opened(report(process), script=False)
    assert page.locator(".cards").is_visible()
    assert page.locator(".still svg").is_visible()
    assert page.locator(".ranking tbody tr").count() >= 19
    assert page.locator(".ranking .shown").count() == 2
    assert page.locator(".uplot").count() == 0
