"""The alarm block beside a controller: exported with it, and equal to the engine in every bit."""

from pathlib import Path

import numpy as np
import pytest
from tools import need
from written_plants import plant_of

import clepsydra as cl
from clepsydra.deploy.exported_alarms import alarm_items, exportable_alarms
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.deploy.proof.text.interpreter import StructuredText
from clepsydra.deploy.proof.text.scl import standard_text

ONE_TANK = (Path(__file__).parents[1] / "one-tank.toml").read_text(encoding="utf-8")
TANK = (
    ONE_TANK.replace('nominal = "1.5 V"', 'nominal = "3 V"\ntag = "P101"')
    + """
tag = "LIC101"
[alarms.level_1]
high_high = { limit = "18 cm", interlock = { pump_1 = "0 V" }, acknowledged = true }
high = "80 %"
low = { limit = "10 %", on_delay = "3 s" }
low_low = "5 %"
deviation = { limit = "2 cm", on_delay = "10 s" }
rate = { limit = "2 mm/s", filter_time = "3 s" }
flatline = { time = "10 s", still = "1 cm" }
deadband = "2 mm"
off_delay = "2 s"
"""
)


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    return plant_of(tmp_path_factory.mktemp("alarmed"), TANK)


@pytest.mark.parametrize("to", ["st", "c", "wasm", "signals"])
def test_an_export_has_the_alarms_beside_the_controller(plant, to, tmp_path):
    files = [path.name for path in cl.export(cl.design.simc(plant), plant, tmp_path, to=to).files]
    beside = [name for name in files if name.startswith("one_tank_alarms")]
    assert beside and len(files) >= 2 * len(beside)


def test_its_ports_have_the_tags_and_units_of_the_file(plant):
    program = exportable_alarms(plant.point).program
    ports = {s.name: s for s in (*program.inputs, *program.outputs, *program.parameters)}
    assert {"LIC101.pv", "P101.command", "P101.interlock", "LIC101.high.active"} <= set(ports)
    assert (ports["LIC101.high.limit"].initial, ports["LIC101.high.limit"].unit) == (16.0, "cm")
    assert "priority medium" in ports["LIC101.high.active"].description


def test_a_block_that_nobody_wires_watches_nothing_and_says_so(plant):
    program = exportable_alarms(plant.point).program
    unwired = {s.name: np.array([s.initial]) for s in program.inputs}
    told = dict(
        zip([s.name for s in program.outputs], engine_run(program, unwired)[0], strict=False)
    )
    assert told["LIC101.watched"] == 0.0 and told["LIC101.low.active"] == 0.0


def test_the_controller_has_an_input_for_the_interlock(plant, tmp_path):
    written = cl.export(cl.design.simc(plant), plant, tmp_path, to="st")
    text = (tmp_path / "one_tank_pi_simc.st").read_text(encoding="utf-8")
    assert "P101_interlock : BOOL := TRUE;" in text
    assert "P101_interlock_value : LREAL := 0.0;" in text
    # In the test project they stand beside it.
    test = (tmp_path / "one_tank_pi_simc_test.st").read_text(encoding="utf-8")
    assert "P101_interlock := alarms.P101_interlock" in test
    assert any("P101_interlock to the controller" in step for step in written.then)


@pytest.mark.parametrize("dialect", ["codesys", "matiec", "scl"])
def test_structured_text_equals_the_engine_in_every_bit(plant, dialect):
    """Twenty thousand scans of a plant in which everything goes wrong, states included."""
    need("tree_sitter_iec61131_3_st")
    program = exportable_alarms(plant.point).program
    scans = random_scans(program, 3_000, 5, 1.0)
    expected, found = (
        engine_run(program, scans),
        InterpretedText(program, dialect=dialect).run(scans),
    )
    assert np.array_equal(np.asarray(found).view(np.int64), expected.view(np.int64))
    # Each alarm came and returned.
    outputs = expected[:, : len(program.outputs)]
    for signal, column in zip(program.outputs, outputs.T, strict=True):
        assert len(np.unique(column)) > 1, signal.name


@pytest.mark.parametrize("dialect", ["codesys", "matiec", "scl"])
def test_the_test_project_does_what_was_simulated(dialect, tmp_path):
    """The inflow rises until alarms come; they hold the pump scan by scan as in the loop."""
    need("tree_sitter_iec61131_3_st")
    plant = cl.load(Path(__file__).parents[1] / "alarmed-tank.toml")
    controller = cl.design.simc(plant)
    cl.export(controller, plant, tmp_path, to="st", dialect=dialect)
    (file,) = tmp_path.glob("*_test.s*")
    text = file.read_text(encoding="utf-8-sig")
    text = standard_text(text) if dialect == "scl" else text
    changes = [cl.disturbance("inflow_1", to="8 cm^3/s", at="40 s")]
    run = cl.simulate(plant, controller, changes, duration="200 s")
    project = StructuredText(text).instance("alarmed_tank_pi_simc_test")
    seen = (
        "pump_1_out", "pump_1_interlock", "level_1_high_high_active", "level_1_flatline_active",
    )  # fmt: skip
    found = []
    for scan in range(len(run.time)):
        if scan == 40:
            project.state["inflow_1"] = 8.0
        project.run()
        found.append([float(project.state[name]) for name in seen])
    names = ("pump_1", "pump_1.interlock", "level_1.high_high.active", "level_1.flatline.active")
    for column, name in zip(np.array(found).T, names, strict=True):
        # The engine fuses multiplications into additions of the process, the text cannot.
        assert column == pytest.approx(run.values[name], abs=1e-9), name
    assert 0 < np.sum(run.values["pump_1.interlock"]) < len(run.time)


@pytest.mark.thorough
def test_the_proof_holds_in_every_target(plant):
    proof = cl.verify(cl.design.simc(plant), plant)
    assert proof.holds
    alarms = [row for row in proof.rows if row.subject == "Alarms of one-tank"]
    assert {row.verdict for row in alarms if row.precision == "double"} == {"equal"}
    assert len(alarms) == 9


def test_a_process_without_alarms_has_no_item():
    assert alarm_items(cl.load("quadruple-tank").point) == []
