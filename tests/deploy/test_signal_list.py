"""The list of signals: what is wired, in the units and by the tags of the process file."""

import csv

from plants import designed, plant, tagged

import clepsydra as cl


def rows(found):
    (path,) = found.files
    head, *rest = csv.reader(path.read_text(encoding="utf-8").splitlines())
    assert head == ["tag", "direction", "type", "unit", "low", "high", "what it is"]
    return {row[0]: row[1:] for row in rest}


def test_every_port_stands_in_it_with_its_range_in_the_unit_of_the_process_file(tmp_path):
    well = plant("wet-well")
    found = rows(cl.export(designed("simc", "wet-well"), well, tmp_path, to="signals"))
    assert found["level_pv"][:5] == ["in", "real", "mA", "4", "20"]
    assert found["duty_out"][:5] == ["out", "real", "%", "0", "100"]
    assert found["time_step"][3:5] == ["0", ""]
    assert found["duty_mode"][1] == "integer" and "1 automatic" in found["duty_mode"][-1]
    assert all(row[-1] for row in found.values())


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
    assert [tag for tag in found if f"{tag} : " not in text] == []


def test_a_tag_takes_the_place_of_the_name(tmp_path):
    found = rows(cl.export(cl.design.simc(tagged()), tagged(), tmp_path, to="signals"))
    assert any(tag.endswith("_pv") and not tag.startswith("level") for tag in found)
