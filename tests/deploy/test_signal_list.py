"""The list of signals: what is wired, in the units and by the tags of the process file."""

import csv

import pytest
from plants import designed, plant, tagged

import clepsydra as cl
from clepsydra.deploy.exportable import exportable


def rows(found):
    (path,) = found.files
    head, *rest = csv.reader(path.read_text(encoding="utf-8").splitlines())
    assert head == [
        "tag", "direction", "type", "unit", "low", "high", "at the start", "what it is"
    ]  # fmt: skip
    return {row[0]: row[1:] for row in rest}


def test_every_port_stands_in_it_with_its_range_in_the_unit_of_the_process_file(tmp_path):
    well = plant("wet-well")
    found = rows(cl.export(designed("simc", "wet-well"), well, tmp_path, to="signals"))
    assert found["level_pv"][:5] == ["in", "real", "mA", "4", "20"]
    assert found["duty_out"][:5] == ["out", "real", "%", "0", "100"]
    assert found["time_step"][3:5] == ["0", ""]
    assert found["duty_mode"][1] == "integer" and "1 automatic" in found["duty_mode"][-1]
    assert all(row[-1] for row in found.values())


def test_parameters_conditions_and_faceplates_stand_in_it_too(tmp_path):
    """K = 3 of the quadruple tank, limits without an end left empty, flags without a unit."""
    tank, pi = plant("quadruple-tank"), designed("simc", "quadruple-tank")
    found = rows(cl.export(pi, tank, tmp_path, to="signals"))
    gain = found["level_1_proportional_gain"]
    assert gain[:5] == ["parameter", "real", "V/V", "", ""]
    assert float(gain[5]) == pytest.approx(3.0, rel=1e-11)
    assert found["pump_1_high_limit"][5] == "10"
    assert found["level_1_setpoint_weight"][3:5] == ["0", "1"]
    flag = found["pump_1_conditions.at_high_limit"]
    assert flag[:6] == ["out", "boolean", "", "", "", "false"] and flag[-1]
    shown = found["level_1_faceplate.pv"]
    assert shown[:5] == ["out", "real", "V", "0", "10"] and shown[-1]
    ready = exportable(pi, tank.point).program
    signals = (*ready.inputs, *ready.parameters, *ready.outputs)
    assert list(found) == [signal.identifier for signal in signals]


def test_they_are_the_ports_of_the_exported_block(tmp_path):
    """By the declarations of the Structured Text."""
    tank = plant("quadruple-tank")
    pi = designed("simc", "quadruple-tank")
    found = rows(cl.export(pi, tank, tmp_path, to="signals"))
    text = "".join(
        path.read_text(encoding="utf-8")
        for path in cl.export(pi, tank, tmp_path, to="st").files
        if path.suffix == ".st"
    )
    assert len(found) > 15
    declared = [tag.rpartition(".")[2] for tag in found]
    assert [tag for tag in declared if f"{tag} : " not in text] == []


def test_a_tag_takes_the_place_of_the_name(tmp_path):
    found = rows(cl.export(cl.design.simc(tagged()), tagged(), tmp_path, to="signals"))
    assert any(tag.endswith("_pv") and not tag.startswith("level") for tag in found)
