"""The page of a running rig in the hands of its operator: it shows what is, and nothing else."""

import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest
from lab_hand import Hand
from tools import need
from waiting import wait_until

import clepsydra as cl

pytestmark = pytest.mark.browser
SPEED = 20.0
ALARMED = Path(__file__).parents[1] / "alarmed-tank.toml"
#: What a browser says of a server that is not there.
UNANSWERED = "WebSocket connection to"
DRAWN = "() => document.querySelector('.trend canvas').toDataURL()"


@pytest.fixture(scope="module")
def start(built, tmp_path_factory):
    """Return a context in which a rig is at work, with a page at some port."""
    need("websockets")
    plants = {}

    def started(name="quadruple-tank", token="", view_only=False):
        plant = plants.setdefault(name, cl.load(name))
        doors = cl.Doors(["page"], ports={"page": free_port()}, read_only=view_only)
        running = cl.run_rig(
            plant, cl.design.simc(plant), speed=SPEED, doors=doors, silence="0.5 s",
            folder=tmp_path_factory.mktemp("rig"), fail_safe={},
        )  # fmt: skip
        (door,) = running.settings.doors
        running.settings = replace(running.settings, doors=(replace(door, token=token),))
        return running

    return started


def free_port():
    import socket

    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


@pytest.fixture(scope="module")
def running(start):
    with start() as rig:
        yield rig


@pytest.fixture
def attached(chromium):
    """Open the page of a rig; nothing may have gone wrong on it, but that nobody answered."""
    contexts, wrong = [], []

    def open_page(rig, width=1400, scheme="light"):
        context = chromium.new_context(
            viewport={"width": width, "height": 900}, color_scheme=scheme, accept_downloads=False
        )
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.on(
            "console", lambda said: said.type in ("error", "warning") and wrong.append(said.text)
        )
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.goto(rig.settings.doors[0].address)
        return Hand(page)

    yield open_page
    for context in contexts:
        context.close()
    assert [each for each in wrong if not each.startswith(UNANSWERED)] == []


def expect(*given):
    from playwright.sync_api import expect as found

    return found(*given)


def test_what_an_operator_does_moves_the_plant_and_is_seen(running, attached):
    hand, image = attached(running), running.image
    hand.press("Local")
    wait_until(lambda: image.read("operator.remote") == 0.0)
    before = hand.page.evaluate(DRAWN)
    hand.type("Setpoint of level_1", "7")
    wait_until(lambda: image.read("level_1.setpoint") == 7.0)
    wait_until(lambda: hand.number("level_1") > 6.8)
    assert hand.page.evaluate(DRAWN) != before
    hand.mode("pump_1", "Manual")
    hand.type("Manual value of pump_1", "0")
    wait_until(lambda: image.read("pump_1.applied") == 0.0 and hand.number("pump_1") == 0.0)
    hand.mode("pump_1", "Auto")
    wait_until(lambda: image.read("pump_1.applied") > 1.0 and hand.number("pump_1") > 1.0)
    hand.choose("Fault of level_1", "dead")
    wait_until(lambda: image.read("level_1.sensor") == 0.0)
    log = hand.page.get_by_role("list", name="What happened")
    expect(log).to_contain_text("level_1 dead")
    expect(log).to_contain_text("setpoint of level_1 to 7.00 V")
    hand.choose("Fault of level_1", "OK")
    hand.page.get_by_role("checkbox", name="Noise").check()
    wait_until(lambda: image.read("instructor.noise") == 1.0)
    hand.choose("Wires: lost requests", "10 %")
    wait_until(lambda: image.read("instructor.wire_loss") == 0.1)
    hand.choose("Wires: lost requests", "none")
    hand.page.get_by_role("checkbox", name="Noise").uncheck()
    hand.press("Remote")
    wait_until(lambda: image.read("operator.remote") == 1.0)


def test_what_another_does_is_seen_too(running, attached):
    one, other = attached(running), attached(running)
    expect(one.page.locator("#bar")).to_contain_text("2 pages")
    one.type("Setpoint of level_2", "5.5")
    field = other.page.get_by_role("textbox", name="Setpoint of level_2 in V, typed")
    expect(field).to_have_value("5.50")
    expect(other.page.get_by_role("list", name="What happened")).to_contain_text("level_2 to 5.50")


