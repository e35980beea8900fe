"""What trends show: of long runs the extremes, from where to where, and what is between cursors."""

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig

THINNED = f"""
import {{ gridOf, Thinned }} from "{source("lab/thinned.ts")}";
let count = 0, looked = 0;
const past = {{
  get first() {{ return given.oldest; }},
  get count() {{ return count; }},
  values(name, first, stop) {{
    looked += stop - first;
    return Float64Array.from({{ length: stop - first }}, (_, place) =>
      first + place >= given.oldest && first + place < count ? given.values[first + place] : NaN);
  }},
}};
const thinned = new Thinned(past);
answer(given.looks.map(([now, first, stop]) => {{
  count = now;
  looked = 0;
  const grid = gridOf(first, stop, given.most);
  const values = thinned.curve("a", grid);
  return {{ ...grid, values, looked }};
}}));
"""
VIEW = f"""
import {{ View }} from "{source("lab/view.ts")}";
const view = new View(100);
answer(given.hands.map(([what, ...numbers]) => {{
  view[what](...numbers);
  const {{ first, last, isFollowing, cursors, stretch }} = view;
  return {{ first, last, isFollowing, cursors: [...cursors], stretch: stretch ?? null }};
}}));
"""
MARKS = f"""
import {{ Marks }} from "{source("lab/marks.ts")}";
import {{ TouchWords }} from "{source("lab/touch_words.ts")}";
const marks = new Marks(new TouchWords(given.data, (name) => name));
const [touches, happened] = [[], []];
answer(given.looks.map(([done, been, first, last, apart]) => {{
  touches.push(...given.touches.slice(touches.length, done));
  happened.push(...given.happened.slice(happened.length, been));
  marks.read(touches, happened);
  const near = marks.near(last, 3).map(({{ words }}) => words);
  return {{ places: marks.places(first, last, apart), near }};
}}));
"""


def extremes(values, first, stop):
    part = [value for value in values[first:stop] if not np.isnan(value)]
    return (min(part), max(part)) if part else (np.nan, np.nan)


def test_a_long_curve_has_the_extremes_of_each_bucket(tmp_path):
    values = np.random.default_rng(1).normal(size=5000).tolist()
    # It goes on, is zoomed out, scrolls back, and begins before what is kept.
    looks = [(900, 0, 900), (2000, 0, 2000), (2003, 0, 2003), (2400, 0, 2400), (5000, 0, 5000),
             (5000, 3000, 3300), (5000, 3000, 4000), (5000, 60, 1060)]  # fmt: skip
    given = {"values": values, "looks": looks, "most": 400, "oldest": 100}
    seen = [np.nan] * 100 + values[100:]
    for (now, first, stop), told in zip(looks, answered(THINNED, given, tmp_path), strict=True):
        stride, samples = told["stride"], told["samples"]
        past = seen[:now]
        assert len(samples) <= given["most"] + 2
        assert samples[0] <= first and stop <= samples[-1] + max(1, stride / 2)
        if stride == 1:
            np.testing.assert_array_equal(told["values"], past[first:stop])
            continue
        pairs = zip(samples[::2], told["values"][::2], told["values"][1::2], strict=True)
        for sample, *pair in pairs:
            wanted = extremes(past, sample, sample + stride)
            np.testing.assert_array_equal(sorted(pair), wanted)
            if not np.isnan(pair[0]):
                assert past[sample:].index(pair[0]) <= past[sample:].index(pair[1])


def test_of_a_curve_that_goes_on_only_what_is_new_is_looked_at(tmp_path):
    looks = [(100_000, 0, 100_000), (100_010, 0, 100_000), (101_000, 1000, 101_000)]
    given = {"values": [0.5] * 101_000, "looks": looks, "most": 800, "oldest": 0}
    first, second, third = answered(THINNED, given, tmp_path)
    assert first["stride"] == third["stride"] == 256
    assert 100_000 <= first["looked"] < 100_256
    assert second["looked"] <= 256
    assert third["looked"] < 1300


