"""Hands on a laboratory: what they pour, drill, plug and break is seen where it happens."""

import re

import pytest
from lab_hand import KEPT, Hand

import clepsydra as cl

pytestmark = pytest.mark.browser
#: Water that stands in a drawn tank, at most [px].
FULL = 112.0
#: Counts the turns of the wheel that the page has answered.
TURNED = """
window.turns = 0;
addEventListener("wheel", () => setTimeout(() => { turns += 1; }));
"""


@pytest.fixture(scope="session")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="session")
def controllers(plant):
    return [cl.design.simc(plant), cl.design.lqi(plant)]


@pytest.fixture(scope="session")
def page_of_tanks(built, plant, controllers, tmp_path_factory):
    return cl.lab(plant, controllers, tmp_path_factory.mktemp("hands") / "tanks.html")


@pytest.fixture
def hand(page_of_tanks, opened):
    return Hand(opened(page_of_tanks, first=KEPT))


def pressed(hand, name):
    button = hand.page.get_by_role("button", name=name, exact=True)
    return button.get_attribute("aria-pressed") == "true"


def mark(hand, kind, name):
    """Tell whether a mark of the drawing is shown."""
    return hand.page.locator(f'figure:visible [data-{kind}="{name}"]').is_visible()


def width(hand, pipe, to):
    """Return how wide a pipe is drawn [px], and whether nothing flows in it."""
    found = hand.page.locator(f'figure:visible [data-pipe="{pipe}"][data-to="{to}"]')
    line = found.locator("path:not(.arrow)").evaluate("line => line.style.strokeWidth")
    return float(line.removesuffix("px")), "stopped" in found.get_attribute("class")


def words(hand, kind, name):
    return hand.page.locator(f'figure:visible [data-{kind}="{name}"]').text_content()


def log(hand):
    return hand.page.locator("#happened .words").all_inner_texts()


def test_a_click_pours_a_quarter_and_it_runs_off(hand):
    hand.mode("pump_2", "Manual")
    before = hand.water("tank_3")
    hand.press("Pour +25 % into tank_3")
    assert pressed(hand, "Pour +25 % into tank_3")
    hand.press("One sample")
    assert mark(hand, "pour", "tank_3")
    hand.press("One sample")
    # A quarter is poured in a sample, and a little of it has run off.
    assert not pressed(hand, "Pour +25 % into tank_3")
    assert not mark(hand, "pour", "tank_3")
    assert hand.water("tank_3") - before == pytest.approx(0.25 * FULL, rel=0.03)
    assert re.fullmatch(r"poured \d+ cm³ \(25 %\) into tank_3", log(hand)[0])


def test_an_extra_outlet_and_a_plug_are_undone_by_another_click(hand):
    whole, _ = width(hand, "outlet_1", "basin")
    for name in ("Extra outlet of tank_1", "Plug outlet_4"):
        hand.press(name)
    hand.press("One sample")
    hand.press("One sample")
    assert mark(hand, "extra", "tank_1")
    assert mark(hand, "plug", "outlet_4")
    assert width(hand, "outlet_4", "tank_2") == (1.2, True)
    assert words(hand, "flow", "outlet_4") == "0.00 cm³/s"
    hand.run(10)
    assert {"tank_4 is full", "tank_4 spills"} <= {*log(hand)}
    for name in ("Extra outlet of tank_1", "Plug outlet_4"):
        assert pressed(hand, name)
        hand.press(name)
        assert not pressed(hand, name)
    hand.run(120)
    assert not mark(hand, "plug", "outlet_4")
    assert width(hand, "outlet_1", "basin")[0] == pytest.approx(whole, abs=0.1)