def test_without_its_rig_a_page_says_so_and_comes_back(running, attached):
    hand = attached(running)
    link = hand.page.locator("#link")
    expect(link).to_be_hidden()
    hand.type("Setpoint of level_1", "6")
    log = hand.page.get_by_role("list", name="What happened")
    expect(log).to_contain_text("setpoint of level_1 to 6.00 V")
    os.kill(running.process_of("Page"), signal.SIGKILL)
    expect(link).to_contain_text("Connection lost")
    setpoint = hand.page.get_by_role("textbox", name="Setpoint of level_1 in V, typed")
    expect(setpoint).to_be_disabled()
    expect(hand.page.locator("body.stale")).to_have_count(1)
    stopped = hand.time()
    wait_until(lambda: any("started again" in each.words for each in running.watch(0.05)))
    expect(link).to_be_hidden()
    expect(setpoint).to_be_enabled()
    wait_until(lambda: hand.time() > stopped)
    # It goes on with what it has seen.
    expect(log).to_contain_text("setpoint of level_1 to 6.00 V")
    kept = hand.page.get_by_label("Go back")
    assert int(kept.get_attribute("min")) == 1


def test_a_plant_that_stands_still_does_not_look_alive(running, attached):
    hand = attached(running)
    expect(hand.page.locator("#link")).to_be_hidden()
    os.kill(running.process_of("plant"), signal.SIGSTOP)
    try:
        expect(hand.page.locator("#link")).to_contain_text("The plant stands still")
        assert "the last sample is" in hand.page.locator("#link").inner_text()
        expect(hand.page.get_by_role("button", name="Remote")).to_be_disabled()
    finally:
        os.kill(running.process_of("plant"), signal.SIGCONT)
    expect(hand.page.locator("#link")).to_be_hidden()


def test_the_past_is_seen_and_not_moved(running, attached):
    hand = attached(running)
    slider = hand.page.get_by_label("Go back")
    slider.fill("5")
    expect(hand.page.locator("#said")).to_contain_text("go back to now")
    setpoint = hand.page.get_by_role("textbox", name="Setpoint of level_1 in V, typed")
    expect(setpoint).to_be_disabled()
    assert hand.number("level_1") == pytest.approx(6.13, abs=0.01)
    hand.page.locator("#bar").get_by_role("button", name="Now").click()
    expect(setpoint).to_be_enabled()


def test_a_controller_that_falls_silent_catches_the_eye(start, attached):
    with start() as rig:
        hand = attached(rig)
        expect(hand.page.locator("#bar")).to_contain_text("No controller yet")
        rig.table.write(rig.table.tags["pump_1.out"], 4.0)
        link = hand.page.locator("#link")
        expect(link).to_have_text("Controller silent: outputs are fail-safe.")
        wait_until(lambda: hand.number("pump_1") == 0.0)
        hand.press("Local")
        expect(link).to_be_hidden()
        expect(hand.page.locator("#bar")).to_contain_text("Controller silent")


def test_who_only_looks_on_has_nothing_to_press(start, attached):
    with start(view_only=True) as rig:
        hand = attached(rig)
        expect(hand.page.locator("#said")).to_have_text("This page only looks on.")
        for button in ("Remote", "Local"):
            expect(hand.page.get_by_role("button", name=button)).to_be_disabled()
        expect(hand.page.get_by_label("Fault of level_1")).to_be_disabled()


def test_an_alarm_is_acknowledged_on_every_page(start, attached):
    with start(ALARMED) as rig:
        one, other = attached(rig), attached(rig)
        for hand in (one, other):
            expect(hand.page.locator("#alarms li")).to_have_text("No alarms.")
        one.type("inflow_1", "20", "cm³/s")
        acknowledge = other.page.get_by_role("button", name="Acknowledge high-high")
        expect(acknowledge).to_be_visible()
        acknowledge.click()
        for hand in (one, other):
            expect(hand.page.locator("#alarms")).to_contain_text("acknowledged")
            expect(hand.page.get_by_role("button", name="Acknowledge high-high")).to_be_hidden()
        # A press that lasts would acknowledge what has not come yet.
        ports = [name for name in rig.image.layout.written if name.endswith(".acknowledge")]
        wait_until(lambda: not any(rig.image.read(name) for name in ports))


def test_a_token_opens_the_page_and_its_link(start, attached):
    with start(token="correct-horse-battery") as rig:
        hand = attached(rig)
        expect(hand.page.locator("#bar")).to_contain_text("Live")
        assert "token" not in hand.page.url
        assert hand.page.evaluate("document.cookie") == ""
        hand.press("Local")
        wait_until(lambda: rig.image.read("operator.remote") == 0.0)


def test_the_page_is_for_everyone(running, attached, look, findings):
    hand = attached(running, **look)
    expect(hand.page.locator("#bar")).to_contain_text("Live")
    assert findings(hand.page) == []
    wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert hand.page.evaluate(wide)
