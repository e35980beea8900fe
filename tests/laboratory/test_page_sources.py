"""What the page of a laboratory computes beside its rig."""

import numpy as np
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
const fork = history.fork(given.fork);
for (let sample = 0; sample < 3; ++sample) fork.add(() => -10);
answer({{
  seen: history.values("a", given.first, given.stop),
  strange: history.values("b", 0, 2),
  kept: [history.first, history.count],
  fork: [fork.first, fork.count, fork.value("a", given.fork - 1), fork.value("a", given.fork)],
  own: history.value("a", given.fork),
}});
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
    assert said[1] == "pump: “fast” is not a number; type one in V."
    assert said[2].startswith("pump: “” is not a number")
    assert said[3].startswith("level: -1 cm is outside 0 to 7 cm")


@pytest.mark.parametrize(
    ("samples", "first", "stop"), [(5, 0, 10), (25, 15, 25), (25, -3, 4), (40_000, 8000, 40_001)]
)
def test_a_history_has_each_sample_of_a_stretch(samples, first, stop, tmp_path):
    given = {"capacity": 20_000, "samples": samples, "first": first, "stop": stop}
    given["fork"] = samples - 2
    found = answered(HISTORY, given, tmp_path)
    oldest, end = found["kept"]
    there = range(oldest, end)
    assert [found["seen"][sample - first] for sample in range(first, stop) if sample in there] == [
        10 * sample for sample in range(first, stop) if sample in there
    ]
    gone = [found["seen"][k - first] for k in range(first, stop) if k not in there]
    assert np.isnan([*gone, *found["strange"]]).all()
    # Of 40,000 samples at least 20,000 are kept, and no more than one part beyond.
    assert 20_000 <= end - oldest < 40_000 if samples > 20_000 else oldest == 0
    assert end == samples
    # A branch has the same past, and leaves the other one alone.
    assert found["fork"] == [oldest, samples + 1, 10 * (samples - 3), -10]
    assert found["own"] == 10 * (samples - 2)