def test_pipes_are_as_wide_as_what_flows_in_them(hand):
    wide, _ = width(hand, "pump_1", "splitter_1")
    direct, _ = width(hand, "splitter_1", "tank_1")
    other, _ = width(hand, "splitter_1", "tank_4")
    # Above that of an empty pipe they are as the flows, of which tank 1 gets 70 %.
    assert (direct - 1.2) / (wide - 1.2) == pytest.approx(0.7, abs=0.04)
    assert (other - 1.2) / (wide - 1.2) == pytest.approx(0.3, abs=0.04)
    hand.press("Non-minimum phase")
    hand.press("One sample")
    assert pressed(hand, "Non-minimum phase")
    assert (
        hand.page.locator('[data-share="splitter_1"][data-to="tank_1"]').first.text_content()
        == "43 %"
    )


def test_a_fault_has_colour_and_words(hand):
    hand.choose("Fault of level_1", "stuck")
    hand.choose("Fault of pump_2", "stopped")
    hand.run(2)
    row = hand.page.locator(".signal", has=hand.page.get_by_text("level_1", exact=True))
    assert row.locator(".state").inner_text() == "stuck"
    assert "fault" in row.get_attribute("class")
    assert words(hand, "state", "pump_2") == "stopped"
    assert width(hand, "pump_2", "splitter_2") == (1.2, True)
    assert {"pump_2 stopped"} < set(log(hand))
    hand.choose("Fault of pump_2", "OK")
    hand.press("One sample")
    hand.press("One sample")
    assert words(hand, "state", "pump_2") != "stopped"
    assert "pump_2 runs again" in log(hand)


def test_a_number_of_the_plant_is_typed_and_taken_back(hand):
    hand.page.get_by_text("Numbers of the plant", exact=True).click()
    field = hand.page.get_by_label("cross-section of outlet_1 in cm²")
    assert field.input_value() == "0.071"
    field.fill("0.142")
    field.press("Enter")
    hand.press("One sample")
    assert hand.page.locator("#hands summary").inner_text() == "Numbers of the plant: 1 changed"
    field.fill("−1")
    field.press("Enter")
    assert "outside 0 to" in hand.page.get_by_role("alert").inner_text()
    assert field.get_attribute("aria-invalid") == "true"
    hand.press("All as in the file")
    assert field.input_value() == "0.071"


def test_a_loop_that_a_hand_opened_says_so(hand):
    assert words(hand, "setpoint", "level_1.setpoint").startswith("SP 6.13")
    hand.mode("pump_1", "Manual")
    assert words(hand, "setpoint", "level_1.setpoint") == "MAN"
    assert "open" in hand.page.locator('figure:visible [data-acts="pump_1"]').get_attribute("class")


def test_a_run_goes_on_as_another_one_from_where_it_stands(hand):
    hand.run(10)
    stood = hand.number("level_1"), hand.page.locator(".told").inner_text()
    hand.press("Start here")
    assert (hand.number("level_1"), hand.page.locator(".told").inner_text()) == stood
    assert "Goes on from here as Run 2" in hand.page.get_by_role("status").inner_text()
    hand.press("One sample")
    assert hand.page.locator("#runs li").count() == 2


def test_keys_do_what_buttons_do_and_are_told(hand):
    from playwright.sync_api import expect

    page = hand.page
    page.keyboard.press("?")
    told = page.get_by_role("dialog", name="Keys")
    assert "Run, or pause" in told.inner_text()
    page.keyboard.press("Escape")
    told.wait_for(state="hidden")
    page.keyboard.press("2")
    slider = page.get_by_role("slider", name="Setpoint of level_2")
    expect(slider).to_be_focused()
    page.keyboard.press("m")
    modes = page.get_by_role("group", name="Mode of pump_2")
    manual = modes.get_by_role("button", name="Manual")
    expect(manual).to_have_attribute("aria-pressed", "true")
    before = page.locator(".told").inner_text()
    page.keyboard.press(".")
    expect(page.locator(".told")).not_to_have_text(before)
    page.keyboard.press(" ")
    expect(page.locator(".go")).to_have_text("Pause")
    page.keyboard.press(" ")
    expect(page.locator(".go")).to_have_text("Run")
    # Letters that are typed into a field are no keys.
    field = page.get_by_role("textbox", name="Setpoint of level_1 in V, typed")
    field.focus()
    page.keyboard.type("n m")
    page.keyboard.press("Enter")
    expect(page.get_by_role("alert")).to_contain_text("not a number")
    # The next one that is fine takes the words away.
    page.keyboard.type("6")
    page.keyboard.press("Enter")
    expect(page.get_by_role("alert")).to_have_count(0)
    expect(field).to_be_focused()
    field.blur()
    # Who speaks to the machine can switch them off.
    page.keyboard.press("?")
    told.get_by_role("checkbox").uncheck()
    told.get_by_role("button", name="Close").click()
    page.keyboard.press(" ")
    assert page.locator(".go").inner_text() == "Run"


