"""Lessons as files: what they ask for, what is right, and what is refused."""

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.laboratory.lessons.lesson import lesson_names, names_lesson, read_lesson
from clepsydra.laboratory.lessons.lesson_data import lesson_data
from clepsydra.laboratory.setups import setups

LESSON = """
title = "A lesson"
process = "quadruple-tank"
text = '''
One *paragraph*
in two lines.

<b>Another</b>.
'''

[controllers.PI]
design = "simc"

[setups.nonminimum]
title = "Non-minimum phase"
process = "quadruple-tank-nonminimum-phase"

[[tasks]]
title = "The first"
setup = "nonminimum"
start = "empty"
controller = "PI"
controller_start = "zero"
settings = { "level_1.integral_time" = "50 s" }
setpoints = { level_1 = "6 V" }
manual = { pump_1 = "30 %" }
hints = ["One.", "Two."]
solution = "Look."

[[tasks.reach]]
words = "Level 1 is held."
where = { level_1 = ["4 V", ""], "pump_1.mode" = "automatic", "outlet_1.area" = "0 cm^2" }
hold = "1 min"

[[tasks.figures]]
words = "Hole 1"
symbol = "a"
unit = "cm^2"
answer = { parameter = "outlet_1.area" }

[[tasks.figures]]
words = "Overshoot"
unit = "%"
measure = { kind = "overshoot", signal = "level_1" }
"""


@pytest.fixture
def written(tmp_path):
    def write(text=LESSON):
        path = tmp_path / "lesson.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_a_lesson_is_read(written):
    lesson = read_lesson(written())
    assert lesson.text == ("One *paragraph* in two lines.", "<b>Another</b>.")
    (task,) = lesson.tasks
    (reach,), (hole, overshoot) = task.reach, task.figures
    assert (task.start, task.controller_start, task.setup) == ("empty", "zero", "nonminimum")
    assert task.manual == {"pump_1": pytest.approx(3.0)}
    assert task.setpoints == {"level_1": pytest.approx(6.0)}
    assert task.settings == {"level_1.integral_time": 50.0}
    assert reach.hold == 60.0
    assert reach.bands["level_1"][0] == pytest.approx(4.0)
    assert reach.bands["pump_1.mode"] == (1.0, 1.0)
    low, high = reach.bands["outlet_1.area"]
    assert low <= 0.0 <= high < 1e-12
    assert hole.answer.value == pytest.approx(0.071e-4)
    assert (overshoot.measure.after, overshoot.measure.until) == (0, 1)
    assert [each.name for each in lesson.rig().controllers] == ["PI"]
    data = lesson_data(lesson)["tasks"][0]
    assert data["figures"][0]["answer"] == pytest.approx(0.071)
    assert data["figures"][1]["factor"] == pytest.approx(100.0)
    assert data["reach"][0]["samples"] == 60
    assert data["solution"] == [] and lesson_data(lesson, answers=True)["tasks"][0]["solution"]


