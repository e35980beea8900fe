"""Every design of a study, in its plant shell, is the same on every target."""

from functools import lru_cache

import pytest
from deployed import need_compiler, need_grammar, need_importer

from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.deploy.proof.item import ProofItem, process_item
from clepsydra.deploy.proof.proof import prove
from clepsydra.deploy.proof.words import notes
from clepsydra.design.applicability import NotApplicable
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.study.designs import DESIGNS

#: Where a design that does not apply to the first is tried next.
PROCESSES = (
    "quadruple-tank",
    "eight-tanks",
    "equalisation-tank",
    "three-tanks",
    "wet-well:start-stop",
)

pytestmark = pytest.mark.thorough


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


@lru_cache
def analysed(name: str) -> Analysis:
    return analyse(load_process(name))


def shelled(name: str) -> ProofItem:
    for process in PROCESSES:
        analysis = analysed(process)
        try:
            controller = DESIGNS[name](analysis)
        except NotApplicable:
            continue
        point = analysis.operating_point
        period = point.process.sampling_period
        controller = with_plant_shell(controller, period)
        return ProofItem(name, period, controller.program(), controller=controller, point=point)
    raise AssertionError(f"{name} applies to none of {PROCESSES}")


@pytest.mark.parametrize("name", DESIGNS)
def test_a_family_is_the_same_on_every_target(name):
    proof = prove([shelled(name)])
    assert proof.holds, notes(proof)
    assert not proof.refusals, notes(proof)
    assert all(row.verdict == "equal" for row in proof.rows if row.exact and row.bound == 0.0)


@pytest.mark.parametrize("name", catalogue_names())
def test_a_process_is_the_same_on_every_target(name):
    proof = prove([process_item(analysed(name).operating_point)])
    assert proof.holds, notes(proof)
