"""The laboratory session of the fifth document, done in the page of its lesson."""

import json
import re
from pathlib import Path

import pytest
from lab_hand import KEPT
from pupil import Pupil

import clepsydra as cl

pytestmark = pytest.mark.browser
#: Of a tank [cm²], the level that counts as 100 % [cm], and twice the gravity [cm/s²].
AREA, FULL, TWICE_G = 15.5179, 25.0, 2 * 981.0
TANKS, PUMPS = (1, 2, 3, 4), (1, 2)


@pytest.fixture(scope="module")
def rows():
    """What the audit computes of a printed number, by its place and name."""
    found = cl.audit(["four-tank-laboratory"]).rows
    return {(row.place, row.name): row for row in found}


@pytest.fixture(scope="module")
def page_of_session(built, tmp_path_factory):
    return cl.lesson("four-tanks", tmp_path_factory.mktemp("course") / "four-tanks.html").path


@pytest.fixture
def pupil(page_of_session, opened):
    return Pupil(opened(page_of_session, first=KEPT))


def by_hand(pupil, one, two):
    for name, value in (("pump_1", one), ("pump_2", two)):
        pupil.type(f"Manual value of {name}", str(value), "%")


def levels(pupil, *words):
    """Return the levels that were measured [cm]."""
    return [pupil.figure(f"Level {tank} {' '.join(words)}") * FULL / 100 for tank in TANKS]


def test_gains_are_found_by_plugging_and_filling(pupil, rows):
    pupil.begin("1. Gains of the pumps (2.1.7)")
    for tank in TANKS:
        pupil.press(f"Plug outlet_{tank}")
    pupil.page.locator("#hands summary").click()
    assert not pupil.page.get_by_label("cross-section of outlet_1").count()
    for pump in PUMPS:
        field = pupil.page.get_by_label(f"fraction to tank_{pump} at splitter_{pump}")
        field.fill("1")
        field.press("Enter")
    pupil.press("One sample")
    begun, start = pupil.time(), [pupil.number(f"level_{tank}") for tank in PUMPS]
    by_hand(pupil, 50, 50)
    pupil.run(10.2 / 60, "1×")
    assert pupil.reached() == 2
    # What is told of a level is where it stood when the last sample began.
    elapsed = pupil.time() - begun - 0.05
    for pump in PUMPS:
        rise = (pupil.number(f"level_{pump}") - start[pump - 1]) * FULL / 100
        gain = AREA * rise / (50 * elapsed)
        assert pupil.answer(f"Gain of pump {pump}", f"{gain:.3f}") == "right"
        # A percent of 15 V; levels are told to a tenth of a percent, of about ninety.
        assert gain * 100 / 15 == pytest.approx(
            rows["Exercise 2.1.7", f"k{pump}"].printed, rel=4e-3
        )


@pytest.mark.parametrize(
    ("task", "table", "phase", "places", "split"),
    [
        ("2. Holes, minimum phase (2.1.8)", "Table 1", "minimum phase",
         ("(24)", "(24)", "(22)", "(23)"), 0.625),
        ("3. Holes, non-minimum phase (2.1.8)", "Table 2", "non-minimum phase", ("(25)",) * 4,
         0.375),
    ],
)  # fmt: skip
def test_holes_are_found_at_rest(task, table, phase, places, split, pupil, rows):
    pupil.begin(task)
    by_hand(pupil, 50, 50)
    pupil.run(12)
    heights = levels(pupil, "at rest")
    one, two = (50 * gain for gain in (0.648, 0.561))
    through = [split * one + (1 - split) * two, split * two + (1 - split) * one,
               (1 - split) * two, (1 - split) * one]  # fmt: skip
    for tank, height, flow, place in zip(TANKS, heights, through, places, strict=True):
        row = rows[table, f"h{tank}"]
        # Three digits of a percent are told.
        assert height == pytest.approx(row.computed, rel=6e-3)
        assert height == pytest.approx(row.printed, rel=6e-3)
        hole = flow / (TWICE_G * height) ** 0.5
        assert pupil.answer(f"Hole {tank}", f"{hole:.4f}") == "right"
        assert hole == pytest.approx(rows[place, f"a{tank}, {phase}"].printed, rel=5e-3)


def test_a_forecast_comes_true(pupil):
    pupil.begin("4. A forecast (2.2.1)")
    for tank, at_fifty in ((1, 19.752), (2, 27.278)):
        forecast = 0.8**2 * at_fifty * 100 / FULL
        assert pupil.answer(f"Forecast of level {tank}", f"{forecast:.1f}") == "right"
    pupil.run(12)
    assert pupil.figure("Level 1 as it came") == pytest.approx(50.6, abs=0.1)
    assert pupil.figure("Level 2 as it came") == pytest.approx(69.8, abs=0.1)


