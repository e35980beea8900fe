"""A proof of some targets alone."""

import pytest
from refusals import refused
from tools import need_compiler, need_importer

import clepsydra as cl


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


def test_one_target_runs_alone_and_keeps_its_own_files(plant, tmp_path):
    need_compiler()
    need_importer()
    proof = cl.verify(cl.design.simc(plant), plant, to="c", folder=tmp_path)
    assert proof.holds
    assert {row.target for row in proof.rows} == {"C"}
    assert {path.stem for path in tmp_path.iterdir()} == {"quadruple-tank-proof-c"}


def test_a_target_that_is_none(plant):
    with refused(place="proof, to", value="plc", expected="c, st, fmu"):
        cl.verify(cl.design.simc(plant), plant, to=["c", "plc"])
