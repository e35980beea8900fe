"""Settings of a loop as a reader types them: taken in SI, or told what is wrong."""

import pytest
from page_in_node import answered, source

SCRIPT = f"""
import {{ pastedSettings, typedLoop, WrongLoop }} from "{source("lab/typed_numbers.ts")}";
import {{ loopSettings }} from "{source("lab/typed_loops.ts")}";
answer(given.map(([texts, form]) => {{
  const all = {{ gain: "", integral: "", derivative: "", weight: "", filter: "", ...texts }};
  const found = typedLoop("level", all, form, 0.5);
  return found instanceof WrongLoop ? found.words : loopSettings(found, form, 0.2);
}}));
"""


def test_what_is_typed_becomes_parameters_of_the_law(tmp_path):
    """Gains in a unit that is half of one in SI; what is left out is as a control system has it."""
    pi, p, pid, parallel, integral = answered(
        SCRIPT,
        [
            [{"gain": "3", "integral": "30"}, "isa"],
            [{"gain": "−2,5", "weight": "0"}, "series"],
            [{"gain": "3", "integral": "40", "derivative": "2.5", "filter": "8"}, "isa"],
            [{"gain": "4", "integral": "0.1", "derivative": "10"}, "parallel"],
            [{"integral": "0.1"}, "parallel"],
        ],
        tmp_path,
    )
    assert pi == {
        "proportional_gain": 1.5, "integral_time": 30, "derivative_time": 0,
        "derivative_filter": 10, "setpoint_weight": 1, "tracking_time": 30,
    }  # fmt: skip
    assert (p["proportional_gain"], p["integral_time"], p["setpoint_weight"]) == (-1.25, 1e9, 0)
    # √(Ti Td), as of the designs.
    assert pid["tracking_time"] == pytest.approx(10.0) and pid["derivative_filter"] == 8
    assert parallel["integral_gain"] == pytest.approx(0.05)
    assert parallel["derivative_gain"] == 5 and parallel["filter_time"] == pytest.approx(0.25)
    assert parallel["tracking_time"] == pytest.approx(10.0)
    # Alone, the integral is told within a sample.
    assert integral["proportional_gain"] == 0 and integral["tracking_time"] == 0.2


@pytest.mark.parametrize(
    ("texts", "form", "words"),
    [
        ({}, "isa", "Type K of level."),
        ({}, "parallel", "Type K, Ki or Kd of level."),
        ({"gain": "three"}, "isa", "level, K: “three” is not a number."),
        ({"gain": "1e10"}, "isa", "level, K: “1e10” is not a number."),
        ({"gain": "3", "integral": "0"}, "isa", "level, Ti: “0” is not a time above 0."),
        ({"gain": "3", "derivative": "-1"}, "series", "level, Td: “-1” is not a time, 0 or above."),
        ({"gain": "3", "weight": "2"}, "isa", "level, b: “2” is not a number from 0 to 1."),
        ({"gain": "3", "filter": "0.5"}, "isa", "level, N: “0.5” is not a number from 1 to 1000."),
        ({"gain": "3", "filter": "0"}, "parallel", "level, Tf: “0” is not a time above 0."),
        ({"gain": "3", "integral": "-1"}, "parallel", "level: K, Ki and Kd have to have one sign."),
    ],
)
def test_what_is_wrong_is_told(texts, form, words, tmp_path):
    assert answered(SCRIPT, [[texts, form]], tmp_path) == [words]


def test_what_a_report_copies_is_told_line_by_line(tmp_path):
    text = "level_1\tK\t3.5\tV/V\r\nlevel_1\tTi\t30\ts\nlevel_1\tb\t0,5\nnote\n\tK\t3\na\tK\tx"
    script = SCRIPT.partition("answer(")[0] + "answer(pastedSettings(given));"
    found = answered(script, text, tmp_path)
    assert [list(each.values()) for each in found] == [
        ["level_1", "K", "3.5", "V/V"],
        ["level_1", "Ti", "30", "s"],
        ["level_1", "b", "0,5", ""],
    ]
