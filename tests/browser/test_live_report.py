"""What the reader of a report tries: other settings, as they are handled and shown."""

import re

import pytest

pytestmark = pytest.mark.browser
PROCESS = "quadruple-tank"
GAIN = "K, proportional gain from level_1 to pump_1, level_1 by pump_1"
#: Where a chart has the colour of the third curve, so of what is tried.
TRIED = """chart => {
    const canvas = chart.querySelector("canvas");
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const style = getComputedStyle(document.documentElement);
    const own = style.getPropertyValue("--curve-2").match(/[0-9a-f]{2}/g).map(each => `0x${each}`);
    const found = [];
    for (let at = 0; at < data.length; at += 4)
        if (data[at + 3] > 100 && own.every((each, n) => Math.abs(data[at + n] - each) < 24))
            found.push(at / 4);
    return found.join();
}"""


class Reader:
    """Who opened what can be tried, and waited until the study's own settings have run."""

    def __init__(self, page):
        self.page, self.panel = page, page.locator("#live")
        self.panel.locator("summary").click()
        self.panel.get_by_role("row", name=re.compile(r"^max\|S\| \d")).wait_for()

    @property
    def slider(self):
        """The gain of the first loop."""
        return self.panel.get_by_role("slider", name=GAIN)

    @property
    def field(self):
        return self.panel.get_by_role("textbox", name=GAIN)

    def figures(self, title):
        """Return the number of a row as it is tried and as the study has it."""
        row = self.panel.get_by_role("row").filter(has=self.page.get_by_text(title, exact=True))
        return row.get_by_role("cell").all_inner_texts()

    def press(self, key, times=1):
        """Move the slider, and wait each time until what is tried has another max|S|."""
        self.slider.focus()
        for _ in range(times):
            before = self.figures("max|S|")[0]
            self.page.keyboard.press(key)
            self.after(before)

    def after(self, before):
        from playwright.sync_api import expect

        rows = self.panel.get_by_role("row")
        row = rows.filter(has=self.page.get_by_text("max|S|", exact=True))
        expect(row.get_by_role("cell").first).not_to_have_text(before)

    def button(self, name):
        return self.panel.get_by_role("button", name=name)

    def curve(self, before=None):
        """Return what is drawn of the tried settings in the first chart, once that is not `before`.

        A chart that is not seen is drawn when it comes into sight.
        """
        self.page.locator(".chart").first.scroll_into_view_if_needed()
        drawn = f"({TRIED})(document.querySelector('.chart'))"
        self.page.wait_for_function(f"before => {drawn} !== before", arg=before)
        return self.page.evaluate(drawn)

    def legend(self):
        return self.page.locator(".legend span:not(.hint)").all_inner_texts()


@pytest.fixture
def reader(report, opened):
    return Reader(opened(report(PROCESS)))


def test_a_slider_moves_curves_and_figures_by_keyboard(reader):
    assert reader.figures("relative error")[0] == reader.figures("relative error")[1]
    assert len(reader.legend()) == 2 and reader.curve() == ""
    before = float(reader.field.input_value())
    reader.press("PageUp")
    assert reader.legend()[2] == f"{reader.legend()[0]}, changed"
    once = reader.curve(before="")
    error, recommended = reader.figures("relative error")
    assert error != recommended
    reader.press("PageUp")
    assert reader.curve(before=once) != ""
    gain = float(reader.field.input_value())
    assert gain > 2 * before  # of a hundredfold range a page key is a tenth
    assert reader.slider.get_attribute("aria-valuetext") == f"{gain:g} V/V"


def test_a_slider_is_dragged(reader):
    box = reader.slider.bounding_box()
    height = box["y"] + box["height"] / 2
    before = reader.figures("max|S|")[0]
    reader.page.mouse.move(box["x"] + box["width"] / 2, height)
    reader.page.mouse.down()
    reader.page.mouse.move(box["x"] + 0.7 * box["width"], height, steps=5)
    reader.page.mouse.up()
    reader.after(before)
    assert reader.curve(before="")


