"""Who may work at a campaign: told without any cluster."""

from __future__ import annotations

import os
import sys
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.engine.host import host
from clepsydra.interface.robustness import loops_of
from clepsydra.studies.robustness import drawn_plants
from clepsydra.studies.robustness.chunk_work import JobMissing, draw, take
from clepsydra.studies.robustness.cluster import cluster_at, local_workers
from clepsydra.studies.robustness.crew import packed
from clepsydra.studies.robustness.drawn_plants import GivenPlants
from clepsydra.studies.robustness.tally import Tally
from clepsydra.studies.robustness.workers_alike import (
    drawing_nothing,
    own_answer,
    refusal,
    sample,
)

PLACE = "tcp://10.0.0.7:4000"


@pytest.fixture(scope="module")
def loops():
    plant = cl.load("quadruple-tank")
    step = [cl.step("level_1", "+1 V", at="10 s")]
    found = loops_of(cl.design.simc(plant), plant, step, uncertainty=None, duration="200 s", seed=1)
    return replace(found, names=("iae[level_1]",))


def test_who_says_the_same_may_work_whether_or_not_it_fuses():
    own = own_answer()
    assert own.fuses == host().fuses
    assert own.versions["NumPy"] == np.__version__
    assert refusal(PLACE, replace(own, fuses=not own.fuses), own) is None


@pytest.mark.parametrize("name", ("Clepsydra", "CasADi", "NumPy", "SciPy"))
def test_who_has_another_version_may_not(name):
    own = own_answer()
    error = refusal(PLACE, replace(own, versions={**own.versions, name: "0.0.1"}), own)
    assert (error.place, error.value) == (f"worker {PLACE}", f"{name} 0.0.1")
    assert error.expected == f"{name} {own.versions[name]}, as here"


def test_who_lacks_a_module_is_told_which():
    missing = ModuleNotFoundError(name="clepsydra.studies")
    assert drawing_nothing(PLACE, missing).value == "no Clepsydra, or another"
    assert drawing_nothing(PLACE, AttributeError()).value == "no Clepsydra, or another"
    error = drawing_nothing(PLACE, ModuleNotFoundError(name="my_laws.float_valve"))
    assert (error.value, error.expected) == ("no module my_laws", "module my_laws, as here")


def test_a_job_that_was_sent_draws_the_same_until_others_have_come(loops):
    job = sample(loops, 100)
    assert take(job, packed(loops), 100) == job
    assert draw(job, 3, 40).as_dict() == Tally.of(loops.draw(np.arange(3, 41))).as_dict()
    for draws in (1, 2, 3, 4):
        assert take(job, packed(loops), 100) == job  # which makes it the last one
        other = sample(loops, draws)
        assert take(other, packed(loops), draws) == other
    draw(job, 1, 2)
    take(sample(loops, 5), packed(loops), 5)
    for draws in (2, 3, 4):
        take(sample(loops, draws), packed(loops), draws)
    with pytest.raises(JobMissing):
        draw(job, 1, 2)


def test_a_job_that_is_another_one_here_is_not_kept(loops):
    assert take("what the others have", packed(loops), 1) == sample(loops, 1)
    with pytest.raises(JobMissing):
        draw("what the others have", 1, 1)


def test_a_sample_tells_plants_from_their_last_bit_on(loops, monkeypatch):
    before = sample(loops, 100)
    assert sample(replace(loops, plants=replace(loops.plants)), 100) == before
    made = drawn_plants.draw_parameters

    def moved(*given):
        found = made(*given)
        found["tank_1.area"][-1] = np.nextafter(found["tank_1.area"][-1], 1.0)
        return found

    monkeypatch.setattr(drawn_plants, "draw_parameters", moved)
    assert sample(loops, 100) != before


def test_a_sample_asks_for_no_more_plants_than_there_are(loops):
    point, pairing = loops.plants.point, loops.plants.pairing
    areas = {"tank_1.area": np.array([0.0028, 0.0029])}
    given = replace(loops, plants=GivenPlants(point, pairing, areas))
    assert len(sample(given, 2)) == len(sample(loops, 2))


@pytest.mark.parametrize("count", (0, -1, 2.0, True, "2", 100_000))
def test_so_many_workers_cannot_be(count):
    most = max(len(os.sched_getaffinity(0)), 2)
    with refused(place="workers", value=count, expected=f"1 to {most}"), local_workers(count):
        pass


@pytest.mark.parametrize(
    "address",
    ("", "host", "host:8786", "http://host:80", "tcp://:1", "tcp://a b:1", "tcp://h:123456"),
)
def test_what_is_no_address_is_refused(address):
    with refused(place="cluster", value=address, expected="tcp://host:8786"), cluster_at(address):
        pass


@pytest.mark.parametrize("package", ("distributed", "cryptography"))
def test_without_the_extra_it_is_said_what_to_install(monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    for cluster in (local_workers(1), cluster_at("tcp://127.0.0.1:1")):
        with refused(place="cluster", remedy="pip install 'clepsydra[cluster]'"), cluster:
            pass
