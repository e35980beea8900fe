"""A process whose analyser takes its time and reports at times is the same on every target."""

import pytest
from late_sensors import SENSORS, with_analyser
from spoilt_programs import FMUS, quickly
from tools import need_compiler, need_grammar, need_importer

import clepsydra as cl
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.proof.item import ProofItem, process_item
from clepsydra.deploy.proof.proof import prove


@pytest.mark.parametrize("sensor", SENSORS)
def test_every_target_tells_the_same_bits(sensor, tmp_path, monkeypatch):
    need_compiler()
    need_grammar()
    need_importer()
    # FMUs have tests of their own.
    quickly(monkeypatch, 500, without=FMUS)
    proof = prove([process_item(with_analyser(tmp_path, sensor).point)], scans=500)
    assert proof.holds, proof.failures


def test_a_law_that_recalls_past_values_is_the_same_in_an_fmu(tmp_path, monkeypatch):
    """Among its states are `strength.5_s_before`, which no FMU may call so."""
    need_compiler()
    need_importer()
    quickly(monkeypatch, 500)
    plant = with_analyser(tmp_path, SENSORS[0])
    ready = exportable(cl.design.lqi_kalman(plant), plant.point)
    item = ProofItem("past values", 5.0, ready.program, origin=ready.origin)
    proof = prove([item], scans=500, to=("fmu",))
    assert [row.verdict for row in proof.rows] == ["equal", "equal"]
