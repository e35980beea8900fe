"""Ramps and recorded profiles in the scenario of a study file, and designs beside one's own."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.studies.file.reader import read_study
from clepsydra.studies.study import controller_names

BEGIN = """
process = "equalisation-tank"
[controllers.simc]
design = "simc"
[scenario]
duration = "10 h"
noise = false
[[scenario.load]]
signal = "inflow"
at = "1 h"
"""
PROFILE = "time [h],inflow [m^3/h]\n0,650\n1,820\n2,{last}\n"


@pytest.fixture
def study(tmp_path):
    def of(rest, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
        path = tmp_path / "study.toml"
        path.write_text(BEGIN + rest, encoding="utf-8")
        return path

    return of


def inflow(request):
    """Return the inflow [m³/h] at the start of each hour, and the one segment."""
    place = [signal.name for signal in request.process.disturbances].index("inflow")
    per_hour = round(3600.0 / request.scenario.sampling_period)
    (segment,) = request.scenario.segments
    return 3600.0 * request.scenario.disturbances[::per_hour, place], segment


def test_a_ramp_rises_evenly_and_stays(study):
    found, segment = inflow(read_study(study('by = "120 m^3/h"\nover = "4 h"')))
    assert found - found[0] == pytest.approx([0, 0, 30, 60, 90, 120, 120, 120, 120, 120], abs=1e-9)
    assert (segment.start, segment.stop, segment.over) == (3600.0, 36_000.0, 14_400.0)
    assert 3600.0 * segment.size == pytest.approx(120.0)


def test_a_recorded_profile_is_held_row_by_row(study):
    path = study('profile = "inflow.csv"', inflow=PROFILE.format(last=700))
    found, segment = inflow(read_study(path))
    assert found[1:] == pytest.approx([650, 820, *[700] * 7])
    assert 3600.0 * segment.size == pytest.approx(650 - found[0])
    assert segment.over == 7200.0


def test_a_pulse_lasts_and_goes_back(study):
    found, segment = inflow(read_study(study('by = "120 m^3/h"\nlasts = "3 h"')))
    assert found - found[0] == pytest.approx([0, 120, 120, 120, 0, 0, 0, 0, 0, 0], abs=1e-9)
    assert (segment.start, segment.stop, segment.over) == (3600.0, 36_000.0, 10_800.0)
    assert 3600.0 * segment.size == pytest.approx(120.0)


def test_a_controller_is_scored_along_a_ramp(study):
    """A ramp lets a level deviate less than a step of the same size does."""
    slow, step = (cl.study(study(f'by = "120 m^3/h"\n{more}')) for more in ('over = "4 h"', ""))
    deviations = [each.best.scores["peak_deviation[level]"] for each in (slow, step)]
    assert 0.0 < deviations[0] < 0.8 * deviations[1]
    assert np.isfinite(slow.best.scores["iae[level]"])


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        ('by = "120 m^3/h"\nover = "10 h"', "over: .*expected an end before the next step"),
        ('by = "120 m^3/h"\nover = "0 s"', "over: got '0 s', expected a time above 0"),
        ('by = "1 m^3/h"\nprofile = "inflow.csv"', "by: got 'both by and profile'"),
        ('over = "1 h"\nprofile = "inflow.csv"', "over: .*no such key beside a profile"),
        ('lasts = "1 h"\nprofile = "inflow.csv"', "lasts: .*no such key beside a profile"),
        ('by = "120 m^3/h"\nover = "1 h"\nlasts = "1 h"', "over: .*no such key beside a pulse"),
        ('by = "120 m^3/h"\nlasts = "10 h"', "lasts: .*expected an end before the next step"),
        ('by = "120 m^3/h"\nlasts = "1 s"', "lasts: got '1 s', expected a time of at least"),
        ('profile = "none.csv"', "none.csv: "),
        (
            'profile = "level.csv"',
            "level.csv, line 1, column 2: got 'level', expected the column of the signal",
        ),
        ('profile = "late.csv"', "profile: .*expected an end before the next step"),
        ('profile = "wild.csv"', "wild.csv, line 3, column 'inflow': got"),
    ],
)
def test_a_course_that_cannot_be_is_refused_in_its_place(study, rest, words):
    files = {
        "inflow": PROFILE.format(last=700), "late": PROFILE.replace("2,", "20,").format(last=700),
        "level": PROFILE.replace("inflow [m^3/h]", "level [m]").format(last=1),
        "wild": PROFILE.replace("820", "1e6").format(last=700),
    }  # fmt: skip
    with pytest.raises(cl.InputError, match=words):
        read_study(study(rest, **files))


def test_a_setpoint_has_no_pulse(study):
    path = study('by = "5 %"\nlasts = "3 h"')
    text = path.read_text(encoding="utf-8").replace("scenario.load", "scenario.setpoint")
    path.write_text(text.replace('"inflow"', '"level"'), encoding="utf-8")
    with pytest.raises(
        cl.InputError, match="lasts: got '3 h', expected a load; write the way back"
    ):
        read_study(path)


def test_designs_stand_beside_settings_of_ones_own(study):
    path = study('by = "120 m^3/h"')
    text = path.read_text(encoding="utf-8").replace("simc]", '"PI, SIMC"]')
    path.write_text(f'designs = "all"\n{text}', encoding="utf-8")
    names = controller_names(read_study(path))
    assert names[0] == "PI, SIMC"
    assert names.count("PI, SIMC") == 1
    assert "PI, arrest time, tuned" in names
