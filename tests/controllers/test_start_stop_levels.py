"""Start and stop levels: against a state machine written another way, and the cycle by formula."""

import numpy as np
import pytest
from refusals import refused
from written_plants import plant_of

import clepsydra as cl
from clepsydra import InputError, NotApplicable, Signal
from clepsydra.controllers.start_stop_levels import check_levels, start_stop_law

ON, OFF = 8.0, 1.0


def station(driven, pumps, sign=1.0, **values):
    """Pumps that start at 2, 3, 4, … m and stop at 1, 2, 3, … m, or mirrored at zero."""
    law = start_stop_law(
        [Signal("level", "m", low=0.0, high=9.0)],
        [Signal(f"pump_{i}", "V", low=0.0, high=10.0) for i in range(1, pumps + 1)],
    )
    given = {parameter.name: parameter.initial for parameter in law.parameters}
    for j in range(1, pumps + 1):
        given |= {f"stage.{j}.start_level": sign * (1.0 + j), f"stage.{j}.stop_level": sign * j}
        given |= {f"pump_{j}.running_value": ON, f"pump_{j}.stopped_value": OFF}
    assert not set(values) - set(given)
    state = {signal.name: signal.initial for signal in law.state}
    state |= {f"pump_{i}.last_output": OFF for i in range(1, pumps + 1)}
    return driven(law, given | values, state)


def scan(law, level, inputs=None):
    """One sample; return which pumps run."""
    pumps = sum(s.part == "out" for s in law.law.outputs)
    given = {"level.pv": level, "level.good": 1.0, "time_step": 1.0}
    for i in range(1, pumps + 1):
        given |= {f"pump_{i}.mode": 1.0, f"pump_{i}.manual": OFF, f"pump_{i}.tracking": OFF}
    law.outputs = law.scan(**(given | (inputs or {})))
    return [i for i in range(1, pumps + 1) if law.outputs[f"pump_{i}.out"] != OFF]


class Foreman:
    """The same rules with lists and sorting, for the random test."""

    def __init__(self, pumps, alternation, rest):
        self.pumps, self.alternation, self.rest = pumps, alternation, rest
        self.stages, self.duty = set(), 1
        self.output = dict.fromkeys(range(1, pumps + 1), OFF)
        self.idle = dict.fromkeys(range(1, pumps + 1), 1e9)

    def decide(self, level, sound, modes, manual, service):
        everyone = range(1, self.pumps + 1)
        before = len(self.stages)
        usable = sound and np.isfinite(level)
        if usable:
            self.stages |= {j for j in everyone if level >= 1 + j}
            self.stages -= {j for j in everyone if level <= j}
        running = [i for i in everyone if self.output[i] != OFF]
        crew = [
            i
            for i in everyone
            if modes[i] == 1 and service[i] and (i in running or self.idle[i] >= self.rest)
        ]
        crew.sort(key=lambda i: (i not in running, (i - self.duty) % self.pumps))
        chosen = crew[: len(self.stages)]
        if before and not self.stages and self.alternation:
            leaders = [i for i in crew if i in running] or [self.duty]
            self.duty = leaders[0] % self.pumps + 1
        for i in everyone:
            if modes[i] == 0:
                self.output[i] = manual[i]
            elif modes[i] == 1 and usable:
                self.output[i] = ON if i in chosen else OFF
            self.idle[i] = 0.0 if self.output[i] != OFF else self.idle[i] + 1.0
        return dict(self.output)


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("pumps", "alternation", "rest"), [(1, 1, 0), (2, 1, 0), (3, 0, 4), (4, 1, 3)]
)
def test_against_a_state_machine_written_another_way(driven, pumps, alternation, rest):
    random = np.random.default_rng(pumps)
    law = station(driven, pumps, alternation=float(alternation), shortest_rest=float(rest))
    foreman = Foreman(pumps, alternation, rest)
    level, numbers = 1.5, range(1, pumps + 1)
    modes, service = dict.fromkeys(numbers, 1), dict.fromkeys(numbers, 1)
    manual = dict.fromkeys(numbers, OFF)
    patterns, duties = set(), set()
    for _ in range(3000):
        level = float(np.clip(level + random.normal(0.0, 0.6), 0.0, pumps + 2.0))
        sound, number = random.random() > 0.05, random.random() > 0.02
        if random.random() < 0.05:
            i = int(random.integers(1, pumps + 1))
            modes[i], manual[i] = int(random.choice([0, 1, 1])), random.choice([OFF, 5.0, ON])
            service[i] = int(random.random() < 0.8)
        shown = level if number else np.nan
        inputs = {f"pump_{i}.mode": float(modes[i]) for i in numbers}
        inputs |= {f"pump_{i}.manual": manual[i] for i in numbers}
        law.values |= {f"pump_{i}.in_service": float(service[i]) for i in numbers}
        scan(law, shown, {"level.good": float(sound), **inputs})
        found = {i: law.outputs[f"pump_{i}.out"] for i in numbers}
        assert found == foreman.decide(shown, sound, modes, manual, service)
        assert law.state["duty"] == foreman.duty
        patterns.add(tuple(found.values()))
        duties.add(foreman.duty)
    assert len(patterns) >= 2**pumps
    assert duties == (set(numbers) if alternation else {1})