def test_one_slider_makes_all_loops_bolder(reader):
    before, gain = reader.figures("max|S|")[0], float(reader.field.input_value())
    reader.panel.get_by_role("slider", name="softer to bolder").focus()
    reader.page.keyboard.press("End")
    reader.after(before)
    assert reader.panel.get_by_text("gains × 4").is_visible()
    assert float(reader.field.input_value()) == pytest.approx(4 * gain, rel=1e-3)
    reader.field.fill("10")
    reader.field.press("Enter")
    assert reader.field.input_value() == "10"
    assert reader.panel.get_by_text("gains × 4").is_visible()


def test_a_typed_number_is_taken_beyond_the_slider_and_refused_beyond_what_the_law_takes(reader):
    before = reader.figures("max|S|")[0]
    reader.field.fill("200")
    reader.field.press("Enter")
    reader.after(before)
    assert reader.slider.input_value() == reader.slider.get_attribute("max")
    refusal = reader.panel.get_by_text("A number from 0 V/V to 1e9 V/V.")
    assert refusal.count() == 0
    for wrong in ("-1", "large"):
        reader.field.fill(wrong)
        reader.field.press("Enter")
        assert refusal.is_visible()
        assert reader.field.get_attribute("aria-invalid") == "true"
        assert reader.slider.get_attribute("aria-valuetext") == "200 V/V"
    reader.field.fill("8,5")
    reader.field.press("Enter")
    assert not refusal.is_visible()
    assert reader.slider.get_attribute("aria-valuetext") == "8.5 V/V"


def test_an_unstable_loop_is_called_so(reader):
    before = reader.figures("max|S|")[0]
    reader.field.fill("200")
    reader.field.press("Enter")
    reader.after(before)
    assert reader.figures("max|S|")[0] == "∞"
    assert reader.panel.get_by_text("The loop is unstable").first.is_visible()
    reader.panel.get_by_text(re.compile("^pump_1 stands at its upper limit")).wait_for()


def test_back_to_the_recommended_takes_all_back(reader):
    from playwright.sync_api import expect

    back = reader.button("Back to the recommended")
    assert back.is_disabled()
    told, shown = reader.panel.inner_text(), reader.field.input_value()
    reader.press("End")
    back.click()
    # What was said aloud of the other settings is taken back a moment later.
    expect(reader.panel).to_have_text(told, use_inner_text=True)
    assert reader.field.input_value() == shown
    assert len(reader.legend()) == 2 and reader.curve() == ""
    assert back.is_disabled()


def test_what_is_kept_is_a_row_that_stays_and_can_be_shown(reader):
    from playwright.sync_api import expect

    page, name = reader.page, reader.legend()[0]
    keep, rows = reader.button("Keep as a row"), page.locator(".ranking tbody tr")
    assert keep.is_disabled()
    count = rows.count()
    for number, key in enumerate(("PageUp", "PageDown"), 1):
        reader.press(key, times=number)
        figures = [reader.figures(title)[0] for title in ("settles", "relative error", "max|S|")]
        keep.click()
        row = rows.nth(count + number - 1)
        assert row.locator("th").inner_text() == f"{name}, changed {number}"
        cells = row.get_by_role("cell").all_inner_texts()
        assert cells[1:3] == [f"+{number}", "not ranked"]
        assert [each for each in figures if each not in cells] == []
        assert keep.is_disabled()
    assert reader.legend()[2:] == [f"{name}, changed 1", f"{name}, changed 2"]
    assert page.locator(".point[title^='+1. ']").count() == 1
    page.locator("#sensitivity .u-over").hover()
    expect(page.locator("#sensitivity .note")).to_contain_text(f"{name}, changed 2 ")
    reader.button("Back to the recommended").click()
    assert len(reader.legend()) == 4 and reader.curve(before="")
    rows.nth(count).get_by_role("checkbox").uncheck()
    expect(page.locator(".legend")).not_to_contain_text("changed 1")
    page.get_by_role("columnheader", name="settles").get_by_role("button").click()
    assert rows.count() == count + 2


