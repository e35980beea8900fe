"""A lesson in the hands of its reader."""

import json
import re

import pytest
from lab_hand import KEPT
from pupil import Pupil

import clepsydra as cl

pytestmark = pytest.mark.browser
LESSON = "wind-up#7"
#: Of the last figure of the lesson.
ANSWER = """
JSON.parse(document.getElementById("data").textContent).lesson.tasks.at(-1).figures[0].answer
"""


@pytest.fixture(scope="session")
def page_of_lesson(built, tmp_path_factory):
    return cl.lesson(LESSON, tmp_path_factory.mktemp("lesson") / "wind-up.html").path


@pytest.fixture
def pupil(page_of_lesson, opened):
    return Pupil(opened(page_of_lesson, first=KEPT))


def test_a_task_is_done_measured_and_printed(pupil, printed, tmp_path):
    pupil.begin("2. A large step")
    assert pupil.reached() == 0
    pupil.type("Setpoint of level", "30", "cm")
    pupil.run(15)
    assert pupil.reached() == 3
    path = tmp_path / "session.json"
    path.write_text(json.dumps(pupil.session()), encoding="utf-8")
    run = cl.replay(path)
    level = run.values["level.true"]
    start = level[0]
    assert pupil.figure("Overshoot") == pytest.approx(
        100 * (level.max() - 0.30) / (0.30 - start), rel=5e-3
    )
    pupil.panel.get_by_label("Name for the report").fill("A. <b>Pupil</b>")
    pupil.panel.get_by_label("Name for the report").press("Tab")
    sheets = "\n".join(printed(pupil.page))
    assert "A. <b>Pupil</b>" in sheets
    assert "1 of 4 tasks" in sheets and "variant 7" in sheets
    assert re.search(r"Overshoot\s+[\d.]+ %\s+measured", sheets)
    assert "Set up the rig" not in sheets


def test_a_typed_figure_is_judged_and_kept(pupil):
    pupil.begin("4. A level that is out of reach")
    right = pupil.page.evaluate(ANSWER)
    words = "Highest level"
    assert pupil.answer(words, f"{1.2 * right:.1f}") == "not within 3 % yet"
    assert pupil.answer(words, f"{right:.1f}".replace(".", ",")) == "right"
    pupil.reload()
    field = pupil.panel.locator(".figure", has_text=words).get_by_role("textbox")
    assert field.input_value() == f"{right:.1f}".replace(".", ",")
    assert pupil.panel.locator(".figure.right").count() == 1


def test_a_task_is_done_by_keyboard_alone(pupil):
    from playwright.sync_api import expect

    keys = pupil.page.keyboard
    pupil.panel.get_by_label("Task").focus()
    keys.press("ArrowDown")
    expect(pupil.panel.locator("h3").first).to_contain_text("A large step")
    while pupil.focused() != "Set up the rig":
        keys.press("Tab")
    keys.press("Enter")
    while pupil.focused() != "Setpoint of level in cm, typed":
        keys.press("Tab")
    keys.press("Control+A")
    keys.type("30")
    keys.press("Enter")
    # Keys are keys again.
    keys.press("Escape")
    for _ in range(4):
        keys.press("+")
    keys.press(" ")
    pupil.page.locator(".reach .done").nth(2).wait_for()
    keys.press(" ")
    assert pupil.page.locator("#said").inner_text().startswith("Reached: The level stays")


def test_what_a_lesson_says_is_no_markup(built, opened, tmp_path):
    bad = "<img src=x onerror=document.title=1><b>"
    path = tmp_path / "bad.toml"
    path.write_text(
        f'''
title = "{bad}"
process = "quadruple-tank"
text = "{bad}"
[controllers."PI {bad}"]
design = "simc"
[[tasks]]
title = "{bad}"
text = "*{bad}*"
hints = ["{bad}"]
solution = "{bad}"
reach = [{{ words = "{bad}", where = {{ level_1 = ["", ""] }} }}]
figures = [{{ words = "{bad}", symbol = "{bad}" }}]
''',
        encoding="utf-8",
    )
    page = opened(cl.lesson(path, tmp_path / "bad.html", answers=True).path)
    panel = page.locator("#lesson")
    panel.get_by_role("button", name="Set up the rig").click()
    assert panel.locator("img, b").count() == 0
    assert panel.inner_text().count(bad) >= 6
    assert page.title() != "1"


