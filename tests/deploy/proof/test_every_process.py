"""Every process of the catalogue is the same in C and in every dialect of Structured Text.

Of those that differ in numbers only, one is proved. FMUs have tests of their own; one process with
switches is proved on every target here.
"""

import pytest
from plants import STRUCTURES, plant
from spoilt_programs import FMUS, quickly
from tools import need_compiler, need_grammar, need_importer

from clepsydra.deploy.proof.item import process_item
from clepsydra.deploy.proof.proof import prove

pytestmark = pytest.mark.thorough


SCANS = 2_000
EVERY_FMU = (*FMUS, *(f"{name} exchange" for name in FMUS))


@pytest.mark.parametrize("name", [name for name in STRUCTURES if ":" not in name])
def test_a_process_is_the_same_on_every_target(name, monkeypatch):
    need_compiler()
    need_grammar()
    need_importer()
    quickly(monkeypatch, SCANS, without=() if name == "wet-well" else EVERY_FMU)
    proof = prove([process_item(plant(name).point)], scans=SCANS)
    assert proof.holds, proof.failures