def test_each_stage_has_its_hysteresis(driven):
    law = station(driven, 2)
    rising = [scan(law, level) for level in (1.9, 2.0, 2.9, 3.0, 4.0)]
    assert rising == [[], [1], [1], [1, 2], [1, 2]]
    falling = [scan(law, level) for level in (2.1, 2.0, 1.1, 1.0, 1.9)]
    assert falling == [[1, 2], [1], [1], [], []]
    assert scan(law, 2.0) == [2]  # the other one's turn


def test_a_filling_pump_starts_below(driven):
    law = station(driven, 2, sign=-1.0)
    levels = (-1.9, -2.0, -3.0, -2.1, -2.0, -1.1, -1.0, -2.0)
    assert [scan(law, level) for level in levels] == [
        [], [1], [1, 2], [1, 2], [1], [1], [], [2]
    ]  # fmt: skip


def test_without_alternation_the_duty_pump_stays(driven):
    law = station(driven, 3, alternation=0.0)
    assert [scan(law, level) for level in (2.0, 1.0, 2.0, 1.0, 2.0)] == [[1], [], [1], [], [1]]


def test_alternation_passes_over_a_pump_that_an_operator_has_and_stays_even(driven):
    law = station(driven, 3)
    hand = {"pump_1.mode": 0.0}
    starts = [scan(law, level, hand) for level in (2.0, 1.0) * 6]
    assert [run for run in starts if run] == [[2], [3]] * 3


@pytest.mark.parametrize("taken", [{"pump_1.mode": 0.0}, {"pump_1.mode": 2.0}])
def test_standby_takes_the_place_of_a_pump_that_an_operator_stops(driven, taken):
    law = station(driven, 2)
    assert scan(law, 2.5) == [1]
    assert scan(law, 2.5, taken) == [2]
    # When it comes back, what runs goes on.
    assert scan(law, 2.5) == [2]
    # By hand it may run beside the other one, and is not counted.
    assert scan(law, 2.5, {"pump_1.mode": 0.0, "pump_1.manual": 5.0}) == [1, 2]
    assert law.outputs["pump_1.out"] == 5.0
    # Back in automatic one of them is one too many: the one whose turn it is goes on.
    assert scan(law, 2.5) == [1]
    assert law.outputs["pump_1.out"] == ON


def test_standby_takes_the_place_of_a_pump_out_of_service(driven):
    law = station(driven, 2)
    assert scan(law, 2.5) == [1]
    law.values["pump_1.in_service"] = 0.0
    assert scan(law, 2.5) == [2]
    assert scan(law, 3.5) == [2]
    law.values["pump_1.in_service"] = 1.0
    assert scan(law, 3.5) == [1, 2]


def test_a_pump_rests_before_it_starts_again(driven):
    law = station(driven, 1, shortest_rest=5.0)
    assert scan(law, 2.0) == [1]
    assert scan(law, 1.0) == []  # the first of five seconds
    assert [scan(law, 2.5) for _ in range(6)] == [[], [], [], [], [1], [1]]


