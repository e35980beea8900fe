"""A laboratory whose reader brings a controller: asked, told, switched on, and run again."""

import json
from base64 import b64encode

import numpy as np
import pytest
from lab_hand import KEPT, Hand
from refusals import refused
from scipy.io import savemat

import clepsydra as cl

pytestmark = pytest.mark.browser
DROP = """([text, name]) => {
    const files = new DataTransfer();
    files.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    document.body.dispatchEvent(
        new DragEvent("drop", { dataTransfer: files, cancelable: true, bubbles: true }));
}"""
#: Lets the page wait for its programs until `go` is called.
HELD = """
const compile = WebAssembly.compile;
const released = new Promise(done => { window.go = done; });
WebAssembly.compile = async (bytes) => (await released, compile(bytes));
"""
PI = {"A": np.zeros((2, 2)), "B": np.diag([0.1, 0.0675]), "C": np.eye(2), "D": np.diag([3.0, 2.7])}


@pytest.fixture(scope="session")
def rig():
    plant = cl.load("quadruple-tank")
    return plant, [cl.design.simc(plant)]


@pytest.fixture(scope="session")
def page_of_rig(built, rig, tmp_path_factory):
    folder = tmp_path_factory.mktemp("laws")
    cl.lab(*rig, folder / "tanks.html")
    return folder / "tanks.html"


class Bringer(Hand):
    """Who has the laboratory open, and a controller in a file or on paper."""

    def __init__(self, page):
        super().__init__(page)
        self.dialog = page.locator("dialog[open]")

    def load(self, path):
        self.page.locator('#laws input[type="file"]').set_input_files(path)

    def reply(self, question, words):
        """Answer a question of the dialog by the beginning of an answer."""
        label = self.dialog.locator("label", has_text=question)
        label.wait_for()
        answers = label.locator("option").all_inner_texts()
        label.locator("select").select_option(next(a for a in answers if a.startswith(words)))

    def told(self):
        return self.dialog.locator(".told-law").inner_text()

    def is_ready(self, name="Switch on without a bump"):
        return self.dialog.get_by_role("button", name=name).is_enabled()

    def asks(self):
        """Return the number that a faceplate tells of each pump."""
        rows = self.page.locator(".signal", has=self.page.get_by_text("pump_", exact=False))
        texts = rows.locator(".number").all_inner_texts()
        return [float(text.split()[0]) for text in texts]


@pytest.fixture
def bringer(page_of_rig, opened):
    return Bringer(opened(page_of_rig, first=KEPT))


def test_a_regulator_is_asked_about_told_switched_on_and_runs_again(bringer, rig, tmp_path):
    savemat(tmp_path / "reg1.mat", PI)
    bringer.load(tmp_path / "reg1.mat")
    assert "2 integrators" in bringer.dialog.inner_text()
    # Nothing is guessed: without an answer nothing is told, and nothing starts.
    assert bringer.told().startswith("Say in which unit its inputs are")
    assert not bringer.is_ready()
    bringer.reply("Its inputs, the errors, are in", "V")
    bringer.reply("Its outputs are in", "V")
    assert not bringer.is_ready()
    bringer.reply("Its inputs are", "y − r")
    assert "unstable" in bringer.told() and bringer.is_ready()
    bringer.reply("Its inputs are", "r − y")
    told = bringer.told()
    assert "stable; max|S| is" in told and "crossover" in told and "phase margin" in told
    # In percent the same numbers are another controller.
    bringer.reply("Its outputs are in", "%")
    assert bringer.told() != told
    bringer.reply("Its outputs are in", "V")
    assert bringer.told() == told
    bringer.press("Switch on without a bump")
    assert "reg1.mat is now in control" in bringer.page.get_by_role("status").inner_text()
    assert bringer.page.locator("#bar select").last.input_value() != "0"
    field = bringer.page.get_by_role("textbox", name="Setpoint of level_1 in V, typed")
    field.fill("6.5")
    field.press("Enter")
    for _ in range(30):
        bringer.press("One sample")
    path = tmp_path / "session.json"
    session = bringer.session()
    path.write_text(json.dumps(session), encoding="utf-8")
    run = cl.replay(path, *rig)
    # The regulator of the design, from there on.
    controller = cl.design.regulator(rig[0], tmp_path / "reg1.mat")
    taken = {
        name.removeprefix("controller."): value
        for touch in session["touches"]
        for name, value in touch.get("settings", {}).items()
    }
    for name, value in controller.values.items():
        if name in taken and not name.endswith("fading_time"):
            assert taken[name] == pytest.approx(value, rel=1e-7, abs=1e-12)
    assert run.values["level_1"][-1] > 6.2


