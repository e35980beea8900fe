"""What the page of a laboratory computes beside its rig."""

import pytest
from page_in_node import answered, source

VOLTS = {"name": "pump", "words": "", "unit": "V", "factor": 1, "low": 0, "high": 10}
LEVEL = {"name": "level", "words": "", "unit": "cm", "factor": 100, "low": 0, "high": 0.07}
PACE = f"""
import {{ Pace }} from "{source("lab/pace.ts")}";
const pace = new Pace(given.period);
pace.speed = given.speed;
answer(given.frames.map(([elapsed, most]) => {{
  const done = Math.min(pace.due(elapsed), most);
  pace.computed(done);
  return done;
}}));
"""
TYPED = f"""
import {{ panelText, typed }} from "{source("lab/quantities.ts")}";
answer(given.texts.map(([signal, text]) => {{
  const found = typed(signal, text);
  return [found, typeof found === "number" ? panelText(signal, found) : ""];
}}));
"""
HISTORY = f"""
import {{ History }} from "{source("lab/history.ts")}";
const history = new History(["a"], given.capacity);
for (let sample = 0; sample < given.samples; ++sample) history.add(() => 10 * sample);
answer(history.last(given.window, given.most, ["a"]));
"""


@pytest.mark.parametrize(
    ("speed", "frames", "done"),
    [
        (10, [(0.1, 99)] * 4, [2, 2, 2, 2]),
        # Half of a sample waits for the next frame.
        (1, [(0.25, 99)] * 4, [0, 1, 0, 1]),
        # A page that slept for a minute makes up for it, as fast as it can.
        (1, [(60.0, 50), (0.1, 50), (0.1, 50), (0.1, 50)], [50, 50, 20, 0]),
        # What is too fast for the machine is not owed.
        (1000, [(0.1, 7), (0.1, 7), (0.001, 99)], [7, 7, 3]),
    ],
)  # fmt: skip
def test_samples_are_due_by_the_speed(speed, frames, done, tmp_path):
    assert answered(PACE, {"period": 0.5, "speed": speed, "frames": frames}, tmp_path) == done


def test_typed_numbers_are_taken_in_the_unit_that_is_shown(tmp_path):
    texts = [(VOLTS, "2.5"), (VOLTS, " 2,5 "), (LEVEL, "7"), (LEVEL, "3.5"), (VOLTS, "10.1"),
             (VOLTS, "fast"), (VOLTS, ""), (LEVEL, "−1")]  # fmt: skip
    found = answered(TYPED, {"texts": texts}, tmp_path)
    assert [each for each, _ in found[:4]] == [2.5, 2.5, 0.07, 0.035]
    assert [shown for _, shown in found[:4]] == ["2.50", "2.50", "7.000", "3.500"]
    said = [words for words, _ in found[4:]]
    assert said[0] == "pump: 10.1 V is outside 0 to 10 V; type a number between them."
    assert said[1] == "pump: “fast” is no number; type one in V."
    assert said[2].startswith("pump: “” is no number")
    assert said[3].startswith("level: -1 cm is outside 0 to 7 cm")


@pytest.mark.parametrize(
    ("samples", "window", "most", "seen"),
    [
        (5, 10, 10, [0, 1, 2, 3, 4]),
        (25, 10, 10, list(range(15, 25))),
        (25, 99, 99, list(range(5, 25))),
        (25, 12, 4, [15, 18, 21, 24]),
        (26, 12, 4, [15, 18, 21, 24, 25]),
    ],
)
def test_a_trend_shows_the_last_samples(samples, window, most, seen, tmp_path):
    given = {"capacity": 20, "samples": samples, "window": window, "most": most}
    assert answered(HISTORY, given, tmp_path) == {
        "samples": seen, "values": [[10 * each for each in seen]],
    }  # fmt: skip
