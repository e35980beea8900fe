"""Every process of the catalogue is the same on every target, FMU derivatives included."""

import pytest
from tools import need_compiler, need_grammar, need_importer

from clepsydra.deploy.proof.item import process_item
from clepsydra.deploy.proof.proof import prove
from clepsydra.deploy.proof.words import notes
from clepsydra.linear.analysis import analyse
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("name", catalogue_names())
def test_a_process_is_the_same_on_every_target(name):
    need_compiler()
    need_grammar()
    need_importer()
    proof = prove([process_item(analyse(load_process(name)).operating_point)])
    assert proof.holds, notes(proof)