def test_two_regulators_are_compared_each_asked_about_anew(bringer, tmp_path):
    for name, file in (("reg1.mat", PI), ("reg2.mat", PI | {"D": np.diag([6.0, 5.0])})):
        savemat(tmp_path / name, file)
        bringer.load(tmp_path / name)
        assert bringer.told().startswith("Say in which unit its inputs are")
        bringer.reply("Its inputs, the errors, are in", "V")
        bringer.reply("Its outputs are in", "another")
        bringer.dialog.get_by_role("textbox", name="One of that unit in V").fill("1")
        bringer.reply("Its inputs are", "r − y")
        bringer.press("Switch on without a bump")
    bringer.page.get_by_label("Controller").select_option("reg1.mat")
    for _ in range(3):
        bringer.press("One sample")
    bringer.press("Start empty")
    bringer.press("One sample")
    session = bringer.session()
    # Who has the rig keeps it in a new run, and each its numbers.
    given = {each["of"]: each["settings"] for each in session["touches"] if "settings" in each}
    gains = [each["controller.pump_1.error_gain.level_1"] for each in given.values()]
    assert gains == pytest.approx([-3.05, -6.05], abs=1e-9)
    assert {each["controller"] for each in session["touches"] if "controller" in each} == {
        "Loaded matrices 1"
    }


def test_a_third_regulator_is_asked_whose_place_it_takes_and_a_session_keeps_titles(
    bringer, tmp_path
):
    def answer(name):
        savemat(tmp_path / name, PI)
        bringer.load(tmp_path / name)
        bringer.reply("Its inputs, the errors, are in", "V")
        bringer.reply("Its outputs are in", "another")
        size = bringer.dialog.get_by_role("textbox", name="One of that unit in V")
        size.fill("three")
        assert "“three” is not a number above 0" in bringer.told()
        assert size.get_attribute("aria-invalid") == "true"
        size.fill("100/50")
        bringer.reply("Its inputs are", "r − y")

    titles = bringer.page.locator("#laws .brought b")
    for name in ("reg1.mat", "reg2.mat"):
        answer(name)
        bringer.press("Switch on without a bump")
        bringer.press("One sample")
    # The same file in another way stays where it is.
    answer("reg2.mat")
    bringer.press("Switch on from zero state, no anti-windup")
    bringer.press("One sample")
    own = ["reg1.mat", "reg2.mat, from zero state"]
    assert titles.all_inner_texts() == own
    answer("reg3.mat")
    assert bringer.told() == "Say which controller it replaces. Margins appear here."
    assert not bringer.is_ready()
    bringer.reply("It replaces", "reg1.mat")
    bringer.press("Switch on without a bump")
    bringer.press("One sample")
    own[0] = "reg3.mat"
    assert titles.all_inner_texts() == own
    assert "1 output unit = 100/50 V" in bringer.page.locator("#laws .brought").inner_text()
    session = bringer.session()
    assert session["titles"] == {"Loaded matrices 1": own[0], "Loaded matrices 2": own[1]}
    path = tmp_path / "brought.json"
    path.write_text(json.dumps(session), encoding="utf-8")
    bringer.reload()
    bringer.page.locator('input[aria-label="Session to open"]').set_input_files(path)
    bringer.page.get_by_text("Opened brought.json").wait_for()
    assert titles.all_inner_texts() == own
    offered = bringer.page.locator("#bar select").last.locator("option")
    assert {*own} <= {*offered.all_inner_texts()}
    # A new run has the numbers too.
    bringer.press("Start at rest")
    bringer.press("One sample")
    again = bringer.session()
    assert again["titles"] == session["titles"]
    given = [each["settings"] for each in session["touches"] if "settings" in each][-1]
    assert given in [each["settings"] for each in again["touches"] if "settings" in each]


def test_a_file_is_dropped_anywhere_and_its_name_is_no_markup(bringer, tmp_path):
    savemat(tmp_path / "reg1.mat", PI)
    name = "<img src=x onerror=alert(1)>.mat"
    content = b64encode((tmp_path / "reg1.mat").read_bytes()).decode()
    bringer.page.evaluate(DROP, [content, name])
    bringer.dialog.wait_for()
    assert bringer.dialog.get_by_role("heading").inner_text() == name
    bringer.press("Cancel")
    bringer.page.evaluate(DROP, [content[:200], name])
    alert = bringer.dialog.get_by_role("alert")
    alert.wait_for()
    assert alert.inner_text().startswith(
        f"{name}: got something that is not a MAT file, or is damaged"
    )
    assert bringer.page.locator("img").count() == 0


def test_a_file_that_is_dropped_before_the_page_listens_is_taken(page_of_rig, opened, tmp_path):
    savemat(tmp_path / "reg1.mat", PI)
    page = opened(page_of_rig, first=HELD)
    page.evaluate(DROP, [b64encode((tmp_path / "reg1.mat").read_bytes()).decode(), "reg1.mat"])
    assert page.locator(".told").count() == 0
    page.evaluate("go()")
    assert Bringer(page).dialog.get_by_role("heading").inner_text() == "reg1.mat"


