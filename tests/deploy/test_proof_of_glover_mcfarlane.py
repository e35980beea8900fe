"""Engine, C and Structured Text of the conditioned linear law, equal in every bit."""

import numpy as np
import pytest
from deployed import prints_its_numbers
from plants import designed, plant
from test_proof import proven

import clepsydra as cl

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("decoupling", [None, "dynamic"])
def test_it_is_the_same_in_engine_c_and_structured_text(decoupling, tmp_path):
    shaping = designed("simc", "quadruple-tank", decoupling=decoupling)
    controller = cl.design.glover_mcfarlane(plant("quadruple-tank"), precompensator=shaping)
    prints_its_numbers(controller)
    proven(controller.program(), tmp_path, seed=11)


@pytest.mark.parametrize("anti_windup", ["conditioning", "none"])
def test_a_regulator_given_as_matrices_is_the_same_in_all_three(anti_windup, tmp_path):
    A = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.02, -0.2]])
    B = np.array([[0.1, 0.0], [0.0, 0.0675], [0.05, 0.0]])
    C = np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.0]])
    given = (A, B, C, np.diag([3.0, 2.7]))
    controller = cl.design.regulator(plant("quadruple-tank"), given, anti_windup=anti_windup)
    proven(controller.program(), tmp_path, seed=12)
