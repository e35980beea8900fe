"""What the tests of elements share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from clepsydra import Element, Signal
from clepsydra.loop.event_location import located_step
from clepsydra.loop.motion_step import MotionStep
from clepsydra.process.equations import join

GRAVITY = Signal("gravity", "m/s^2", initial=9.81)


@dataclass
class Course:
    """A simulation by steps of equal length: states and memories by name, events by name."""

    time: np.ndarray
    values: dict[str, np.ndarray]
    count: dict[str, int]
    last: dict[str, float]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]


def _simulate(
    elements: Sequence[Element],
    state: dict[str, float],
    inputs: Callable[[float, dict[str, float]], list[float]] | list[float],
    step: float,
    steps: int,
    disturbances: Sequence[float] = (),
) -> Course:
    joined = join(elements, GRAVITY)
    motion = joined.motion
    assert not motion.delays
    p = [signal.initial for signal in joined.parameters]
    parts = MotionStep(motion)
    located, updates = located_step(parts), parts.updates
    x = [state[signal.name] for signal in joined.state]
    c = np.asarray(motion.to_contents(x, p)).ravel()
    m = np.array([signal.initial for signal in motion.memories])
    count, last = np.zeros(len(motion.events)), np.zeros(len(motion.events))
    names = [s.name for s in (*joined.state, *motion.memories)]
    rows = [[*x, *m]]
    for number in range(steps):
        now = dict(zip(names, rows[-1], strict=True))
        u = inputs(number * step, now) if callable(inputs) else inputs
        results = located(step, number * step, c, [], count, last, m, u, disturbances, p)
        c, count, last, m = (np.asarray(result).ravel() for result in results)
        m = np.asarray(updates(1, c, [], m, u, disturbances, p)).ravel()
        rows.append([*np.asarray(motion.to_state(c, p)).ravel(), *m])
    events = [event.name for event in motion.events]
    return Course(
        np.arange(steps + 1) * step,
        dict(zip(names, np.array(rows).T, strict=True)),
        dict(zip(events, map(int, count), strict=True)),
        dict(zip(events, map(float, last), strict=True)),
    )


@pytest.fixture(scope="session")
def simulate() -> Callable[..., Course]:
    """Run a few elements by located Runge-Kutta steps, without a controller."""
    return _simulate
