"""Rings that advance with the turns of a loop, against a queue in plain Python."""

from collections import deque

import numpy as np
import pytest
from refusals import refused

from clepsydra import Kernel, Signal
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program

COUNT, SAMPLES = 6, 11
WEIGHTS = np.array([0.5, -1.0, 2.0, 0.25, 1.5, -0.75])


def ring_program(length: int) -> Program:
    """Two rings in a loop of six turns, one in a loop of two, and one of the state beside them."""
    turn = BlockBuilder(6)  # weight, x, oldest of a, oldest of b; u, gain
    mixed = turn.operation("add", turn.operation("multiply", 0, 2), 3)
    x = turn.operation("add", turn.operation("multiply", turn.constant(0.5), 1), mixed)
    first = turn.finish([x, turn.operation("add", 1, 4), turn.operation("multiply", 2, 5)])
    second = BlockBuilder(3)  # s, oldest of c; u
    again = second.finish([second.operation("subtract", 1, 0), second.operation("add", 0, 2)])
    builder = BlockBuilder(4)  # x, pipe; u; gain
    (moved,) = builder.loop(
        "first", first, COUNT, [WEIGHTS.tolist()], [0], [2, 3],
        rings=[DelayRing(Signal("a", initial=-3.0), length), DelayRing(Signal("b"), 4)],
    )  # fmt: skip
    (out,) = builder.loop(
        "second", again, 2, [], [1], [2], rings=[DelayRing(Signal("c", initial=0.5), 5)]
    )
    state = (Signal("x", initial=0.1), DelayRing(Signal("pipe", initial=9.0), 3))
    block = builder.finish([moved, moved, out, moved])
    outputs = (Signal("out"), Signal("x_now"))
    return Program("rings", state, (Signal("u"),), (Signal("gain", initial=0.3),), outputs, block)


def by_queues(length: int, u: np.ndarray, gain: float, start: dict[str, float]) -> np.ndarray:
    a, b, c, pipe = (
        deque([start[name]] * size)
        for name, size in (("a", length), ("b", 4), ("c", 5), ("pipe", 3))
    )
    x, rows = start["x"], []
    for now in u.tolist():
        old = pipe.popleft()
        for weight in WEIGHTS.tolist():
            oldest_a, oldest_b = a.popleft(), b.popleft()
            a.append(x + now)
            b.append(oldest_a * gain)
            x = 0.5 * x + (weight * oldest_a + oldest_b)
        s = old
        for _ in range(2):
            oldest_c = c.popleft()
            c.append(s + now)
            s = oldest_c - s
        pipe.append(x)
        rows.append([s, x])
    return np.array(rows)


INITIAL = {"x": 0.1, "pipe": 9.0, "a": -3.0, "b": 0.0, "c": 0.5}


@pytest.mark.parametrize("length", [1, 2, 5, 6, 7, 12, 13, 40, 100])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_ring_gives_what_was_written_so_many_turns_before(length, threads):
    scenarios = 35
    random = np.random.default_rng(length)
    u, gain = random.normal(size=SAMPLES), random.normal(size=scenarios)
    start = {name: random.normal(size=scenarios) for name in ("x", "pipe", "a", "c")}
    kernel = Kernel(ring_program(length), fuse=False)
    batch = kernel.run(
        SAMPLES, inputs={"u": u}, parameters={"gain": gain}, state=start, threads=threads
    )
    assert batch.final_state.shape == (2, scenarios)
    for scenario in range(scenarios):
        own = {name: float(values[scenario]) for name, values in start.items()}
        expected = by_queues(length, u, gain[scenario], INITIAL | own)
        one = kernel.run(SAMPLES, inputs={"u": u}, parameters={"gain": gain[scenario]}, state=own)
        assert np.array_equal(one.record_of(0), expected)
        assert np.array_equal(batch.record_of(scenario), expected)
        assert batch.state("x")[scenario] == expected[-1, 1]


def test_rings_start_from_the_initial_value_of_their_signal():
    kernel, u = Kernel(ring_program(8), fuse=False), np.linspace(-1, 1, SAMPLES)
    run = kernel.run(SAMPLES, inputs={"u": u})
    assert np.array_equal(run.record_of(0), by_queues(8, u, 0.3, INITIAL))


def test_a_job_that_is_started_twice_fills_its_rings_anew():
    job = Kernel(ring_program(8)).prepare(SAMPLES, state={"b": np.arange(3.0)})
    first, second = job.run(), job.run()
    assert np.array_equal(first.record, second.record)
    assert len(np.unique(first.output("x_now")[:, 0])) == 3


def test_a_ring_that_nothing_reads_yet_is_written_all_the_same():
    """A pure delay of 9 turns behind a loop of 4 turns whose carried value nothing reads."""
    turn, builder = BlockBuilder(3), BlockBuilder(2)
    body = turn.finish([1, 2])
    _ = builder.loop("unread", body, 4, [], [0], [1], rings=[DelayRing(Signal("r"), 9)])
    (late,) = builder.loop("read", body, 4, [], [0], [1], rings=[DelayRing(Signal("q"), 9)])
    block = builder.finish([0, late])
    program = Program("p", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), block)
    u = np.arange(1.0, 9.0)
    found = Kernel(program).run(8, inputs={"u": u}).output("y")[0]
    # The last turn of sample k is turn 4 k + 3; what it reads was written in turn 4 k - 6.
    turns = np.repeat(u, 4)
    assert np.array_equal(found, [turns[4 * k - 6] if 4 * k >= 6 else 0.0 for k in range(8)])


@pytest.mark.parametrize("scenarios", [1, 9])
def test_a_loop_that_carries_nothing_still_runs_in_every_sample(scenarios):
    """It has no value that could depend on anything, yet it must not leave the time loop."""
    turn, builder = BlockBuilder(2), BlockBuilder(2)
    nothing = builder.loop(
        "idle", turn.finish([1]), 3, [], [], [0], rings=[DelayRing(Signal("r"), 2)]
    )
    block = builder.finish([0, builder.operation("add", 0, 1)])
    program = Program("p", (Signal("x"),), (), (Signal("p"),), (Signal("y"),), block)
    p = np.arange(float(scenarios))
    run = Kernel(program).run(4, parameters={"p": p}, state={"x": 2.0})
    assert nothing == () and np.array_equal(run.output("y"), np.repeat(2.0 + p[:, None], 4, axis=1))


def test_an_unknown_ring_is_refused_with_the_known_ones():
    with refused(remedy="the states are x, pipe, a, b, c"):
        Kernel(ring_program(3)).run(2, state={"d": 1.0})
