"""Trends and runs of a laboratory in the hands of its reader."""

import json
from contextlib import contextmanager

import pytest
from lab_hand import KEPT, Hand

import clepsydra as cl

pytestmark = pytest.mark.browser
#: A browser in which there is room for nothing more.
FULL = "Storage.prototype.setItem = () => { throw new DOMException('full', 'QuotaExceededError') };"
FRAMES = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
DROP = """([text, name]) => {
    const files = new DataTransfer();
    files.items.add(new File([text], name));
    dispatchEvent(new DragEvent("drop", { dataTransfer: files, cancelable: true }));
}"""


@pytest.fixture(scope="session")
def rig():
    plant = cl.load("quadruple-tank")
    return plant, [cl.design.simc(plant), cl.design.amigo(plant)]


@pytest.fixture(scope="session")
def page_of_rig(built, rig, tmp_path_factory):
    return cl.lab(*rig, tmp_path_factory.mktemp("runs") / "tanks.html")


#: Asks for a moment of the run, and then for what shows the slider where the rig still is.
ASKED_AND_SHOWN = """() => {
    const slider = document.querySelector("#time input");
    slider.value = "300";
    slider.dispatchEvent(new Event("input"));
    document.querySelector(".modes button").click();
}"""


class Reader(Hand):
    """Who looks at what was done."""

    def said(self):
        return self.page.get_by_role("status").inner_text()

    @property
    def window(self):
        """What tells the time that trends show."""
        return self.page.get_by_label("Trends over").locator("option:checked")

    def see_all(self):
        """Let trends show the whole run, and wait until they do."""
        with self.another(self.window):
            self.press("All")

    def click_trend(self, name, share):
        """Click on a trend, at a share of its width: a cursor stands there."""
        over = self.page.get_by_role("img", name=f"{name} [V]").locator(".u-over")
        over.scroll_into_view_if_needed()
        box = over.bounding_box()
        place = {"x": 1 + share * (box["width"] - 2), "y": box["height"] / 2}
        with self.another(self.page.locator(".between p")):
            over.click(position=place)

    @contextmanager
    def another(self, place):
        """Wait until a place has other words than before."""
        from playwright.sync_api import expect

        before = place.text_content()
        yield
        expect(place).not_to_have_text(before)

    def back(self, sample):
        """Stand where the run stood after so many samples."""
        self.page.get_by_role("slider", name="Go back").fill(str(sample))
        self.frame()

    def frame(self):
        """Let the page draw what was asked for."""
        self.page.evaluate(FRAMES)

    def table(self):
        """Return the scores between the cursors: signal to its cells."""
        rows = self.page.locator(".between tbody tr").all()
        cells = [row.locator("th, td").all_inner_texts() for row in rows]
        return {name: rest for name, *rest in cells}

    def runs(self):
        """Return name and length of each run of the list."""
        rows = self.page.locator("#runs li").all()
        return [
            (row.get_by_role("textbox").input_value(), row.locator(".words").inner_text())
            for row in rows
        ]

    def saved(self):
        return self.page.evaluate("saved.pop()")


@pytest.fixture
def reader(page_of_rig, opened):
    return Reader(opened(page_of_rig, first=KEPT))


def stepped(reader):
    """Let level_1 step, and go on for a while."""
    reader.press("One sample")
    reader.type("Setpoint of level_1", "7")
    reader.run(20, "1000×")


def number(text):
    return float(text.split()[0])


def test_scores_between_cursors_are_those_of_a_replay(reader, rig, tmp_path):
    stepped(reader)
    reader.see_all()
    reader.click_trend("level_1", 0.0)
    reader.click_trend("level_1", 1.0)
    path = tmp_path / "session.json"
    path.write_text(json.dumps(reader.session()), encoding="utf-8")
    scores = cl.replay(path, *rig).scores
    table = reader.table()
    assert number(table["level_1"][3]) == pytest.approx(scores["iae[level_1]"], rel=1e-3)
    assert number(table["pump_2"][6]) == pytest.approx(scores["total_variation[pump_2]"], rel=1e-3)
    assert 0.0 < number(table["level_1"][4]) < 20.0
    assert table["level_2"][4:6] == ["–", "–"]