def test_hints_wait_until_they_are_asked_for(pupil):
    hints = pupil.panel.locator(".hints li")
    assert hints.count() == 0
    pupil.press("Hint 1 of 2")
    assert hints.count() == 1
    pupil.press("Hint 2 of 2")
    assert hints.count() == 2


def test_going_back_takes_the_task_back(pupil):
    """What was reached stays reached, but a branch is looked at from where the task began."""
    pupil.begin("1. A small step")
    pupil.run(2)
    assert pupil.reached() == 0
    pupil.press("Start at rest")
    pupil.type("Setpoint of level", "12", "cm")
    pupil.run(5)
    assert pupil.reached() == 2


def test_the_lecturers_page_has_the_answers(built, opened, tmp_path):
    page = opened(cl.lesson(LESSON, tmp_path / "answers.html", answers=True).path)
    panel = page.locator("#lesson")
    panel.get_by_label("Task").select_option("4. A level that is out of reach")
    assert re.search(r"[\d.]+ cm, ± 3.0 %", panel.locator(".answer").inner_text())
    assert panel.locator(".hints li").count() == 1
    panel.get_by_label("Task").select_option("2. A large step")
    assert "integral" in panel.locator(".solution").inner_text()


def test_a_lesson_is_for_everyone(page_of_lesson, opened, look, findings):
    page = opened(page_of_lesson, **look)
    page.get_by_role("button", name="Set up the rig").click()
    assert findings(page) == []
    wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert page.evaluate(wide)


#: Of the first figure of a task of the page that is open.
ASKED = """task =>
JSON.parse(document.getElementById("data").textContent).lesson.tasks[task].figures[0].answer
"""


@pytest.fixture
def pupil_of(built, opened, tmp_path):
    return lambda name: Pupil(opened(cl.lesson(name, tmp_path / f"{name}.html").path, first=KEPT))


def test_the_dead_time_is_found_and_not_read(pupil_of):
    pupil = pupil_of("dead-time")
    assert pupil.page.locator("figure:visible", has_text="40 s").count() == 0
    assert "cm³/s" in pupil.page.locator('figure:visible [data-flow="outlet"]').text_content()
    pupil.begin("1. Find the dead time")
    pupil.type("Manual value of pump", "76", "%")
    pupil.run(15)
    assert pupil.reached() == 2
    assert pupil.answer("Dead time of the pipe", "60") == "not within 8 % yet"
    assert pupil.answer("Dead time of the pipe", "40") == "right"
    pupil.begin("2. Too fast")
    pupil.type("Setpoint of level", "22", "cm")
    pupil.run(15)
    assert pupil.reached() == 3
    for task, most in (("3. As fast as the dead time lets it be", 20), ("4. With a model", 2)):
        option = pupil.panel.get_by_label("Task").locator("option", has_text=task).inner_text()
        pupil.begin(option)
        pupil.type("Setpoint of level", "22", "cm")
        pupil.run(15)
        assert pupil.reached() == 2
        assert pupil.figure("Overshoot") < most


def test_pairs_are_right_or_wrong(pupil_of):
    pupil = pupil_of("pairing")
    pupil.begin("1. One pump moves both levels")
    pupil.type("Manual value of pump_1", "3.3")
    pupil.run(30)
    assert pupil.reached() == 1
    right = pupil.page.evaluate(ASKED, 0)
    assert right == pytest.approx(0.7 * 0.6 / 0.3)
    assert pupil.answer("Relative gain of level 1 and pump 1", f"{right:.2f}") == "right"
    for task in ("2. The straight pairs", "3. The crossed pairs"):
        pupil.begin(task)
        pupil.type("Setpoint of level_1", "6.7")
        pupil.run(60)
        assert pupil.reached() == 2
    pupil.begin("4. When most of the water goes up first")
    pupil.run(60)
    pupil.type("Setpoint of level_1", "6.7")
    pupil.run(180)
    assert pupil.reached() == 2
    assert pupil.page.evaluate(ASKED, 3) < 0
