"""Every process of the catalogue is the same on every target, FMU derivatives included."""

import pytest
from plants import plant
from tools import need_compiler, need_grammar, need_importer

from clepsydra.deploy.proof.item import process_item
from clepsydra.deploy.proof.proof import prove
from clepsydra.deploy.proof.words import notes
from clepsydra.process.catalogue_names import catalogue_names

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("name", catalogue_names())
def test_a_process_is_the_same_on_every_target(name):
    need_compiler()
    need_grammar()
    need_importer()
    proof = prove([process_item(plant(name).point)])
    assert proof.holds, notes(proof)