def test_a_regulator_that_comes_with_the_page_is_asked_about_there(built, rig, opened, tmp_path):
    savemat(tmp_path / "reg1.mat", PI)
    page = cl.lab(*rig, tmp_path / "tanks.html", regulators=tmp_path / "reg1.mat")
    bringer = Bringer(opened(page.path))
    bringer.press("Ask and switch on…")
    bringer.dialog.wait_for()
    assert bringer.told().startswith("Say in which unit its inputs are")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"A": np.zeros((2, 3))}, "reg1.mat, A: got 2 × 3, expected a square matrix"),
        ({"D": None}, "it lacks D; save it as in"),
        ({"Ts": 0.5}, "reg1.mat, Ts: got 0.5 s, expected 1 s, the sampling period here"),
        (
            {"B": np.ones((2, 3)), "C": np.ones((3, 2)), "D": np.ones((3, 3))},
            "got 3 inputs and 3 outputs, expected at most 2 inputs",
        ),
    ],
)
def test_what_is_no_regulator_of_this_process_is_told_in_place(bringer, changed, words, tmp_path):
    matrices = {name: each for name, each in (PI | changed).items() if each is not None}
    savemat(tmp_path / "reg1.mat", matrices)
    bringer.load(tmp_path / "reg1.mat")
    assert words in bringer.dialog.get_by_role("alert").inner_text()
    assert not bringer.page.get_by_role("button", name="Switch on", exact=False).count()


def test_typed_loops_are_told_and_run(bringer, rig, tmp_path):
    bringer.press("Load or type one…")
    bringer.page.keyboard.press("Enter")
    assert bringer.told().startswith("Say in which unit")
    bringer.reply("Its gains are in", "V/V")
    assert bringer.told() == "Type K of level_1."
    for name, gain, time in (("level_1", "3", "30"), ("level_2", "2,7", "40")):
        bringer.dialog.get_by_label(f"K of {name}").fill(gain)
        bringer.dialog.get_by_label(f"Ti of {name}, s").fill(time)
    assert "max|S| is" in bringer.told()
    bringer.dialog.get_by_label("Ti of level_2, s").fill("fast")
    assert "level_2, Ti: “fast” is not a time above 0." in bringer.told()
    field = bringer.dialog.get_by_label("Ti of level_2, s")
    assert field.get_attribute("aria-invalid") == "true"
    field.fill("40")
    assert field.get_attribute("aria-invalid") == "false"
    bringer.press("Switch on without a bump")
    assert "PI typed in is now in control" in bringer.page.get_by_role("status").inner_text()
    for _ in range(5):
        bringer.press("One sample")
    path = tmp_path / "session.json"
    path.write_text(json.dumps(bringer.session()), encoding="utf-8")
    run = cl.replay(path, *rig)
    assert float(np.ptp(run.values["pump_1"])) < 1e-9


def test_settings_that_are_copied_are_pasted_into_loops(bringer):
    bringer.page.get_by_text("Settings while it runs").click()
    bringer.page.evaluate("navigator.clipboard.writeText = async (text) => (window.copied = text)")
    bringer.press("Copy these settings")
    copied = bringer.page.evaluate("copied")
    bringer.press("PI or PID…")
    paste = """text => {
        const clipboardData = new DataTransfer();
        clipboardData.setData("text/plain", text);
        document.querySelector("dialog[open] input").dispatchEvent(
            new ClipboardEvent("paste", { clipboardData, bubbles: true, cancelable: true }));
    }"""
    bringer.page.evaluate(paste, copied)
    assert bringer.dialog.get_by_label("K of level_1").input_value() == "3"
    assert "max|S| is" in bringer.told()
    # A unit that is none of those here is asked for.
    bringer.page.evaluate(paste, "level_2\tK\t250\tmm/V")
    assert bringer.dialog.get_by_label("K of level_2").input_value() == "250"
    assert bringer.told().startswith("Say in which unit")


def test_settings_of_a_controller_move_while_it_runs(bringer, rig, tmp_path):
    bringer.page.get_by_text("Settings while it runs").click()
    field = bringer.page.get_by_role("textbox", name="K, proportional gain", exact=False).first
    field.fill("6")
    field.press("Enter")
    bringer.press("One sample")
    session = bringer.session()
    (touch,) = [each for each in session["touches"] if "settings" in each]
    assert touch["settings"]["controller.level_1.proportional_gain"] == 6.0
    path = tmp_path / "session.json"
    path.write_text(json.dumps(session), encoding="utf-8")
    assert cl.replay(path, *rig).session.touches
    with refused(place=f"{path}, touches[0].settings"):
        touch["settings"] = {"controller.level_9.proportional_gain": 1.0}
        path.write_text(json.dumps(session), encoding="utf-8")
        cl.replay(path, *rig)


def test_the_dialogs_are_for_everyone(page_of_rig, opened, look, findings, tmp_path):
    bringer = Bringer(opened(page_of_rig, **look))
    savemat(tmp_path / "reg1.mat", PI)
    bringer.load(tmp_path / "reg1.mat")
    bringer.reply("Its inputs, the errors, are in", "V")
    bringer.reply("Its outputs are in", "V")
    bringer.reply("Its inputs are", "r − y")
    assert findings(bringer.page) == []
    bringer.press("Cancel")
    bringer.press("PI or PID…")
    assert findings(bringer.page) == []
    box, width = bringer.dialog.bounding_box(), bringer.page.viewport_size["width"]
    assert box["x"] >= 0 and box["x"] + box["width"] <= width
