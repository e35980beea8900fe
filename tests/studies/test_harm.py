"""Running dry, overfilling and every trip make a controller unsafe, with first time and count."""

import re

import numpy as np
import pytest

from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.process.reader import load_process
from clepsydra.studies.ranking import Trial, rank
from clepsydra.studies.result import Standing
from clepsydra.studies.warnings.after import run_warnings

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
    """Return a function that ranks SIMC's PI in a drum whose feed and demand [l/min] step."""

    def make(feed, demand=0.0, samples=2000, **lines):
        path = tmp_path / "drum.toml"
        path.write_text(DRUM.format(**{"trip": "", "weir": ""} | lines))
        analysis = analyse(load_process(path))
        model = analysis.model
        controller = design_simc(model, analysis.pairing)
        disturbances = np.tile([feed, demand], (samples, 1)) / 60e3
        disturbances[:10] = model.point.disturbances
        setpoints, noise = np.full((samples, 1), 0.5), np.zeros((samples, 1))
        scenario = Scenario(2.0, setpoints, disturbances, noise, (), seed=1)
        run = Loop(controller, model).run(scenario)
        scores = {"iae[level]": 1.0, "total_variation[transfer]": 1.0}
        return rank([Trial(controller, run, scores, 1.2, run_warnings(run))])[0]

    return make


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("given", "event", "reason"),
    [
        ({"feed": 10.0}, "transfer.runs_dry", "transfer runs dry at"),
        ({"feed": 100.0, "demand": 90.0}, "demand.runs_dry", "demand runs dry at"),
        (
            {"feed": 10.0, "samples": 1500, "trip": TRIP.format("10 cm")},
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
    found = candidate(100.0)
    assert found.standing is Standing.ROBUST
    assert not [words for words in found.warnings if "drum" in words]
