"""What a page makes of the samples that come to it, run by Node as it stands."""

import math

import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.rig import Rig
from clepsydra.rig.assembly import plant_settings
from clepsydra.rig.doors.page.document import attached_data

SCRIPT = f"""
import {{ AttachedRig }} from "{source("lab/attached/attached_rig.ts")}";
const sent = [];
const rig = new AttachedRig(given.data, (hand) => sent.push(hand));
const {{ columns, rows }} = given;
/** Return rows as they come: each a sample, its time, and what differs from rest. */
const flat = (...some) => Float64Array.from(some.flatMap(([sample, time, others = {{}}]) =>
  [sample, time, ...rows.map((value, place) => others[columns[place]] ?? value)]));
const meet = (start) => rig.meet({{ plant: "", start, columns, isViewer: false }});
const level = (first, stop) => [...rig.run.history.values("level_1", first, stop)];
meet("one");
"""


@pytest.fixture(scope="module")
def given():
    plant = cl.load("quadruple-tank")
    bench = Rig(plant.linear, [cl.design.simc(plant)])
    settings = plant_settings(bench, speed=1.0, fail_safe={})
    columns = settings.layout.columns
    at_rest = {**settings.at_rest, "level_1": 6.0, "controller.heard": 1.0}
    return {
        "data": attached_data(bench, settings, speed=1.0),
        "columns": list(columns),
        "rows": [at_rest.get(name, 0.0) for name in columns],
    }


@pytest.fixture
def run(given, tmp_path):
    return lambda script: answered(SCRIPT + script, given, tmp_path)


def test_a_page_begins_with_any_sample_and_leaves_a_gap_where_some_are_missing(run):
    first, count, values = run("""
        rig.take(flat([9000, 1], [9001, 2, { level_1: 7 }], [9004, 5, { level_1: 8 }]));
        const { first, count } = rig.run.history;
        answer([first, count, level(8999, 9006)]);
    """)
    assert (first, count) == (9000, 9005)
    assert values[1:3] == [6.0, 7.0]
    assert values[5] == 8.0
    assert all(math.isnan(values[place]) for place in (0, 3, 4, 6))


def test_samples_after_a_lost_connection_join_those_of_the_same_start(run):
    found = run("""
        const counts = [];
        const told = () => counts.push([rig.run.history.first, rig.run.history.count]);
        rig.take(flat([10, 10], [11, 11]));
        // The door was started again: the sample that it has already tells that nothing is new.
        meet("one");
        rig.take(flat([13, 13]));
        told();
        // A rig that went on, by its last sample; then another one, whose samples only fit.
        meet("two");
        rig.take(flat([13, 13], [14, 14]));
        told();
        meet("three");
        rig.take(flat([13, 99], [14, 100], [15, 101]));
        told();
        meet("four");
        rig.take(flat([2, 200]));
        told();
        answer(counts);
    """)
    assert found == [[10, 14], [10, 15], [13, 16], [2, 3]]


def test_what_others_do_is_read_from_what_moves_the_plant(run):
    touches, happened = run("""
        const setpoint = { "level_1.setpoint": 5 };
        rig.take(flat([0, 0],
          [1, 1, { ...setpoint, "level_2.forced": 1, "level_2.reading": 3 }],
          [2, 2, { ...setpoint, "level_1.drift": 0.5, "instructor.noise": 1, "operator.remote": 0,
                   "pump_1.command": 9, "controller.heartbeat": 7, "controller.heard": 0 }]));
        answer([rig.run.touches, rig.run.happened.filter(({ of }) => of === "controller.heard")]);
    """)
    assert touches == [
        {"sample": 1, "input": "level_1.setpoint", "value": 5},
        {"sample": 1, "input": "level_2.reading", "value": 3},
        {"sample": 1, "input": "level_2.forced", "value": 1},
        {"sample": 2, "input": "level_2.reading", "value": 0},
        {"sample": 2, "input": "level_2.forced", "value": 0},
        {"sample": 2, "drift": "level_1", "rate": 0.5},
        {"sample": 2, "input": "operator.remote", "value": 0},
        {"sample": 2, "noise": True},
    ]
    assert [each["sample"] for each in happened] == [2]


def test_what_a_hand_sets_is_seen_until_a_sample_has_it_or_it_was_refused(run):
    found = run("""
        const seen = [];
        const told = () => seen.push(rig.value("level_1.setpoint"));
        rig.take(flat([0, 0, { "level_1.setpoint": 4 }]));
        rig.touch("level_1.setpoint", 5);
        told();
        rig.take(flat([1, 1, { "level_1.setpoint": 4 }]));
        told();
        rig.taken(sent[0], 2);
        rig.take(flat([2, 2, { "level_1.setpoint": 4 }]));
        told();
        // Another page was later in the same sample.
        rig.take(flat([3, 3, { "level_1.setpoint": 6 }]));
        told();
        rig.touch("level_1.setpoint", 99);
        rig.refused(sent[1]);
        told();
        answer([seen, sent]);
    """)
    assert found == [
        [5, 5, 5, 6, 6],
        [
            {"input": "level_1.setpoint", "value": 5},
            {"input": "level_1.setpoint", "value": 99},
        ],
    ]


def test_in_the_past_everything_is_as_it_was_while_the_plant_goes_on(run):
    found = run("""
        const local = { "operator.remote": 0 };
        rig.take(flat([0, 0], [1, 1, { level_1: 7 }], [2, 2, { level_1: 8, ...local }]));
        const seen = [rig.value("level_1")];
        rig.goTo(2);
        rig.take(flat([3, 3, { level_1: 9, ...local }]));
        seen.push(rig.value("level_1"), rig.value("operator.remote"), rig.isPast, rig.isRemote);
        rig.goTo(99);
        rig.take(flat([4, 4, { level_1: 10 }]));
        seen.push(rig.value("level_1"), rig.isPast);
        answer(seen);
    """)
    assert found == [8, 7, 1, True, False, 10, False]
