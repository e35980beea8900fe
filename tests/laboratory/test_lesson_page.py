"""What the page of a lesson judges: steps of a run, and typed numbers."""

import pytest
from page_in_node import answered, source

REACHED = f"""
import {{ Reached }} from "{source("lab/reached.ts")}";
const reached = new Reached(given.steps, given.first ?? 0);
const seen = {{
  value: (name, sample) => given.runs[name][sample] ?? NaN,
  controller: (sample) => given.leading?.[sample] ?? "",
}};
const found = given.looks.map((stop) => {{
  reached.look(stop, seen);
  return [[...reached.at], Number(reached.share.toFixed(6))];
}});
answer(found);
"""
JUDGED = f"""
import {{ verdict, measuredText }} from "{source("lab/judged.ts")}";
const figure = {{ unit: "cm", factor: 100, answer: 14, tolerance: 0.05, measure: null }};
answer({{
  typed: given.texts.map((text) => verdict(figure, text)),
  any: verdict({{ ...figure, answer: null }}, "3"),
  zero: verdict({{ ...figure, answer: 0 }}, "0.02"),
  measured: [0.1234, NaN, Infinity].map((value) => measuredText(figure, value)),
}});
"""


def step(bands, samples=1, controller=""):
    return {"words": "", "bands": bands, "controller": controller, "samples": samples}


@pytest.mark.parametrize(
    ("steps", "runs", "more", "found"),
    [
        # Steps come one after the other; what held before its turn does not count.
        ([step({"y": [1, 2]}), step({"u": [0, 0]})],
         {"y": [0, 0, 1, 1, 1, 1], "u": [0, 0, 0, 1, 0, 0]}, {}, [2, 4]),
        # A step that has to last begins again where it breaks off.
        ([step({"y": [None, 1]}, 3)], {"y": [0, 0, 5, 0, 0, 0]}, {}, [5]),
        ([step({"y": [None, 1]}, 3)], {"y": [0, 0, 5, 0, 0, 5]}, {}, []),
        # What there is not holds nowhere.
        ([step({"z": [None, None]})], {"z": []}, {}, []),
        ([step({}, 1, "B")], {}, {"leading": ["A", "A", "A", "B", "B", "B"]}, [3]),
        ([step({"y": [1, 1]})], {"y": [1, 0, 0, 0, 1, 1]}, {"first": 2}, [4]),
    ],
)  # fmt: skip
def test_steps_are_reached_in_their_order(steps, runs, more, found, tmp_path):
    for looks in ([6], [1, 2, 3, 4, 5, 6], [4, 6]):
        given = {"steps": steps, "runs": runs, "looks": looks} | more
        assert answered(REACHED, given, tmp_path)[-1][0] == found


def test_how_long_a_step_has_held_is_told(tmp_path):
    given = {
        "steps": [step({"y": [0, 1]}, 4)],
        "runs": {"y": [0, 5, 0, 0, 0, 0]},
        "looks": [2, 4, 6],
    }
    assert answered(REACHED, given, tmp_path) == [[[], 0], [[], 0.5], [[5], 1]]


def test_typed_numbers_are_judged(tmp_path):
    texts = ["14", "13,4", " 14.69", "14.71", "-14", "−14", "", "fast", "1e1"]
    found = answered(JUDGED, {"texts": texts}, tmp_path)
    assert [each["isFine"] for each in found["typed"]] == [True, True, True] + [False] * 6
    assert found["typed"][0]["words"] == "right"
    assert found["typed"][3]["words"] == "not within 5 % yet"
    assert found["typed"][6]["words"] == ""
    assert found["typed"][7]["words"] == "“fast” is not a number; type one in cm"
    assert found["any"] == {"isFine": True, "words": "noted"} and found["zero"]["isFine"]
    assert found["measured"] == ["12.3 cm", "–", "∞"]
