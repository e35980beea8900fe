"""Every mistake in a case gets one message with line, key, value and remedy."""

import pytest
from refusals import refused
from study_texts import BASIN, QUADRUPLE

import clepsydra as cl


def case(*lines, name="low", of=QUADRUPLE):
    return f"{of}[cases.{name}]\n" + "\n".join(lines) + "\n"


def at(values, of=QUADRUPLE):
    return case(f"operating_point = {{ {values} }}", of=of)


def step(to):
    """Return a study of a basin at 50 % with a step of its level."""
    steps = '[[scenario.setpoint]]\nsignal = "level"\nat = "1 h"\n'
    return f'{BASIN}[scenario]\nduration = "9 h"\n{steps}{to}\n'


MISTAKES = [
    (f"{QUADRUPLE}cases = 3\n", "line 2, cases: got 3, expected a table"),
    (
        case(),
        "line 2, cases.low: got neither operating_point nor variant, expected what differs from "
        "the study; write as in operating_point = ",
    ),
    (case('operting_point = "a"'), "line 3, cases.low.operting_point: got 'operting_point', "),
    (case('operting_point = "a"'), "perhaps 'operating_point' was meant"),
    (case('operating_point = "low"'), "cases.low.operating_point: got 'low', expected a table"),
    (
        at("level_7 = '4 V'"),
        "line 3, cases.low.operating_point.level_7: got 'level_7', expected a measurement, an "
        "input or a disturbance of quadruple-tank (",
    ),
    (at("level_1 = '4 l'"), "operating_point.level_1: got '4 l', expected a value of level_1"),
    (at("level_1 = '14 V'"), "expected a value from 0 to 10 V, the range of level_1"),
    (
        at("level_1 = '4 V'"),
        "line 3, cases.low.operating_point: got 'level_1', expected exactly 2 outputs, one for "
        "each manipulated input (pump_1, pump_2)",
    ),
    (
        at("level_1 = '9.9 V', level_2 = '0.1 V'"),
        'line 3, cases.low.operating_point: got \'{"level_1": "9.9 V", "level_2": "0.1 V"}\', '
        "expected a case in which quadruple-tank rests: ",
    ),
    (
        case("operating_point = { inflow = '10 %' }", of='process = "averaging-tank:all-inputs"\n'),
        "line 3, cases.low.operating_point: got no outflow, inflow.impurity, expected a value of "
        "every input, since the file of averaging-tank gives measurements at rest (volume, ",
    ),
    (case('settings = "frosen"', "operating_point = {}"), "cases.low.settings: got 'frosen', "),
    (case('variant = "big"'), "cases.low.variant: got 'big', expected no variant, since "),
    (case("variant = 3"), "cases.low.variant: got 3, expected the name of a variant, or a list"),
    (case("operating_point = {}", name='"base case"'), "expected another name: 'base case' is "),
    (case("operating_point = {}", name=f'"{50 * "a"}"'), "expected a name of 1 to 40 characters"),
    (
        at("level = '90 %'", of=step('by = "20 %"')),
        "line 7, scenario.setpoint.1.by, in the case low: got '20 %, to 110 %', expected a "
        "setpoint from 0 to 100 %",
    ),
    (
        at("level = '40 %'", of=step('to = "40 %"')),
        "scenario.setpoint.1.to, in the case low: got '40 %', expected a change of level",
    ),
]


@pytest.mark.parametrize(("text", "said"), MISTAKES)
def test_the_message(message, text, said):
    found = message(text)
    assert said in found, found
    assert found.startswith("s.toml") and "\n" not in found


def test_calls_are_refused_too():
    plant = cl.load("quadruple-tank")
    low = plant.at(outputs={"level_1": "4 V", "level_2": "4 V"})
    pi = cl.design.simc(plant)
    with refused(place="study, cases", expected="names with their plants"):
        cl.study(plant, [pi], cases=[low])
    with refused(place="study, cases, low", expected="a plant"):
        cl.study(plant, [pi], cases={"low": "quadruple-tank"})
    with refused(place="study, cases", value="quadruple-tank, which controls level_1, level_2"):
        cl.study(cl.load("three-tanks"), cases={"other": plant})
    with refused(place="study, designed_anew", value="lo", remedy="perhaps 'low' was meant"):
        cl.study(plant, cases={"low": low}, designed_anew=["lo"])
    with refused(place="study, designed_anew", expected="no such case where controllers are given"):
        cl.study(plant, [pi], cases={"low": low}, designed_anew=["low"])
