"""A study of an averaging level with a band: who stays in it, and what is said of who does not."""

import re

import numpy as np
import pytest
from refusals import refused
from written_plants import plant_of

import clepsydra as cl
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.result import Standing

DRUM = """
name = "drum"
title = "Surge drum"
sampling_period = "20 s"
controlled = ["level"]
averaging = ["level"]
manipulated = ["outflow"]
tanks.drum = { shape = "horizontal cylinder", diameter = "2 m", length = "6 m" }
flows.feed = { destination = "drum", range = ["20 m^3/h", "60 m^3/h"], nominal = "40 m^3/h", \
step = ["10 m^3/h", "-10 m^3/h"] }
flows.outflow = { source = "drum", range = ["20 m^3/h", "60 m^3/h"], nominal = "40 m^3/h" }
sensors.level = { tank = "drum", span = ["0 m", "2 m"], range = ["0 %", "100 %"], \
band = ["30 %", "70 %"] }
operating_point.level = "50 %"
"""
#: The outflow of a drum that cannot follow its feed.
NARROW = 'range = ["35 m^3/h", "60 m^3/h"], nominal = "40 m^3/h" }'


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    return plant_of(tmp_path_factory.mktemp("drum"), DRUM)


@pytest.fixture(scope="module")
def study(plant):
    return cl.study(
        plant,
        [
            cl.design.arrest_time(plant, arrest_time="80 min").named("calm"),
            cl.design.arrest_time(plant, arrest_time="100 min").named("calmer"),
            cl.design.arrest_time(plant).named("banded"),
            cl.design.simc(plant).named("tight"),
        ],
    )


def test_who_leaves_the_band_stands_behind_who_keeps_it_however_smooth_its_flow(study):
    names = [each.controller.title for each in study.ranking]
    assert names == ["banded", "tight", "calmer", "calm"]
    standings = [each.standing for each in study.ranking]
    assert standings == [Standing.ROBUST] * 2 + [Standing.OUTSIDE] * 2
    change = {e.controller.title: e.scores["outflow_rate[level]"] for e in study.ranking}
    assert change["calmer"] < change["calm"] < change["banded"] < change["tight"]


def test_the_outflow_decides_among_those_that_keep_it(study):
    assert [*study.best.criteria] == ["outflow change"]
    assert study.verdict.startswith("Use banded on Surge drum: the best, with an outflow change ")


def test_how_long_and_how_deep_a_level_is_outside_is_told(study):
    calm, calmer = study["calm"], study["calmer"]
    said = re.match(
        r"Leaves its band: level is outside for ([\d.]+) min, by at most ([\d.]+) % above and "
        r"([\d.]+) % below \(max\|S\| ",
        calm.reason,
    )
    time, above, below = map(float, said.groups())
    level = 100.0 * calm.run.true_measurement("level")  # seen at the samples
    assert above == pytest.approx(level.max() - 70.0, abs=1e-3)
    assert below == pytest.approx(30.0 - level.min(), abs=1e-3)
    outside = 20.0 * ((level > 70.0) | (level < 30.0)).sum()
    assert 60.0 * time == pytest.approx(outside, abs=80.0)
    assert calmer.reason.endswith("Behind tight, which keeps the band.")


def test_of_controllers_that_all_leave_it_none_is_recommended_and_the_shortest_is_the_least_bad(
    plant, study
):
    worse = cl.study(plant, [study["calmer"].controller, study["calm"].controller])
    assert recommend(worse.ranking) is None
    assert worse.best.controller.name == "calm"
    assert worse.verdict.startswith(
        "No controller of this study can be recommended for Surge drum; the least bad is calm: "
        "leaves its band: "
    )
    assert [*worse.best.criteria] == ["Time outside the band"]


@pytest.mark.thorough
def test_a_tuning_uses_the_band_and_keeps_it(plant):
    """The band is a limit of the tuning; less damping than 1 then changes the outflow less."""
    start = cl.design.arrest_time(plant)
    tuned = cl.tune(start, plant, "outflow_rate", {"damping": 0.0})
    run = cl.simulate(plant, tuned)
    assert run.scores["above_band[level]"] <= 1e-5 and run.scores["below_band[level]"] <= 1e-5
    before = cl.simulate(plant, start).scores["outflow_rate[level]"]
    assert run.scores["outflow_rate[level]"] < 0.8 * before
    kept = [each for each in tuned.tuning.binding if each.endswith("under load")]
    assert kept and set(kept) <= {"level at most 70 % under load", "level at least 30 % under load"}


@pytest.mark.thorough
def test_a_tuning_that_cannot_keep_the_band_leaves_nothing_behind(tmp_path):
    """An outflow of 35 m³/h at the least cannot follow a feed of 30 m³/h."""
    path = tmp_path / "drum.toml"
    text = DRUM.replace('range = ["20 m^3/h", "60 m^3/h"], nominal = "40 m^3/h" }', NARROW)
    path.write_text(text.replace('"-10 m^3/h"', '"-20 m^3/h"'), encoding="utf-8")
    name = "PI, arrest time, tuned"
    study = cl.study(cl.load(path), only=name, folder=tmp_path)
    assert "level at least 30 % under load" in dict(study.not_applicable)[name]
    assert not list(tmp_path.glob("*.json"))


def test_a_setpoint_of_a_study_file_outside_of_the_band_is_refused(tmp_path):
    (tmp_path / "drum.toml").write_text(DRUM, encoding="utf-8")
    path = tmp_path / "study.toml"
    steps = '[[scenario.setpoint]]\nsignal = "level"\nat = "1 h"\nto = "75 %"\n'
    path.write_text(f'process = "drum.toml"\n[scenario]\nduration = "9 h"\n{steps}')
    with refused(
        place="line 7, scenario.setpoint.1.to",
        value="75 %",
        expected="a setpoint within the band of level, 30 to 70 %",
        remedy="move it, or widen the band",
    ):
        cl.study(path)


@pytest.mark.parametrize(
    "edits",
    [
        {'range = ["0 %", "100 %"], ': 'range = ["0 %", "100 %"], lag = "60 s", '},
        {
            'span = ["0 m", "2 m"], range = ["0 %", "100 %"]':
                'quantity = "volume", lag = "20 s", range = ["0 m^3", "18.8 m^3"]',
            'level = "50 %"': 'level = "9.4 m^3"',
        },
        {
            'flows.outflow = { source = "drum", range = ["20 m^3/h", "60 m^3/h"]':
                'reservoirs.next = {}\nvalves.outflow = { source = "drum", destination = "next", '
                'kv = "100 m^3/h", elevation = "6 m", range = ["0 %", "100 %"]',
            ', nominal = "40 m^3/h" }\nsensors': ' }\nsensors',
        },
    ],
    ids=["level with a lag", "volume", "valve"],
)  # fmt: skip
def test_the_band_is_used_and_kept_by_whatever_measures_and_moves(edits, tmp_path):
    text = DRUM
    for old, new in edits.items():
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "drum.toml").write_text(text, encoding="utf-8")
    plant = cl.load(tmp_path / "drum.toml")
    run = cl.simulate(plant, cl.design.arrest_time(plant))
    assert run.scores["time_outside_band[level]"] == 0.0
    signal = plant.process.signal("level")
    used = np.abs(signal.to_percent(run.true_measurement("level")) - 50.0).max()
    assert 0.85 * 20.0 < used < 20.0
