"""A target of an export is one file: here a list of signals for who wires the cabinet."""

import csv
import io

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.deploy.target import TARGETS, ExportedFiles, Target

_SEPARATORS = {"comma": ",", "semicolon": ";"}


def signal_list(delivery, options):
    """Return a table of the ports of a controller: tag, direction, unit and range."""
    program, text = delivery.ready.program, io.StringIO()
    writer = csv.writer(text, delimiter=_SEPARATORS[options["separator"]])
    for direction, signals in (("in", program.inputs), ("out", program.outputs)):
        for each in signals:
            if each.part in ("pv", "out") and not each.record:
                writer.writerow([each.identifier, direction, each.unit, each.low, each.high])
    return ExportedFiles(
        {f"{program.name}_signals.csv": text.getvalue().encode()},
        delivery.ready.facts | options,
        "give it to who wires the cabinet.",
    )


@pytest.fixture
def own(monkeypatch):
    """The target as its file would add it; forgotten after the test."""
    list(TARGETS)
    monkeypatch.setattr(TARGETS, "_things", dict(TARGETS))
    target = Target(9, "a list of signals", signal_list, {"separator": tuple(_SEPARATORS)})
    TARGETS.add("signals", target)


def test_a_target_that_adds_itself_is_exported_like_every_other_one(own, tmp_path):
    plant = cl.load("quadruple-tank")
    found = cl.export(cl.design.simc(plant), plant, tmp_path, to="signals")
    (path,) = found.files
    assert path.name == "quadruple_tank_pi_simc_signals.csv"
    rows = list(csv.reader(path.read_text().splitlines()))
    assert ["level_1_pv", "in", "V", "0.0", "10.0"] in rows
    assert ["pump_2_out", "out", "V", "0.0", "10.0"] in rows and len(rows) == 4
    assert found.facts["separator"] == "comma" and "cabinet" in found.lines[-1]


def test_it_takes_part_in_the_refusals(own, tmp_path):
    plant = cl.load("quadruple-tank")
    controller = cl.design.simc(plant)
    with refused(place="export, dialect", value="scl", expected='to="st"', remedy="leave it out"):
        cl.export(controller, plant, tmp_path, to="signals", dialect="scl")
    with refused(
        place="export, to", value="signal", expected="tuning, signals", remedy="'signals'"
    ):
        cl.export(controller, plant, tmp_path, to="signal")
    with refused(place="export, controller", value="none", expected="a controller"):
        cl.export(None, plant, tmp_path, to="signals")
    with refused(place="proof, to", value="signals", expected="c, st, fmu", remedy="name"):
        cl.verify(controller, plant, to="signals")
    assert not list(tmp_path.iterdir())
