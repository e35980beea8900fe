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


@pytest.mark.parametrize(
    ("to", "value"),
    [(["c", "plc"], "plc"), ("cst", "cst"), ([], "nothing"), (3, 3), (["c", 3], 3)],
)
def test_a_target_that_is_none(plant, to, value):
    """Nothing run would be a proof that holds."""
    with refused(place="proof, to", value=value, expected="c, st, fmu", remedy="leave it out"):
        cl.verify(cl.design.simc(plant), plant, to=to)