def test_a_failed_sensor_leaves_the_pumps_and_the_operator_can_stop_them(driven):
    law = station(driven, 2)
    assert scan(law, 2.5) == [1]
    for level, sound in ((0.5, 0.0), (np.nan, 1.0), (9.0, 0.0)):
        assert scan(law, level, {"level.good": sound}) == [1]
        assert int(law.outputs["pump_1.status"]) & (16 if not sound else 32)
    assert scan(law, 0.5, {"level.good": 0.0, "pump_1.mode": 0.0}) == []
    assert scan(law, 2.5) == [1]
    assert scan(law, 0.5, {"time_step": 0.0}) == [1]
    assert int(law.outputs["pump_1.status"]) & 64


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"stage.1.start_level": 0.4}, None),
        (
            {"stage.2.start_level": 0.9, "stage.2.stop_level": 0.6},
            "stage.2.start_level: got '0.9 m', expected a level beyond stage.1.start_level",
        ),
        (
            {"stage.2.stop_level": 2.5},
            "stage.2.start_level: got '2 m', expected a level above stage.2.stop_level, 2.5 m",
        ),
        (
            {"stage.1.stop_level": 1.0},
            "stage.1.start_level: got '1 m', expected a level above stage.1.stop_level, 1 m;",
        ),
        (
            {"stage.1.stop_level": 1.2},
            "stage.2.start_level: got '2 m', expected a level below stage.2.stop_level, 1.5 m",
        ),
    ],
)
def test_levels_follow_each_other(changed, words):
    values = {"stage.1.start_level": 1.0, "stage.1.stop_level": 0.5}
    values |= {"stage.2.start_level": 2.0, "stage.2.stop_level": 1.5}
    if words is None:  # the first stage would fill, the second empty
        words = "stage.2.start_level: got '2 m', expected a level below stage.2.stop_level"
    law = start_stop_law([Signal("level", "m")], ["pump_1", "pump_2"])
    check_levels(law, values, "well")
    with pytest.raises(InputError, match=words):
        check_levels(law, values | changed, "well")


STATION = """
name = "station"
sampling_period = "1 s"
controlled = ["level"]
[reservoirs.works]
[tanks.well]
area = "10 m^2"
height = "5 m"
[flows.inflow]
{way} = "well"
range = ["0 l/s", "100 l/s"]
nominal = "{inflow} l/s"
step = "5 l/s"
[pumps.first]
source = "{source}"
destination = "{destination}"
gain = "40 l/(s V)"
range = ["0 V", "1 V"]
[sensors.level]
tank = "well"
range = ["0 m", "5 m"]
[operating_point]
level = "2 m"
"""
EMPTYING = {"way": "destination", "source": "well", "destination": "works", "inflow": 20}
FILLING = {"way": "source", "source": "works", "destination": "well", "inflow": 20}


@pytest.fixture(scope="module")
def station_plants(tmp_path_factory):
    return {
        way["way"]: plant_of(tmp_path_factory.mktemp(way["way"]), STATION.format(**way))
        for way in (EMPTYING, FILLING)
    }


@pytest.mark.parametrize("way", ["destination", "source"], ids=["emptying", "filling"])
@pytest.mark.parametrize("starts_per_hour", [6.0, 12.0])
def test_the_worst_cycle_has_the_length_of_the_formula(station_plants, way, starts_per_hour):
    """At an inflow of Q/2 a cycle lasts 3600 s / z, and longer at any other."""
    plant = station_plants[way]
    controller = cl.design.start_stop_levels(plant, starts_per_hour=starts_per_hour)
    values = controller.values
    # V = 0.9 Q/z in 10 m² of well, from 20 or 80 % of its height.
    way_up = 0.9 * 40.0 / starts_per_hour / 10.0
    stop = 1.0 if way == "destination" else 4.0
    assert values["stage.1.stop_level"] == pytest.approx(stop, rel=1e-12)
    assert abs(values["stage.1.start_level"] - stop) == pytest.approx(way_up, rel=1e-12)
    cycle = {}
    for inflow in (8e-3, 20e-3, 30e-3):
        load = cl.disturbance("inflow", to=f"{inflow} m^3/s", at=0)
        pump = cl.simulate(plant, controller, [load], duration=8000).values["first"]
        cycle[inflow] = float(np.diff(np.flatnonzero(np.diff(pump) > 0.0)).mean())
    longest_delay = 4  # at each level up to a sample late, and the way back
    assert 3600.0 / starts_per_hour <= cycle[20e-3] <= 3600.0 / starts_per_hour + longest_delay
    for inflow in (8e-3, 30e-3):
        share = inflow / 40e-3
        expected = way_up * 10.0 / 40e-3 / (share * (1 - share))
        assert expected <= cycle[inflow] <= expected + 8
        assert cycle[inflow] > 1.2 * cycle[20e-3]


