"""Deadlines of who makes up for what was missed, and of who does not."""

import asyncio

import pytest

from clepsydra.rig.deadlines import Deadlines


class Clock:
    """A clock that goes on only while somebody sleeps."""

    def __init__(self) -> None:
        self.time = 100.0

    def now(self) -> float:
        return self.time

    def sleep(self, seconds: float) -> None:
        self.time += seconds


@pytest.fixture
def clock():
    return Clock()


def deadlines(clock, **options) -> Deadlines:
    return Deadlines(1.0, now=clock.now, sleep=clock.sleep, **options)


@pytest.mark.parametrize(
    ("makes_up", "begins", "missed"),
    [(True, [4.25, 4.25, 4.25, 5.0], 0), (False, [4.25, 5.0, 6.0, 7.0], 2)],
)
def test_a_long_period(clock, makes_up, begins, missed):
    """After 3.25 periods in one: the two that were missed are made up for at once, or left out."""
    each = deadlines(clock, first=101.0, makes_up=makes_up)
    each.wait()
    clock.sleep(3.25)
    found = []
    for _ in begins:
        each.wait()
        found.append(clock.time - 100.0)
    assert (found, each.missed) == (begins, missed)


def test_periods_are_left_out(clock):
    each = deadlines(clock)
    each.wait()
    assert each.leave_out(3) == 3
    each.wait()
    assert (clock.time, each.last, each.lateness, each.missed) == (105.0, 105.0, 0.0, 0)
    clock.sleep(2.5)
    assert each.leave_out() == 2
    each.wait()
    assert clock.time == 108.0


def test_others_go_on_meanwhile():
    """Nothing is said of how long it took: the other one was there."""
    each, seen = Deadlines(0.01), []

    async def both() -> None:
        async def other() -> None:
            seen.append("other")

        task = asyncio.ensure_future(other())
        await each.wait_beside()
        seen.append("deadline")
        await task

    asyncio.run(both())
    assert seen == ["other", "deadline"]
