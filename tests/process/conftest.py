"""What the tests of elements share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from clepsydra import Element, Signal
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop import open_loop
from clepsydra.process.equations import join
from clepsydra.process.process import Process

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
    inputs: Callable[[float], list[float]] | list[float],
    step: float,
    steps: int,
    disturbances: Sequence[float] = (),
) -> Course:
    joined = join(elements, GRAVITY)
    process = Process(
        name="elements", title="", source="", controlled=(), elements=tuple(elements),
        nominal_outputs={}, sampling_period=step, **vars(joined),
    )  # fmt: skip
    rows = [inputs(k * step) if callable(inputs) else inputs for k in range(steps)]
    columns = zip(process.inputs, np.array(rows).T, strict=True)
    point = OperatingPoint(
        process,
        np.array([state[signal.name] for signal in process.state]),
        np.array(rows[0]),
        np.array(disturbances, float),
        np.zeros(len(process.measurements)),
        residual=np.inf,
    )
    run = open_loop.simulate(point, {s.name: column for s, column in columns}, substeps=1)
    events = process.motion.events
    return Course(
        run.time,
        run.values,
        {event.name: int(run.values[event.counted][-1]) for event in events},
        {event.name: float(run.values[event.dated][-1]) for event in events},
    )


@pytest.fixture(scope="session")
def simulate() -> Callable[..., Course]:
    """Run a few elements by located Runge-Kutta steps, without a controller."""
    return _simulate
