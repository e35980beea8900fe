"""Many draws in chunks: the same bits however they are divided, interrupted and gone on with."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.studies.robustness.campaign import Campaign
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_plants import DrawnPlants
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.robustness.tally import Tally

DRAWS = 1000


def loops_of(seed=1):
    plant = cl.load("laboratory-four-tanks")
    plants = DrawnPlants(plant.point, plant.analysis.pairing, plant.process.uncertainty, seed)
    names = ("iae[level_1]", "total_variation[pump_1]")
    loops = DrawnLoops(cl.design.simc(plant), default_scenario(plant.linear), plants, names)
    loops.__dict__["chunk"] = 128  # of small ones, as a long scenario has them
    return loops


@pytest.fixture(scope="module")
def loops():
    return loops_of()


@pytest.fixture(scope="module")
def whole(loops):
    return Campaign(loops, DRAWS).run()


def test_chunks_make_the_same_as_all_draws_at_once(loops, whole):
    at_once = Tally.of(loops.draw(np.arange(1, DRAWS + 1)))
    assert at_once.as_dict() == whole.as_dict()
    assert whole.draws == DRAWS
    assert 0 < whole.happened[Happening.INFEASIBLE] == sum(whole.reasons.values())


def test_chunks_come_in_any_order(loops, whole):
    def backwards(campaign, chunks):
        for chunk in reversed(list(chunks)):
            yield chunk, campaign.tally(chunk)

    assert Campaign(loops, DRAWS).run(carrier=backwards).as_dict() == whole.as_dict()


def test_an_interrupted_run_goes_on_and_ends_with_the_same_bits(loops, whole, tmp_path):
    state, seen = tmp_path / "draws.json", []

    def stop(progress):
        seen.append(progress.done)
        if progress.done >= 300:
            raise KeyboardInterrupt

    campaign = Campaign(loops, DRAWS)
    with pytest.raises(KeyboardInterrupt):
        campaign.run(state_file=state, progress=stop)
    done = json.loads(state.read_text())["done"]
    assert done == [0, 1, 2]
    again = []
    found = campaign.run(state_file=state, progress=lambda p: again.append(p.done))
    assert again[0] == 384
    assert found.as_dict() == whole.as_dict()
    last = []
    assert campaign.run(state_file=state, progress=last.append).as_dict() == whole.as_dict()
    assert len(last) == 1


def test_a_file_of_other_draws_is_refused(loops, tmp_path):
    state = tmp_path / "draws.json"
    Campaign(loops, 200).run(state_file=state)
    for other in (Campaign(loops, 300), Campaign(loops_of(seed=2), 200)):
        with refused(expected="number of draws", remedy="delete this one"):
            other.run(state_file=state)
    with refused(expected="multiply-adds not fused"):
        Campaign(replace(loops, fuse=False), 200).run(state_file=state)
    content = json.loads(state.read_text())
    content["tally"]["scores"]["iae[level_1]"][0] = "AAAA"
    state.write_text(json.dumps(content))
    with refused(expected="as_bytes"):
        Campaign(loops, 200).run(state_file=state)
    state.write_text("[]")
    with refused(expected="interrupted run", remedy="delete this one"):
        Campaign(loops, 200).run(state_file=state)