def test_a_marked_stretch_is_identified(reader, tmp_path):
    for pump in ("pump_1", "pump_2"):
        reader.mode(pump, "Manual")
    reader.run(2, "1000×")
    reader.type("Manual value of pump_1", "3.3")
    reader.run(40, "1000×")
    reader.press("All")
    reader.page.get_by_text("Identify a model").click()
    reader.press("Save its record")
    command = reader.page.locator(".identify code").inner_text().split()
    assert command[:2] == ["clepsydra", "identify"]
    path = tmp_path / command[2]
    path.write_text(reader.saved(), encoding="utf-8")
    found = cl.identify(path, command[4], command[6])
    assert found.models[0].estimates[0].value == pytest.approx(2.6, rel=0.05)  # [V/V]
    reader.page.get_by_text("Or fit numbers of the plant").click()
    reader.page.get_by_label("Fit pump_1.gain").check()
    *_, option, process, parameters, names = (
        reader.page.locator(".identify code").inner_text().split()
    )
    assert (option, parameters) == ("--process", "--parameters")
    fitted = cl.identify(path, plant=process, parameters=names.split(","))
    assert fitted.values["pump_1.gain"] == pytest.approx(3.33e-6, rel=1e-3)  # [m³/(s V)]


def test_a_moment_of_the_past_is_where_another_run_begins(reader, rig, tmp_path):
    stepped(reader)
    reader.back(300)
    assert reader.number("level_1") == pytest.approx(7.0, abs=0.01)
    reader.type("Setpoint of level_1", "4")
    reader.press("One sample")
    assert [name for name, _ in reader.runs()] == ["Run 2", "Run 1"]
    assert "from Run 1 at 5 min" in reader.runs()[0][1]
    reader.run(10, "1000×")
    path = tmp_path / "session.json"
    path.write_text(json.dumps(reader.session()), encoding="utf-8")
    run = cl.replay(path, *rig)
    assert run.values["level_1"][-1] == pytest.approx(reader.number("level_1"), abs=0.005)
    reader.press("Overlay Run 1")
    reader.page.locator("#trends .tools").first.scroll_into_view_if_needed()
    reader.page.locator(".runs-legend").get_by_text("Run 1").wait_for()
    assert reader.page.locator(".runs-legend span").all_inner_texts() == ["Run 2", "Run 1"]
    reader.see_all()
    for share in (0.0, 1.0):
        reader.click_trend("level_1", share)
    rows = reader.page.locator(".between tbody tr").all()
    cells = [row.locator("th, td").all_inner_texts() for row in rows[:2]]
    assert [each[:2] for each in cells] == [
        ["level_1", "Run 2: PI, SIMC"],
        ["level_1", "Run 1: PI, SIMC"],
    ]
    # Both have the first step; the second one is of the branch alone.
    assert number(cells[1][4]) < number(cells[0][4])
    reader.press("Open Run 1")
    assert reader.number("level_1") == pytest.approx(7.0, abs=0.005)


def test_a_moment_that_is_asked_for_is_not_lost_until_the_next_picture(reader):
    from playwright.sync_api import expect

    stepped(reader)
    reader.page.evaluate(ASKED_AND_SHOWN)
    expect(reader.page.get_by_role("slider", name="Go back")).to_have_value("300")


def test_runs_are_named_pinned_and_there_again_when_the_page_is(reader):
    stepped(reader)
    level = reader.number("level_1")
    name = reader.page.get_by_role("textbox", name="Name of the run")
    name.fill("<b>seven</b>")
    name.press("Enter")
    reader.press("Pin <b>seven</b>")
    reader.press("Start empty")
    assert [each for each, _ in reader.runs()] == ["<b>seven</b>", "Run 1"]
    reader.reload()
    reader.press("Open <b>seven</b>")
    reader.page.get_by_role("status").get_by_text("is at its end").wait_for()
    assert reader.number("level_1") == level
    (run, *_) = reader.runs()
    assert run[1].endswith("min, 1 action · PI, SIMC")
    reader.press("Start at rest")
    reader.press("Delete <b>seven</b>")
    reader.reload()
    assert "<b>seven</b>" not in [each for each, _ in reader.runs()]


def test_a_session_that_is_dropped_runs_and_a_wrong_one_is_told(reader):
    stepped(reader)
    level, session = reader.number("level_1"), reader.session()
    reader.press("Start at rest")
    reader.page.evaluate(DROP, [json.dumps(session), "mine.json"])
    reader.page.get_by_role("status").get_by_text("Opened mine.json").wait_for()
    assert reader.number("level_1") == level
    reader.page.evaluate(DROP, [json.dumps(session | {"digest": "0"}), "other.json"])
    reader.page.get_by_role("alert").get_by_text('other.json: digest: got "0"').wait_for()
    assert reader.number("level_1") == level


def test_a_browser_without_room_loses_nothing(page_of_rig, opened):
    reader = Reader(opened(page_of_rig, first=KEPT + FULL))
    stepped(reader)
    assert "no room for more runs" in reader.said()
    assert len(reader.session()["touches"]) == 1


