"""A target of an export is one file: here a sheet of settings for who commissions the loop."""

import csv
import io

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.deploy.target import TARGETS, ExportedFiles, Target

_SEPARATORS = {"comma": ",", "semicolon": ";"}


def settings_sheet(delivery, options):
    """Return a table of the parameters of a controller: name, value and unit."""
    program, text = delivery.ready.program, io.StringIO()
    writer = csv.writer(text, delimiter=_SEPARATORS[options["separator"]])
    for each in program.parameters:
        writer.writerow([each.identifier, each.initial, each.unit])
    return ExportedFiles(
        {f"{program.name}_settings.csv": text.getvalue().encode()},
        delivery.ready.facts | options,
        "give it to who commissions the loop.",
    )


@pytest.fixture
def own(monkeypatch):
    """The target as its file would add it; forgotten after the test."""
    list(TARGETS)
    monkeypatch.setattr(TARGETS, "_things", dict(TARGETS))
    target = Target(9, "a sheet of settings", settings_sheet, {"separator": tuple(_SEPARATORS)})
    TARGETS.add("settings", target)


def test_a_target_that_adds_itself_is_exported_like_every_other_one(own, tmp_path):
    plant = cl.load("quadruple-tank")
    found = cl.export(cl.design.simc(plant), plant, tmp_path, to="settings")
    (path,) = found.files
    assert path.name == "quadruple_tank_pi_simc_settings.csv"
    rows = list(csv.reader(path.read_text().splitlines()))
    assert ["level_1_proportional_gain", "3.0", "V/V"] in rows
    assert ["pump_2_high_limit", "10.0", "V"] in rows
    assert found.facts["separator"] == "comma" and "commissions" in repr(found).splitlines()[-1]


def test_it_takes_part_in_the_refusals(own, tmp_path):
    plant = cl.load("quadruple-tank")
    controller = cl.design.simc(plant)
    with refused(place="export, dialect", value="scl", expected='to="st"', remedy="leave it out"):
        cl.export(controller, plant, tmp_path, to="settings", dialect="scl")
    with refused(place="export, to", value="setting", expected=", settings", remedy="'settings'"):
        cl.export(controller, plant, tmp_path, to="setting")
    with refused(place="export, controller", value="none", expected="a controller"):
        cl.export(None, plant, tmp_path, to="settings")
    proved = ", ".join(name for name, target in TARGETS.items() if target.runs is not None)
    with refused(place="proof, to", value="settings", expected=proved, remedy="name"):
        cl.verify(controller, plant, to="settings")
    assert not list(tmp_path.iterdir())
