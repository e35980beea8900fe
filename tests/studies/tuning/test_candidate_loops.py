"""The sensitivity peaks of many candidates, of which only those that count are looked for."""

import numpy as np

import clepsydra as cl
from clepsydra.studies.tuning.candidate_loops import CandidateLoops
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.memory import Memory
from clepsydra.studies.tuning.objective import Limits
from clepsydra.studies.tuning.parameters import settings_of


def test_a_peak_that_is_left_out_is_no_lower_than_one_before():
    plant = cl.load("quadruple-tank")
    controller = cl.design.simc(plant)
    space = LawSpace(controller, settings_of(controller))
    points = np.random.default_rng(1).uniform(size=(200, len(space.start)))
    loops, others = (
        CandidateLoops(space, plant.linear, Limits(), Memory(points.shape[1], 1, "")) for _ in "ab"
    )
    every, found = loops.sensitivities(points), others.falling_sensitivities(points)
    before = np.minimum.accumulate(np.append(np.inf, every[:-1]))
    counts = every < before
    assert np.count_nonzero(counts) > 2
    assert found[counts].tolist() == every[counts].tolist()
    assert np.all(found >= every)
    # Most were not looked for.
    assert np.count_nonzero(np.isfinite(found)) < np.count_nonzero(np.isfinite(every)) / 2
