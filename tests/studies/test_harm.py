"""Running dry, overfilling and every trip make a controller unsafe, with first time and count."""

import re

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.studies.result import Standing

# With its least signal the pump takes 40 l/min out of a drum that 100 l/min run into.
DRUM = """
name = "drum"
sampling_period = "2 s"
controlled = ["level"]
[reservoirs.basin]
[tanks.drum]
area = "0.5 m^2"
height = "1 m"
{weir}
[pumps.transfer]
source = "drum"
destination = "basin"
gain = "20 l/(min V)"
range = ["2 V", "10 V"]
{trip}
[flows.feed]
destination = "drum"
range = ["0 l/min", "400 l/min"]
nominal = "100 l/min"
step = "10 l/min"
[flows.demand]
source = "drum"
range = ["0 l/min", "400 l/min"]
nominal = "0 l/min"
[sensors.level]
tank = "drum"
range = ["0 m", "1 m"]
[operating_point]
level = "0.5 m"
"""
TRIP = 'trip_below = {{ drum = "{}" }}\nhysteresis = "1 cm"'


@pytest.fixture
def candidate(tmp_path):
    """Return a function that studies SIMC's PI in a drum whose feed and demand [l/min] step."""

    def make(feed=None, demand=None, minutes=60, **lines):
        plant = plant_of(tmp_path, DRUM.format(**{"trip": "", "weir": ""} | lines))
        events = [
            cl.step(name, to=f"{flow} l/min", at="20 s")
            for name, flow in (("feed", feed), ("demand", demand))
            if flow is not None
        ]
        controllers = [cl.design.simc(plant)]
        return cl.study(plant, controllers, events, duration=f"{minutes} min").best

    return make


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("given", "event", "reason"),
    [
        ({"feed": 10.0}, "transfer.runs_dry", "transfer runs dry at"),
        ({"feed": 100.0, "demand": 90.0}, "demand.runs_dry", "demand runs dry at"),
        (
            {"feed": 10.0, "minutes": 50, "trip": TRIP.format("10 cm")},
            "transfer.trips_drum_below",
            "transfer trips at",
        ),
        ({"feed": 400.0}, None, "drum.level rises above its rim at"),
        ({"feed": 400.0, "weir": 'weir = "20 cm"'}, None, "drum.level rises above its rim at"),
    ],
)
def test_whatever_harms_the_plant_is_unsafe_counted_and_dated(candidate, given, event, reason):
    found = candidate(**given)
    assert found.standing is Standing.UNSAFE
    assert found.reason.startswith("Unsafe: ") and reason in found.reason
    assert any(words.startswith(reason.removesuffix(" at")) for words in found.warnings)
    if event is None:
        return
    run = found.run
    count = run.values[f"{event}.count"]
    assert count[-1] > 1
    assert f"{count[-1]:.0f} times in all" in found.reason
    number, unit = re.search(r"at ([\d.]+) (s|min)", found.reason).groups()
    first = run.time[int(np.argmax(count > 0))]
    assert float(number) * {"s": 1, "min": 60}[unit] == pytest.approx(first, abs=4.0)


def test_a_drum_that_is_left_alone_is_not_unsafe(candidate):
    found = candidate()
    assert found.standing is Standing.ROBUST
    assert not [words for words in found.warnings if "drum" in words]