@pytest.mark.parametrize(
    ("task", "filled", "gain"),
    [("5. Coupling, minimum phase (2.2.2)", (1, 4), "1.5625"),
     ("6. Coupling, non-minimum phase (2.2.2)", (2,), "-0.5625")],
)  # fmt: skip
def test_one_pump_fills_the_tanks_that_it_is_coupled_to(task, filled, gain, pupil, rows):
    pupil.begin(task)
    pupil.run(6)
    by_hand(pupil, 0, 50)
    pupil.run(6)
    assert pupil.reached() == 2
    told = [int(text) for text in re.findall(r"Level (\d) by pump 1", pupil.panel.inner_text())]
    found = {tank: pupil.figure(f"Level {tank} by pump 1") for tank in told}
    assert min(found[tank] for tank in filled) > max(
        level for tank, level in found.items() if tank not in filled
    )
    assert rows["(19)", "RGA, row 1, column 1"].printed == 1.5625
    assert rows["(20)", "RGA, row 1, column 1"].printed == -0.5625
    assert pupil.answer("Relative gain", gain) == "right"


@pytest.mark.parametrize(
    ("task", "phase", "held"),
    [("7. By hand to 15 cm, minimum phase (2.2.3)", "minimum phase", (52.5, 26.4)),
     ("8. By hand to 15 cm, non-minimum phase (2.2.3)", "non-minimum phase", (27.0, 56.5))],
)  # fmt: skip
def test_levels_are_held_by_hand(task, phase, held, pupil, rows):
    pupil.begin(task)
    pupil.run(12)
    words = "with 44 %" if phase == "minimum phase" else "with 32 %"
    found = [pupil.figure(f"Level {tank} {words}") * FULL / 100 for tank in PUMPS]
    row = rows["Exercise 2.2.3", f"level of both lower tanks, {phase}, holes of the report"]
    farther = max(found, key=lambda level: abs(level - row.printed))
    assert farther == pytest.approx(row.computed, rel=6e-3)
    # The slower lower tank of the audit, to 5 % and to 2 %, is tank 1 or tank 2.
    early, late = (pupil.figure(f"Until level 1 is within {band} %") for band in (5, 2))
    figure = "Fig. 5" if phase == "minimum phase" else "Fig. 6"
    least, most = map(
        float, rows[f"Exercise 2.2.3, {figure}", f"transient, {phase}"].computed.split(" to ")
    )
    assert early < late <= most + 1.0 and early <= least + 1.0
    by_hand(pupil, *held)
    pupil.run(20)
    assert pupil.reached() == 2
    if phase == "minimum phase":
        for pump in PUMPS:
            words = f"Pump {pump} for 60 %"
            assert pupil.answer(words, str(held[pump - 1])) == "right"


@pytest.mark.parametrize(
    ("task", "table", "phase", "stretch"),
    [("9. Decentralised PI control, minimum phase (4.1)", "Table 5", "minimum phase", 2.5),
     ("10. Decentralised PI control, non-minimum phase (4.1)", "Table 5", "non-minimum phase", 14),
     ("11. Glover-McFarlane control, minimum phase (4.2)", "Table 6", "minimum phase", 2.5),
     ("12. Glover-McFarlane control, non-minimum phase (4.2)", "Table 6", "non-minimum phase", 14)],
)  # fmt: skip
def test_controllers_step_and_take_pours_away(task, table, phase, stretch, pupil, rows):
    """Ours are those of the audit, whose medians are over a noisy simulator."""
    pupil.begin(task)
    pupil.run(stretch)
    for tank in PUMPS:
        pupil.press(f"Pour +25 % into tank_{tank}")
        pupil.run(stretch)
    assert pupil.reached() == 5
    for score, words in (("rise", "Rise"), ("overshoot", "Overshoot"), ("recovery", "Recovery")):
        for tank in PUMPS:
            row = rows.get((table, f"{score} {tank}, {phase}"))
            if row is not None:
                found = pupil.figure(f"{words} of level {tank}")
                assert found == pytest.approx(row.computed, rel=0.05, abs=1.6), (score, tank)


def test_a_regulator_of_ones_own_takes_the_place_of_the_lessons(pupil, rows, tmp_path):
    """The matrices of the lesson from a file, switched on from zero state."""
    shipped = Path(cl.__file__).parent / "laboratory" / "lessons" / "shipped" / "regulators"
    path = tmp_path / "reg1.mat"
    path.write_bytes((shipped / "glover-mcfarlane-minimum-phase.mat").read_bytes())
    pupil.begin("11. Glover-McFarlane control, minimum phase (4.2)")
    pupil.page.locator('#laws input[type="file"]').set_input_files(path)
    dialog = pupil.page.locator("dialog[open]")
    for question, answer in (
        ("Its inputs, the errors, are in", "%"), ("Its outputs are in", "%"),
        ("Its inputs are", "r − y"),
    ):  # fmt: skip
        label = dialog.locator("label", has_text=question)
        label.wait_for()
        options = label.locator("option").all_inner_texts()
        label.locator("select").select_option(next(o for o in options if o.startswith(answer)))
    pupil.press("Switch on from zero state, no anti-windup")
    pupil.run(2.5)
    assert pupil.reached() == 1
    for score, words in (("rise 1/2", "Rise of level 2"), ("overshoot 2", "Overshoot of level 2")):
        row = rows["Table 6", f"{score}, minimum phase"]
        assert pupil.figure(words) == pytest.approx(row.computed, rel=0.05)
    path = tmp_path / "session.json"
    path.write_text(json.dumps(pupil.session()), encoding="utf-8")
    run = cl.replay(path)
    assert run.session.process == "four-tanks"
    assert 100 * run.values["level_1"][-1] == pytest.approx(pupil.number("level_1"), abs=0.051)