def test_a_part_of_what_is_typed_is_replaced_while_the_rig_goes_on(hand):
    from playwright.sync_api import expect

    field = hand.page.get_by_role("textbox", name="Setpoint of level_1 in V, typed")
    field.fill("6.25")
    field.evaluate("field => field.setSelectionRange(0, 1)")
    told = hand.page.locator(".told")
    before = told.inner_text()
    # Without a hand, which would leave the field.
    hand.page.get_by_role("button", name="One sample").dispatch_event("click")
    expect(told).not_to_have_text(before)
    hand.page.keyboard.type("7")
    expect(field).to_have_value("7.25")


def test_the_wheel_turns_a_knob_with_shift_alone(hand):
    page = hand.page
    slider = page.get_by_role("slider", name="Setpoint of level_1")
    before = float(slider.input_value())
    page.evaluate(TURNED)
    slider.focus()
    slider.hover()
    page.mouse.wheel(0, -100)
    page.wait_for_function("() => turns === 1")
    assert float(slider.input_value()) == before
    slider.hover()
    page.keyboard.down("Shift")
    page.mouse.wheel(0, -100)
    page.wait_for_function("() => turns === 2")
    page.keyboard.up("Shift")
    assert float(slider.input_value()) == pytest.approx(before + 0.1, abs=0.011)


def test_a_controller_with_other_loops_has_its_own_drawing(hand):
    # A loop has a controller for each pump, state feedback one for both.
    controllers = hand.page.get_by_text(re.compile("^LIC$|^UIC$")).locator("visible=true")
    assert controllers.all_text_contents() == ["LIC", "LIC"]
    hand.choose("Controller", "LQI, Bryson")
    hand.press("One sample")
    title = hand.page.locator("figure:visible svg > title").first.text_content()
    assert title.endswith("controlled by LQI, Bryson")
    assert controllers.all_text_contents() == ["UIC"]


def test_the_drawing_of_a_phone_needs_no_scrolling_and_has_words(page_of_tanks, opened, look):
    page = Hand(opened(page_of_tanks, **look)).page
    figure = page.locator("figure.drawing:visible")
    assert figure.evaluate("figure => figure.scrollWidth <= figure.clientWidth")
    least = page.locator("figure:visible text[data-value]:visible").evaluate_all(
        "texts => Math.min(...texts.map(text => text.getBoundingClientRect().height))"
    )
    assert least >= 9.0


def test_with_all_hands_on_it_the_page_is_for_everyone(page_of_tanks, opened, look, findings):
    hand = Hand(opened(page_of_tanks, **look))
    page = hand.page
    page.get_by_text("Numbers of the plant", exact=True).click()
    for name in ("Extra outlet of tank_1", "Plug outlet_4", "Pour +25 % into tank_2"):
        hand.press(name)
    hand.choose("Fault of level_1", "dead")
    hand.press("One sample")
    assert findings(page) == []
    page.keyboard.press("?")
    assert findings(page) == []
    wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert page.evaluate(wide)
    assert not re.search(r"NaN|undefined|Infinity", page.locator("main").inner_text())
