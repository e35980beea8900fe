"""Engine, C and Structured Text of the conditioned linear law, equal in every bit."""

import re

import numpy as np
import pytest
from plants import designed, plant
from test_proof import proven

import clepsydra as cl
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.structured_text.printer import print_structured_text

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("decoupling", [None, "dynamic"])
def test_it_is_the_same_in_engine_c_and_structured_text(decoupling, tmp_path):
    shaping = designed("simc", "quadruple-tank", decoupling=decoupling)
    controller = cl.design.glover_mcfarlane(plant("quadruple-tank"), precompensator=shaping)
    program = controller.program()
    in_c = print_c(program).source
    in_text = print_structured_text(program).split("FUNCTION_BLOCK ")[-1]
    for entry, value in controller.values.items():
        for printed, pattern in ((in_c, rf"->{entry} = "), (in_text, rf"  {entry} : LREAL := ")):
            found = re.search(pattern + r"([-+.\dE]+);", printed)
            assert found is not None and float(found[1]) == float(value), entry
    proven(program, tmp_path, seed=11)


@pytest.mark.parametrize("anti_windup", ["conditioning", "none"])
def test_a_regulator_given_as_matrices_is_the_same_in_all_three(anti_windup, tmp_path):
    A = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.02, -0.2]])
    B = np.array([[0.1, 0.0], [0.0, 0.0675], [0.05, 0.0]])
    C = np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.0]])
    given = (A, B, C, np.diag([3.0, 2.7]))
    controller = cl.design.regulator(plant("quadruple-tank"), given, anti_windup=anti_windup)
    proven(controller.program(), tmp_path, seed=12)