@pytest.mark.parametrize(
    ("before", "after", "place", "words"),
    [
        ('title = "A lesson"\n', "", "line 1", 'got no title, expected one line of text'),
        ('"quadruple-tank"', '"quadruple-tnak"', "process", "'quadruple-tank' was meant"),
        ('"quadruple-tank-nonminimum-phase"', '"three-tanks"', "setups.nonminimum.process",
         "in parameters alone"),
        ("text = '''", "hides = ['outlet_9.area']\ntext = '''", "hides", "was meant"),
        ('settings = {', 'settings = { "gain" = "1", ', "settings.gain", "of that controller"),
        ('setpoints = {', 'setpoints = { level_3 = "1 V", ', "setpoints.level_3", "was meant"),
        ('"simc"', '"smic"', "controllers.PI.design", "'simc' was meant"),
        ('"simc"', '"simc"\ntune = {}', "controllers.PI", "got"),
        ('"simc"', '"start_stop_levels"', "controllers.PI", "this one does not: start/stop levels"),
        ('setup = "nonminimum"', 'setup = "nonminimal"', "tasks.1.setup", "'nonminimum' was meant"),
        ('controller = "PI"', 'controller = "PID"', "tasks.1.controller", "'PI' was meant"),
        ('"empty"', '"full"', "tasks.1.start", "one of stands, rest, empty"),
        ("{ pump_1 =", "{ pump_3 =", "tasks.1.manual.pump_3", "'pump_2' was meant"),
        ('"30 %"', '"30 cm"', "tasks.1.manual.pump_1", "is no unit of it"),
        ('level_1 = ["4 V", ""]', 'levle_1 = "4 V"', "where.levle_1", "'level_1' was meant"),
        ('["4 V", ""]', '["4 V", "3 V"]', "where.level_1", "a lower end below the upper end"),
        ('["4 V", ""]', '["4 V"]', "where.level_1", "a lowest and a highest value"),
        ('"automatic"', '"auto"', "where.pump_1.mode", "'automatic' was meant"),
        ('"1 min"', '"1 m"', "reach.1.hold", "convertible to s"),
        ('unit = "cm^2"', 'unit = "cm"', "figures.1.unit", "a unit of its answer"),
        ('unit = "cm^2"', 'unit = "sqare"', "figures.1.unit", "expected a unit"),
        ('"outlet_1.area" }', '"outlet_9.area" }', "answer.parameter", "was meant"),
        ('{ parameter = "outlet_1.area" }', "{}", "figures.1.answer", "one of value, parameter"),
        ('"overshoot"', '"overshot"', "measure.kind", "'overshoot' was meant"),
        ('signal = "level_1"', 'signal = "pump_1"', "measure.signal", "a controlled measurement"),
        ('signal = "level_1"', 'signal = "level_1", after = 2', "measure.after", "1 to 1"),
        ('signal = "level_1"', 'signal = "level_1", after = 1', "measure.until", "behind `after`"),
        ('hints = ["One.", "Two."]', 'hints = "One."', "tasks.1.hints", "a list of texts"),
        ('hints = ["One.", "Two."]', 'hints = ["a\\u0007"]', "tasks.1.hints", "can be printed"),
        ('hints = ["One.", "Two."]', 'hint = []', "tasks.1.hint", "'hints' was meant"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_its_place(written, before, after, place, words):
    assert before in LESSON
    path = written(LESSON.replace(before, after, 1))
    with refused(place=place) as caught:
        read_lesson(path)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('title = "a"\nprocess = "three-tanks"\ncontrollers.PI.design = "simc"\n', "no tasks"),
        ('title = "a"\nprocess = "three-tanks"\n[[tasks]]\ntitle = "b"\n', "no controllers"),
        ('title = "a"\nprocess = "three-tanks"\ncontrollers.PI.design = "simc"\n'
         '[[tasks]]\ntitle = "b"\nreach = [{ words = "c" }]\n', "no where"),
    ],
)  # fmt: skip
def test_what_is_missing_is_told(written, text, words):
    with pytest.raises(cl.InputError, match=words):
        read_lesson(written(text))


def test_a_lesson_that_is_not_there_is_refused():
    with refused(place="lesson", remedy="'wind-up' was meant"):
        read_lesson("windup")
    with refused(place="nowhere.toml", value="no such file"):
        read_lesson("nowhere.toml")
    assert not names_lesson("nowhere.toml") and not names_lesson("three-tanks")


def test_a_lesson_is_no_process_and_no_study(written):
    path = str(written())
    assert names_lesson(path) and names_lesson(f"{path}#3")
    with refused(remedy="clepsydra lab --lesson"):
        cl.load(path)
    with refused(remedy="clepsydra lab --lesson"):
        cl.study(path)


@pytest.mark.parametrize("name", lesson_names())
def test_lessons_of_clepsydra_are_read_at_every_rig(name):
    """Each holds at rigs that are drawn, whose answers are others."""
    plain, *drawn = (read_lesson(f"{name}#{number}") for number in (0, 1, 2, 3))
    assert plain.name not in [each.name for each in cl.catalogue()]
    for other in drawn:
        pairs = [
            (one.answer.value, two.answer.value)
            for task, their in zip(plain.tasks, other.tasks, strict=True)
            for one, two in zip(task.figures, their.figures, strict=True)
            if one.answer is not None
        ]
        assert pairs and any(one != two for one, two in pairs)
        assert other.address == f"{name}#{other.variant}"


def test_answers_are_those_of_the_drawn_rig():
    """Of Torricelli's law, and of the quadruple tank's relative gain γ₁ γ₂/(γ₁ + γ₂ − 1)."""
    lesson = read_lesson("wind-up#4")
    gain, area = (lesson.process.signal(each).initial for each in ("pump.gain", "outlet.area"))
    (figure,) = lesson.tasks[-1].figures
    assert figure.answer.value == pytest.approx((gain / area) ** 2 / (2 * 9.81), rel=1e-9)
    pairing = read_lesson("pairing#4")
    one, two = (pairing.process.signal(f"splitter_{i}.tank_{i}").initial for i in (1, 2))
    (figure,) = pairing.tasks[0].figures
    assert figure.answer.value == pytest.approx(one * two / (one + two - 1.0), rel=1e-9)


def test_set_ups_of_a_drawn_rig_are_drawn_with_it():
    """One turns the valves of one's own rig, and gets no other glass."""
    own, other = (
        [each.parameters["outlet_1.area"] for each in setups(cl.load(address).process)]
        for address in ("laboratory-four-tanks", "laboratory-four-tanks#5")
    )
    assert len(own) == len(other) > 1
    ratios = [two / one for one, two in zip(own, other, strict=True)]
    assert ratios == pytest.approx([ratios[0]] * len(ratios), rel=1e-12)
    assert ratios[0] != 1.0
