"""A run gives control back now and then, and is the same in every bit however often it does."""

import signal
import threading

import numpy as np
import pytest
from patched_printers import keep_nothing
from random_laws import random_law
from test_loop_rings import ring_program

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine import pacing
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program

SAMPLES = 37


class Counted(pacing.Pacing):
    """A pace that stays as it is asked for, whatever a call takes."""

    calls = 0

    def __init__(self, _):
        super().__init__(self.asked)

    def __exit__(self, *_):
        Counted.calls += 1


@pytest.fixture
def at_pace(monkeypatch):
    """Return a function: group-samples of each call."""

    def at(pace):
        Counted.asked, Counted.calls = pace, 0
        monkeypatch.setattr("clepsydra.engine.job.Pacing", Counted)

    return at


def same(found, expected):
    return all(
        np.array_equal(getattr(found, each), getattr(expected, each), equal_nan=True)
        for each in ("record", "final_state")
    )


@pytest.mark.parametrize("pace", [1, 2, 5, 36])
@pytest.mark.parametrize("every", [1, 3])
def test_one_run_with_rings_in_parts(at_pace, pace, every):
    """Rings of the state and of loops stand where the part before has left them."""
    u = np.random.default_rng(4).normal(size=SAMPLES)
    kernel = Kernel(ring_program(7))
    whole = kernel.run(SAMPLES, inputs={"u": u}, every=every)
    at_pace(pace)
    assert same(kernel.run(SAMPLES, inputs={"u": u}, every=every), whole)
    length = max(pace // every, 1) * every
    assert Counted.calls == -(-SAMPLES // length)


@pytest.mark.parametrize(("pace", "calls"), [(1, 5 * SAMPLES), (10, 5 * 4), (SAMPLES, 5), (80, 3)])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_batch_in_parts(at_pace, pace, calls, threads):
    """Five groups of lanes with inputs of their own: in samples, in groups, in several groups."""
    random = np.random.default_rng(5)
    law = random_law(11)
    own, shared, other = (signal.name for signal in law.inputs)
    kernel = Kernel(program_of(law), individual=[own], lanes=4)
    inputs = {
        own: random.normal(size=(18, SAMPLES)),
        shared: random.normal(size=SAMPLES),
        other: 0.5,
    }
    parameters = {law.parameters[0].name: random.normal(size=18)}
    whole = kernel.run(SAMPLES, inputs=inputs, parameters=parameters, threads=1)
    at_pace(pace)
    found = kernel.run(SAMPLES, inputs=inputs, parameters=parameters, threads=threads)
    assert same(found, whole)
    assert threads > 1 or Counted.calls == calls


@pytest.mark.parametrize("large", [False, True])
def test_a_state_that_is_no_number_goes_on_as_it_is(at_pace, large, monkeypatch):
    """Infinities, zeros of either sign and not-a-number, in registers and in memory."""
    keep_nothing(monkeypatch)
    monkeypatch.setattr("clepsydra.engine.vector_code.stands_in_parts", lambda _: large)
    builder = BlockBuilder(4)
    turned = [builder.operation("negate", number) for number in range(3)]
    state = tuple(Signal(name) for name in "abc")
    block = builder.finish([*turned, 0, 1, 2])
    kernel = Kernel(Program("turning", state, (Signal("u"),), (), state, block))
    begun = {"a": np.inf, "b": -0.0, "c": np.nan}
    whole = kernel.run(9, state=begun)
    at_pace(2)
    found = kernel.run(9, state=begun)
    assert found.record.tobytes() == whole.record.tobytes()
    assert found.final_state.tobytes() == whole.final_state.tobytes()


class Asked(Exception):
    """Stands for an interruption."""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="timers of POSIX")
@pytest.mark.parametrize("scenarios", [1, 40])
def test_a_run_of_days_ends_when_it_is_asked_to(scenarios):
    """Without a part this test would not end: 1e6 samples of 1e7 turns."""
    turn = BlockBuilder(2)
    body = turn.finish([turn.operation("add", turn.operation("multiply", 0, 1), 1)])
    builder = BlockBuilder(2)
    (moved,) = builder.loop("turns", body, 1, [], [0], [1], adjustable=True)
    block = builder.finish([moved])
    program = Program("days", (Signal("x"),), (Signal("u"),), (), (), block)
    running = threading.active_count()

    def ask(*_):
        raise Asked

    before = signal.signal(signal.SIGALRM, ask)
    signal.setitimer(signal.ITIMER_REAL, 0.5)
    try:
        with pytest.raises(Asked):
            Kernel(program).run(
                1_000_000, turns=10_000_000, state={"x": np.ones(scenarios)}, threads=2
            )
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert threading.active_count() == running  # and no thread goes on behind it