def test_a_page_within_another_one_says_that_runs_are_gone_with_it(page_of_rig, opened):
    barred = "Object.defineProperty(window, 'localStorage', { get() { throw new Error() } });"
    reader = Reader(opened(page_of_rig, first=barred))
    stepped(reader)
    assert "gone when this page is closed" in reader.page.locator("#runs .note").inner_text()
    assert "no room" not in reader.said()


def test_a_trend_is_zoomed_by_keys(reader):
    from playwright.sync_api import expect

    stepped(reader)
    trend = reader.page.get_by_role("img", name="level_1 [V]")
    window, between = reader.window, reader.page.locator(".between")
    with reader.another(window):
        trend.press("Home")
    whole = number(window.inner_text())
    with reader.another(window):
        trend.press("+")
    assert number(window.inner_text()) == pytest.approx(whole / 1.5, rel=0.01)
    for key in ("a", "b", *5 * ["Shift+ArrowRight"]):
        with reader.another(between.locator("p")):
            trend.press(key)
    assert len(reader.table()) == 4
    words = between.locator("p").inner_text()
    assert words.startswith("A at ") and words.endswith("between them")
    trend.press("Escape")
    expect(between).to_be_hidden()


def test_a_trend_is_zoomed_and_moved_by_the_mouse(reader):
    from playwright.sync_api import expect

    stepped(reader)
    reader.see_all()
    mouse, window = reader.page.mouse, reader.window
    whole = number(window.inner_text())
    over = reader.page.get_by_role("img", name="level_1 [V]").locator(".u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()

    def drag(start, stop):
        y = box["y"] + box["height"] / 2
        mouse.move(box["x"] + start * box["width"], y)
        mouse.down()
        mouse.move(box["x"] + stop * box["width"], y, steps=4)
        mouse.up()
        reader.frame()

    def time_at(share):
        mouse.move(box["x"] + share * box["width"], box["y"] + 20)
        reader.frame()
        return number(reader.page.locator(".near").inner_text())

    middle = time_at(0.5)
    with reader.another(window):
        drag(0.25, 0.75)
    assert number(window.inner_text()) == pytest.approx(whole / 2, rel=0.01)
    assert time_at(0.5) == pytest.approx(middle, rel=0.01)
    reader.page.keyboard.down("Shift")
    drag(0.5, 0.75)
    reader.page.keyboard.up("Shift")
    assert time_at(0.75) == pytest.approx(middle, rel=0.01)
    with reader.another(window):
        mouse.wheel(0, 100)
    assert number(window.inner_text()) == pytest.approx(0.6 * whole, rel=0.01)
    assert time_at(0.75) == pytest.approx(middle, rel=0.01)
    with reader.another(window):
        over.dblclick()
    assert number(window.inner_text()) == pytest.approx(whole, rel=0.01)
    expect(reader.page.locator(".between")).to_be_hidden()


def test_a_trend_is_saved_as_a_picture(page_of_rig, opened):
    reader = Reader(opened(page_of_rig, first=KEPT.replace("file.text()", "file")))
    stepped(reader)
    reader.press("PNG of the trend of pump_1")
    reader.page.get_by_role("status").get_by_text("Saved quadruple-tank").wait_for()
    head = "saved[0].slice(0, 24).arrayBuffer().then((bytes) => [...new Uint8Array(bytes)])"
    found = bytes(reader.page.evaluate(head))
    assert found[:8] == b"\x89PNG\r\n\x1a\n"
    assert int.from_bytes(found[16:20], "big") > 1000


def test_a_run_that_was_deleted_is_brought_back(reader):
    stepped(reader)
    reader.press("Start empty")
    reader.press("Delete Run 1")
    assert [name for name, _ in reader.runs()] == ["Run 2"]
    reader.press("Bring back Run 1")
    assert [name for name, _ in reader.runs()] == ["Run 2", "Run 1"]
    reader.press("Open Run 1")
    assert reader.number("level_1") == pytest.approx(7.0, abs=0.005)


def test_what_is_open_is_for_everyone(page_of_rig, opened, look, findings):
    reader = Reader(opened(page_of_rig, **look))
    stepped(reader)
    reader.press("Start empty")
    reader.press("Overlay Run 1")
    for words in ("More trends", "Identify a model", "Or fit numbers"):
        reader.page.get_by_text(words).click()
    reader.page.get_by_label("Trend of level_3").check()
    for share in (0.1, 0.9):
        reader.click_trend("level_1", share)
    assert findings(reader.page) == []
    wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert reader.page.evaluate(wide)
