"""Engine, C and Structured Text of a Glover-McFarlane controller, equal in every bit."""

import re

import pytest
from test_proof import proven

from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.designs.glover_mcfarlane import design_glover_mcfarlane
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("decoupling", [None, "dynamic"])
def test_it_is_the_same_in_engine_c_and_structured_text(decoupling, tmp_path):
    analysis = analyse(load_process("quadruple-tank"))
    shaping = design_simc(analysis.model, analysis.pairing, decoupling=decoupling)
    controller = design_glover_mcfarlane(analysis.model, analysis.pairing, precompensator=shaping)
    program = controller.program()
    in_c, in_text = print_c(program).source, print_structured_text(program)
    for entry, value in (controller.values | controller.initial_state).items():
        for printed, pattern in ((in_c, rf"->{entry} = "), (in_text, rf"  {entry} : LREAL := ")):
            found = re.search(pattern + r"([-+.\dE]+);", printed)
            assert found is not None and float(found[1]) == float(value), entry
    proven(program, tmp_path, seed=11)