def test_what_is_seen_follows_the_run_until_a_hand_takes_it(tmp_path):
    hands = [
        ("reach", 0, 50), ("reach", 0, 500), ("zoom", 0.5, 450), ("reach", 0, 600),
        ("zoom", 2.0, 450), ("pan", 1000), ("pan", -9999), ("show", 200, 300), ("show", 590, 650),
        ("show", 200, 201), ("all",), ("follow", 40), ("reach", 580, 900), ("zoom", 1e9, 0),
        ("zoom", 1e-9, 600),
    ]  # fmt: skip
    found = answered(VIEW, {"hands": hands}, tmp_path)
    seen = [(each["first"], each["last"], each["isFollowing"]) for each in found]
    assert seen == [
        (0, 100, True), (400, 500, True), (425, 475, False), (425, 475, False),
        (400, 500, False), (500, 600, True), (0, 100, False), (200, 300, False), (540, 600, True),
        (195.5, 205.5, False), (0, 600, True), (560, 600, True), (860, 900, True),
        (580, 900, True), (600 - 20 * 10 / 320, 600 - 20 * 10 / 320 + 10, False),
    ]  # fmt: skip


def test_cursors_are_set_moved_and_held_within_the_run(tmp_path):
    hands = [("reach", 0, 500), ("mark", 300.4), ("mark", 120), ("mark", 140), ("move", 305),
             ("mark", 9999), ("reach", 310, 800), ("unmark",)]  # fmt: skip
    found = answered(VIEW, {"hands": hands}, tmp_path)
    assert [each["cursors"] for each in found] == [
        [], [300], [300, 120], [300, 140], [300, 305], [300, 499], [310, 499], [],
    ]  # fmt: skip
    assert found[2]["stretch"] == [120, 300]
    assert [each["stretch"] for each in (found[1], found[-1])] == [None, None]


@pytest.mark.parametrize(("samples", "stride"), [(400, 1), (401, 4), (801, 8), (1_000_000, 8192)])
def test_points_share_as_many_samples_as_they_must(samples, stride, tmp_path):
    given = {"values": [], "looks": [(0, 0, samples)], "most": 400, "oldest": 0}
    (told,) = answered(THINNED, given, tmp_path)
    assert told["stride"] == stride


def marks(touches, happened, looks, folder):
    plant = cl.load("quadruple-tank")
    data = page_data(Rig(plant.linear, [cl.design.simc(plant)]))
    given = {"data": data, "touches": touches, "happened": happened, "looks": looks}
    found = answered(MARKS, given, folder)
    return [
        ([(at["sample"], at["isAbnormal"]) for at in each["places"]], each["near"])
        for each in found
    ]


def happening(sample, words, *, is_abnormal=False):
    return {
        "sample": sample, "kind": "event", "of": "x", "words": words, "isAbnormal": is_abnormal,
    }  # fmt: skip


def test_marks_tell_what_was_done_and_what_happened(tmp_path):
    touches = [
        {"sample": 0, "input": "level_1.setpoint", "value": 7.0},
        {"sample": 0, "input": "pump_1.mode", "value": 0},
        {"sample": 4, "input": "pump_1.stopped", "value": 1},
        {"sample": 7, "noise": True},
    ]
    happened = [happening(4, "tank_1 spills", is_abnormal=True), happening(5, "it rains")]
    looks = [
        (2, 0, 0, 2, 1), (3, 1, 0, 4, 1), (4, 2, 0, 7, 1), (4, 2, 4, 6, 1), (4, 2, 0, 9, 3),
        (4, 2, 0, 9, 100),
    ]  # fmt: skip
    first = "setpoint of level_1 to 7.00 V, pump_1 to manual"
    stopped = "pump_1 stopped, tank_1 spills"
    assert marks(touches, happened, looks, tmp_path) == [
        ([(0, False)], [first]),
        ([(0, False), (4, True)], [stopped]),
        ([(0, False), (4, True), (5, False), (7, False)], ["noise on", "it rains", stopped]),
        ([(4, True), (5, False)], ["it rains", "noise on", stopped]),
        ([(0, False), (4, True), (7, False)], ["noise on"]),
        ([(0, True)], ["noise on"]),
    ]


def test_marks_of_a_run_that_is_opened_come_in_their_order(tmp_path):
    touches = [{"sample": sample, "noise": True} for sample in (0, 50)]
    happened = [happening(20, "it rains"), happening(30, "it pours", is_abnormal=True)]
    looks = [(2, 0, 0, 60, 1), (2, 2, 0, 60, 1)]
    (before, _), (after, _) = marks(touches, happened, looks, tmp_path)
    assert before == [(0, False), (50, False)]
    assert after == [(0, False), (20, False), (30, True), (50, False)]