def test_nothing_is_kept_before_it_is_computed(report, opened):
    hold = """
        const post = Worker.prototype.postMessage;
        Worker.prototype.postMessage = function (message) {
            if (window.held) window.held.push(() => post.call(this, message));
            else post.call(this, message);
        };"""
    reader = Reader(opened(report(PROCESS), first=hold))
    keep = reader.button("Keep as a row")
    reader.press("PageUp")
    before = reader.figures("max|S|")[0]
    assert keep.is_enabled()
    reader.page.evaluate("window.held = []")
    reader.page.keyboard.press("PageUp")
    assert keep.is_disabled()
    reader.page.evaluate("window.held.splice(0).forEach(post => post())")
    reader.after(before)
    keep.click()
    kept = reader.page.locator(".ranking tbody tr").last.get_by_role("cell").last
    assert kept.inner_text() == reader.figures("max|S|")[0] != before


def test_the_settings_are_copied_a_line_each(reader):
    reader.field.fill("9.5")
    reader.field.press("Enter")
    # Lest the word be gone before it is looked for.
    reader.page.evaluate("window.setTimeout = () => 0")
    reader.button("Copy these settings").click()
    reader.button("Copied").wait_for()
    copied = reader.page.evaluate("navigator.clipboard.readText()")
    lines = [line.split("\t") for line in copied.splitlines()]
    assert [line[:2] for line in lines[:3]] == [["level_1", symbol] for symbol in ("K", "Ti", "b")]
    assert lines[0][2:] == ["9.5", "V/V"] and lines[1][3] == "s"


def test_the_rival_has_sliders_of_its_own(reader):
    rival = reader.legend()[1]
    reader.press("PageUp")
    reader.panel.get_by_role("radio", name=rival).check()
    reader.panel.get_by_role("columnheader", name="original").wait_for()
    assert not reader.slider.is_visible()
    assert len(reader.legend()) == 2
    before = reader.figures("max|S|")[0]
    reader.panel.get_by_role("slider", name="softer to bolder").focus()
    reader.page.keyboard.press("PageUp")
    reader.after(before)
    assert reader.legend()[2] == f"{rival}, changed"


def test_results_are_said_once_all_is_at_rest(reader):
    from playwright.sync_api import expect

    said = reader.panel.get_by_role("status")
    reader.press("PageUp", times=3)
    peak, recommended = reader.figures("max|S|")
    assert 2.0 < float(peak) < 10.0
    expect(said).to_contain_text(f"max|S| is {peak}, above 2.")
    expect(said).to_contain_text(f"max|S| {peak}, recommended {recommended}.")


def test_everyone_can_read_what_can_be_tried(report, opened, look, findings):
    reader = Reader(opened(report(PROCESS), **look))
    reader.press("End")
    reader.field.fill("-1")
    reader.field.press("Enter")
    assert findings(reader.page) == []
    page = "document.documentElement"
    assert reader.page.evaluate(f"{page}.scrollWidth - window.innerWidth") <= 0
    assert reader.panel.evaluate("each => each.scrollWidth - each.clientWidth") == 0


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("delete window.WebAssembly", "This browser has no WebAssembly"),
        (
            "WebAssembly.Module = function () { throw new Error() }",
            "WebAssembly is forbidden here, by the browser or by the page around",
        ),
        (
            "window.Worker = function () { throw new Error() }",
            "The browser lets this page start no worker",
        ),
    ],
)
def test_where_nothing_can_run_a_sentence_says_so(report, opened, script, words):
    page = opened(report(PROCESS), first=script)
    panel = page.locator("#live")
    if panel.locator("summary").count():
        panel.locator("summary").click()
    page.locator("p#live").wait_for()
    assert panel.inner_text() == f"{words}, so other settings cannot be tried."
    assert page.locator(".chart canvas").first.is_visible()
    assert page.locator(".ranking input:checked").count() == 2


def test_a_report_of_another_version_says_so(report, opened, tmp_path):
    text = report(PROCESS).read_text("utf-8")
    assert text.count('"live":{"form":1,') == 1
    other = tmp_path / "other.html"
    other.write_text(text.replace('"live":{"form":1,', '"live":{"form":2,'), "utf-8")
    page = opened(other)
    said = "This report was written by another version of Clepsydra than its script"
    assert page.locator("p#live").inner_text().startswith(said)
    assert page.locator(".chart canvas").first.is_visible()


def test_on_paper_and_without_script_nothing_is_offered(report, opened, printed):
    assert "Try other settings" not in " ".join(printed(opened(report(PROCESS))))
    assert opened(report(PROCESS), script=False).locator("#live").count() == 0
