"""A laboratory in the hands of its reader."""

import json

import pytest
from lab_hand import KEPT, Hand

import clepsydra as cl

pytestmark = pytest.mark.browser


@pytest.fixture(scope="session")
def rig():
    plant = cl.load("quadruple-tank")
    return plant, [cl.design.simc(plant), cl.design.amigo(plant)]


@pytest.fixture(scope="session")
def page_of_rig(built, rig, tmp_path_factory):
    return cl.lab(*rig, tmp_path_factory.mktemp("lab") / "tanks.html")


@pytest.fixture
def hand(page_of_rig, opened):
    return Hand(opened(page_of_rig, first=KEPT))


def test_levels_move_and_end_at_the_setpoint(hand):
    hand.press("Start empty")
    assert hand.water("tank_1") == 0.0
    hand.type("Setpoint of level_1", "7")
    hand.run(60)
    assert hand.number("level_1") == pytest.approx(7.0, abs=0.005)
    assert hand.water("tank_1") == pytest.approx(0.7 * 112, abs=0.1)


def test_a_pump_in_manual_goes_where_a_hand_puts_it(hand):
    hand.mode("pump_1", "Manual")
    hand.press("One sample")
    begins = hand.number("pump_1")
    assert begins == pytest.approx(3.0, abs=0.01)
    hand.type("Manual value of pump_1", "0")
    hand.run(60)
    assert hand.number("pump_1") == 0.0
    pump = hand.page.locator('figure:visible g[data-of="pump_1"]:not(.pipe)')
    assert "stopped" in pump.get_attribute("class")
    hand.type("Manual value of pump_1", "11")
    said = hand.page.get_by_role("alert")
    assert said.inner_text() == "pump_1: 11 V is outside 0 to 10 V; type a number between them."
    assert hand.number("pump_1") == 0.0


def test_another_controller_takes_over_without_a_bump(hand):
    hand.run(60)
    before = hand.number("pump_1")
    hand.choose("Controller", "PI, AMIGO")
    hand.press("One sample")
    assert hand.number("pump_1") == pytest.approx(before, abs=0.005)
    assert "PI, AMIGO" in hand.page.locator("figure:visible title").first.text_content()


def test_what_was_done_is_saved_and_runs_again(hand, rig, tmp_path):
    hand.press("Start empty")
    hand.page.get_by_role("checkbox", name="Noise").check()
    hand.run(5)
    hand.type("Setpoint of level_2", "5.5")
    hand.choose("Controller", "PI, AMIGO")
    hand.run(15)
    hand.mode("pump_2", "Manual")
    hand.run(20)
    shown, level = hand.number("level_2"), hand.water("tank_2")
    path = tmp_path / "session.json"
    path.write_text(json.dumps(hand.session()), encoding="utf-8")
    run = cl.replay(path, *rig)
    assert len(run.session.touches) == 5
    assert run.values["level_2"][-1] == pytest.approx(shown, abs=0.005)
    filled = min(run.values["tank_2.level"][-1] / 0.2, 1.0)
    assert 112 * filled == pytest.approx(level, abs=0.006)


def test_the_page_is_for_everyone(page_of_rig, opened, look, findings):
    page = Hand(opened(page_of_rig, **look)).page
    page.get_by_role("button", name="One sample").click()
    assert findings(page) == []
    wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert page.evaluate(wide)
