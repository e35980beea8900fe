"""Work side by side: in order, each on one thread, and ended by who waits for it no more."""

from __future__ import annotations

import threading
from concurrent.futures import CancelledError

import pytest

from clepsydra.engine import threads
from clepsydra.engine.threads import available_threads, in_threads, side_by_side


@pytest.fixture(autouse=True)
def three_processors(monkeypatch):
    monkeypatch.setattr(threads.os, "sched_getaffinity", lambda _: {0, 1, 2}, raising=False)


def test_results_come_in_order_and_all_but_the_first_on_one_thread():
    found = list(side_by_side(lambda item: (item, available_threads()), range(20)))
    assert found == [(0, 3), *((item, 1) for item in range(1, 20))]


def test_items_are_taken_as_they_are_needed():
    taken = []

    def items():
        for item in range(50):
            taken.append(item)
            yield item

    found = side_by_side(lambda item: item, items())
    assert [next(found), next(found)] == [0, 1]
    assert len(taken) <= 6
    found.close()


def test_who_waits_no_more_ends_what_is_at_work():
    begun, ended = threading.Event(), []

    def endless(start, stop):
        begun.set()
        while True:
            yield

    def work(item):
        if item < 2:
            return item
        try:
            in_threads(endless, 1, 1)
        except CancelledError:
            ended.append(item)
            raise
        return item

    found = side_by_side(work, range(9))
    assert [next(found), next(found)] == [0, 1]
    assert begun.wait(10.0)
    found.close()
    assert ended


def test_a_failure_is_that_of_the_item_and_ends_the_others():
    def work(item):
        if item == 3:
            raise ValueError(item)
        return item

    found = side_by_side(work, range(9))
    assert [next(found) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="3"):
        next(found)