def test_the_stages_share_the_room(tmp_path):
    second = '[pumps.second]\nsource = "well"\ndestination = "works"\n'
    second += 'gain = "40 l/(s V)"\nrange = ["0 V", "1 V"]\n'
    second += '[sensors.second_flow]\nflow = "second"\nlag = "1 s"\nrange = ["0 l/s", "50 l/s"]\n'
    text = STATION.format(**EMPTYING).replace("[sensors.level]", second + "[sensors.level]")
    plant = plant_of(tmp_path, text + 'second_flow = "10 l/s"\n')
    controller = cl.design.start_stop_levels(plant, starts_per_hour=12.0)
    values = controller.values
    assert check_levels(controller.law, values, "station") is None
    # From 1 to 4 m there is room for 0.3 m of each stage; half of the rest is 1.35 m.
    assert values["stage.1.start_level"] == pytest.approx(1.3, rel=1e-12)
    assert values["stage.2.stop_level"] == pytest.approx(2.35, rel=1e-12)
    assert values["stage.2.start_level"] == pytest.approx(2.65, rel=1e-12)


@pytest.mark.parametrize(
    ("before", "after", "reason"),
    [
        ('height = "5 m"', 'height = "1 m"', "need 6 m³ between start and stop, and well has 6 m³"),
        ('nominal = "20 l/s"', 'nominal = "39.999 l/s"', None),
        ('source = "well"', 'source = "well"\nstart_above = { well = "1 m" }\n'
         'stop_below = { well = "0.5 m" }', "first has level switches of its own"),
        ('controlled = ["level"]', 'controlled = ["level"]\naveraging = ["level"]',
         "the tank of level is to smooth a flow, which pumps would send in bursts"),
    ],
)  # fmt: skip
def test_where_it_applies(tmp_path, before, after, reason):
    text = STATION.format(**EMPTYING)
    assert before in text
    plant = plant_of(
        tmp_path, text.replace(before, after).replace('level = "2 m"', 'level = "0.5 m"')
    )
    if reason is None:
        assert cl.design.start_stop_levels(plant, starts_per_hour=6.0).manipulated == ("first",)
        return
    with pytest.raises(NotApplicable, match=reason):
        cl.design.start_stop_levels(plant, starts_per_hour=6.0)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("quadruple-tank", "it keeps one level, and quadruple-tank has 2"),
        ("three-tanks", "feed is no pump"),
        ("wet-well", "duty has level switches of its own"),
    ],
)
def test_other_processes_are_refused(name, reason):
    with pytest.raises(NotApplicable, match=reason):
        cl.design.start_stop_levels(cl.load(name))


def test_an_inflow_that_the_pumps_do_not_master_is_refused(station_plants):
    """At 40 l/s the one pump only just keeps the level."""
    full = station_plants["destination"].at(disturbances={"inflow": "40 l/s"})
    with pytest.raises(NotApplicable, match="does not go up and down as all pumps stop and start"):
        cl.design.start_stop_levels(full)


@pytest.mark.parametrize(
    ("starts", "expected"),
    [
        (0.0, "a number above 0"),
        (-3.0, "a number above 0"),
        (float("nan"), "a number above 0"),
        ("ten", "a quantity convertible to 1/h"),
    ],
)
def test_a_number_of_starts_that_is_none(station_plants, starts, expected):
    with refused(place="starts_per_hour", expected=expected):
        cl.design.start_stop_levels(station_plants["destination"], starts_per_hour=starts)
