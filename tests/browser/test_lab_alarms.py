"""Alarms of a laboratory: they come, are acknowledged by a click or a key, and hold a pump."""

import json
from pathlib import Path

import pytest
from lab_hand import KEPT, Hand

import clepsydra as cl

pytestmark = pytest.mark.browser
ALARMED = Path(__file__).parents[1] / "alarmed-tank.toml"
WORDS = "high-high alarm of level_1 at 15 cm"


@pytest.fixture(scope="session")
def page_of_tank(built, tmp_path_factory):
    plant = cl.load(ALARMED)
    return cl.lab(plant, cl.design.simc(plant), tmp_path_factory.mktemp("alarms") / "tank.html")


@pytest.fixture
def hand(page_of_tank, opened):
    return Hand(opened(page_of_tank, first=KEPT))


def fill(hand):
    """Let the level rise beyond the high-high alarm, which stops the pump."""
    hand.type("inflow_1", "20", "cm³/s")
    for _ in range(9):
        hand.press("One sample")


def line(hand):
    """Return the words of the only line of the list."""
    (found,) = hand.page.locator("#alarms li").all()
    return found.inner_text().split("\n")


def mark(hand):
    return hand.page.locator('figure:visible [data-alarms="level_1"]')


def test_an_alarm_is_listed_and_acknowledged_by_a_click(hand):
    assert line(hand) == ["No alarms."]
    assert not mark(hand).is_visible()
    badge = hand.page.locator(".faceplate").get_by_role("img", name=WORDS)
    assert badge.count() == 0
    fill(hand)
    letters, _, words, state, button = line(hand)
    assert (letters, words, state, button) == ("HH", WORDS, "unacknowledged", "Acknowledge")
    assert hand.page.locator("#alarms .count").inner_text() == "1 to acknowledge"
    spoken = hand.page.locator("#alarms").get_by_role("status").text_content()
    assert spoken.startswith(f"{WORDS}, high priority, at ")
    assert mark(hand).text_content() == f"{WORDS}HH"
    assert "waiting" in badge.get_attribute("class")
    acknowledge = hand.page.get_by_role("button", name=f"Acknowledge {WORDS}")
    acknowledge.focus()
    hand.page.keyboard.press("Enter")
    hand.press("One sample")
    assert line(hand)[-1] == "acknowledged"
    assert "waiting" not in badge.get_attribute("class")
    assert "waiting" not in mark(hand).get_attribute("class")


def test_a_press_on_an_alarm_is_not_lost_when_another_one_comes_meanwhile(hand):
    from playwright.sync_api import expect

    page = hand.page
    fill(hand)
    # The tank runs empty, and its low-low alarm comes before the other one in the list.
    hand.type("inflow_1", "0", "cm³/s")
    hand.mode("pump_1", "Manual")
    hand.press("Extra outlet of tank_1")
    page.get_by_role("button", name=f"Acknowledge {WORDS}").hover()
    page.mouse.down()
    for _ in range(40):
        page.get_by_role("button", name="One sample").dispatch_event("click")
    count = page.locator("#alarms .count")
    expect(count).to_have_text("2 to acknowledge")
    page.mouse.up()
    hand.press("One sample")
    expect(count).to_have_text("1 to acknowledge")
    assert line(hand)[0] == "LL"


def test_an_interlock_is_told_where_it_acts(hand):
    fill(hand)
    row = hand.page.locator(".signal", has=hand.page.get_by_text("pump_1", exact=True))
    assert row.locator(".state").inner_text() == "interlock: HH of level_1"
    assert hand.number("pump_1") == 0.0
    drawn = hand.page.locator('figure:visible [data-state="pump_1"]')
    assert drawn.text_content() == "interlock"


def test_a_key_acknowledges_all_and_the_session_has_it(hand, tmp_path):
    fill(hand)
    hand.page.keyboard.press("k")
    hand.type("inflow_1", "0", "cm³/s")
    hand.run(1)
    assert line(hand) == ["No alarms."]
    log = hand.page.locator("#happened .words").all_inner_texts()
    assert {WORDS, f"{WORDS} acknowledged", f"{WORDS} returned to normal"} <= {*log}
    path = tmp_path / "session.json"
    path.write_text(json.dumps(hand.session()), encoding="utf-8")
    plant = cl.load(ALARMED)
    run = cl.replay(path, plant, cl.design.simc(plant))
    states = run.values["level_1.high_high.state"]
    assert sorted({*states.tolist()}) == [0.0, 1.0, 2.0]


def test_the_list_is_for_everyone(page_of_tank, opened, look, findings):
    hand = Hand(opened(page_of_tank, **look, first=KEPT))
    fill(hand)
    assert findings(hand.page) == []
    wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert hand.page.evaluate(wide)
    top = hand.page.locator("#rig").bounding_box()["y"]
    hand.page.keyboard.press("k")
    hand.press("One sample")
    assert findings(hand.page) == []
    # Nothing moves when alarms come and go.
    assert hand.page.locator("#rig").bounding_box()["y"] == top
