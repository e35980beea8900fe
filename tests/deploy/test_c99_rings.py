"""Rings that advance with the turns of a loop: transport delays of a process, in C."""

from collections import deque
from dataclasses import replace

import deployed
import numpy as np
import pytest
from block_interpreter import evaluate_block
from deployed import CompiledC, all_bits
from random_blocks import FINITE, random_block, stimulus
from single_precision import InSinglePrecision, single_bits
from written_plants import plant_of

from clepsydra import Kernel, Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.process_program import process_program
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.defaults import with_defaults
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import EXACT, Operation
from clepsydra.program.program import Block, ForLoop, Program

SAMPLES = 300
CHANNEL = """
name = "channel"
title = "Two tanks, two channels, a trip and a weir"
gravity = "9.81 m/s^2"
sampling_period = "1 s"
controlled = ["level"]
manipulated = ["feed"]
[reservoirs.basin]
[delays.first]
destination = "upper"
time = "7.5 s"
[delays.second]
destination = "lower"
time = "1 s"
[tanks.upper]
area = "300 cm^2"
height = "50 cm"
[tanks.lower]
area = "200 cm^2"
height = "60 cm"
[orifices.between]
source = "upper"
destination = "second"
area = "1.5 cm^2"
[orifices.outlet]
source = "lower"
destination = "basin"
area = "1.4 cm^2"
[pumps.feed]
source = "basin"
destination = "first"
gain = "60 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "4 V"
trip_above = { upper = "40 cm" }
hysteresis = "10 cm"
[sensors.level]
tank = "lower"
range = ["0 cm", "60 cm"]
"""


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    """The process with two transport delays, as a program of four turns a sample."""
    plant = plant_of(tmp_path_factory.mktemp("process"), CHANNEL)
    return process_program(plant.point, 4)


def profiles(program: Program) -> dict[str, np.ndarray]:
    random = np.random.default_rng(11)
    given = {s.name: np.full(SAMPLES, s.initial) for s in program.inputs}
    given["feed"] = np.repeat(random.uniform(0, 10, SAMPLES // 20), 20)
    return given


@pytest.mark.thorough
def test_a_process_with_transport_delays_is_the_engine_s_in_every_bit(channel, tmp_path):
    lengths = [ring.length for ring in channel.rings]
    assert lengths == [30, 30, 30, 4, 4, 4]
    assert all(operation.code in EXACT for operation in channel.block.operations())
    given = profiles(channel)
    run = Kernel(channel).run(SAMPLES, inputs=given)
    engine = np.column_stack([run.output(signal.name)[0] for signal in channel.outputs])
    in_c = CompiledC(channel, tmp_path).run(given)[:, : engine.shape[1]]
    np.testing.assert_array_equal(all_bits(in_c), all_bits(engine))
    upper = engine[:, [s.name for s in channel.outputs].index("upper.level")]
    assert np.ptp(upper) > 0.1 and np.any(np.diff(upper) != 0)


@pytest.mark.thorough
def test_in_single_precision_too(channel, tmp_path):
    given = {name: column[:80] for name, column in profiles(channel).items()}
    in_c = CompiledC(channel, tmp_path, "single").run(given)
    second = InSinglePrecision(channel).run(given)
    np.testing.assert_array_equal(single_bits(in_c), single_bits(second))


def delayed(lengths: list[int], count: int = 4) -> Program:
    """Each turn puts u into the first ring and what comes out of one into the next; y is the last.

    In every turn u counts as u + its number in the sample.
    """
    rings = tuple(
        DelayRing(Signal(f"pipe_{k}", "m^3/s", initial=-float(k)), length)
        for k, length in enumerate(lengths, 1)
    )
    # row, the last value that came out, oldest of each ring, u
    size = 3 + len(rings)
    turn = BlockBuilder(size)
    entering = turn.operation("add", size - 1, 0)
    oldest = list(range(2, 2 + len(rings)))
    body = turn.finish([oldest[-1], entering, *oldest[:-1]])
    builder = BlockBuilder(1)
    table = [[float(k) for k in range(count)]]
    values = builder.loop("delay", body, count, table, [builder.constant(0.0)], [0], rings=rings)
    return Program("pipes", (), (Signal("u"),), (), (Signal("y"),), builder.finish(values))


@pytest.mark.parametrize("lengths", [[1], [2], [3], [4], [9], [1, 1], [3, 1, 6], [2, 5]])
def test_what_comes_out_is_what_went_in_so_many_turns_before(lengths, tmp_path):
    program, samples = delayed(lengths), 12
    given = 100.0 * np.arange(1, samples + 1)
    went_in = [value + k for value in given for k in range(4)]
    # The pipes begin full of -1, -2, …: the last pipe is emptied first.
    full = [-float(k) for k in range(len(lengths), 0, -1) for _ in range(lengths[k - 1])]
    comes_out = [*full, *went_in][3::4][:samples]
    found = CompiledC(program, tmp_path).run({"u": given})
    assert found[:, 0].tolist() == comes_out


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
def test_random_bodies_with_rings_equal_the_interpreter(seed, tmp_path, monkeypatch):
    unread = [f"-Wno-unused-{what}" for what in ("but-set-variable", "variable", "const-variable")]
    monkeypatch.setattr(deployed, "STRICT", [*deployed.STRICT, *unread])
    random = np.random.default_rng(seed)
    tables, carried, rings, invariants = (int(n) for n in random.integers(1, 4, size=4))
    body, _ = random_block(
        500 + seed, tables + carried + rings + invariants, carried + rings,
        nesting=0.1, library=False, special=FINITE,
    )  # fmt: skip
    count = int(random.integers(1, 6))
    loop = ForLoop(
        tuple(range(10, 10 + carried)), count, body,
        tuple(map(tuple, random.normal(size=(tables, count)).tolist())),
        tuple(int(n) for n in random.integers(4, size=carried)),
        tuple(int(n) for n in random.integers(4, size=invariants)), "turns",
        tuple(
            DelayRing(Signal(f"ring_{k}", initial=float(random.normal())), int(length))
            for k, length in enumerate(random.integers(1, 9, size=rings))
        ),
    )  # fmt: skip
    block = Block(4, (loop,), loop.targets)
    signals = tuple(Signal(f"x{i}") for i in range(4))
    outputs = tuple(Signal(f"y{i}") for i in range(carried))
    program = Program("p", (), signals, (), outputs, block)
    rows = stimulus(seed, 30, 4)
    kept = {ring.name: deque([ring.signal.initial] * ring.length) for ring in loop.rings}
    expected = np.array([evaluate_block(block, row, kept) for row in rows])
    columns = {signal.name: rows[:, i] for i, signal in enumerate(signals)}
    found = CompiledC(program, tmp_path).run(columns)
    np.testing.assert_array_equal(all_bits(found), all_bits(expected))


def test_the_state_holds_them_with_what_they_count():
    program = delayed([3, 1])
    header, source = (getattr(print_c(program), part) for part in ("header", "source"))
    assert "  double pipe_1[3]; /* [m^3/s]; delayed by 3 turns */\n" in header
    assert "  int32_t pipe_1_position; /* [1] place of the oldest value */\n" in header
    assert "  double pipe_2; /* [m^3/s]; delayed by 1 turn */\n" in header
    assert "    state->pipe_1[i] = -1.0; /* [m^3/s] */\n" in source
    assert "  state->pipe_2 = -2.0; /* [m^3/s] */\n" in source


def test_length_content_and_name_belong_to_the_digest():
    program = delayed([3, 1])
    others = [
        delayed([4, 1]),
        with_defaults(program, {"pipe_1": -1.5}),
        _renamed(program, "pipe_1", "hose"),
    ]
    assert len({digest(program), *map(digest, others)}) == 4


def test_a_loop_keeps_what_nobody_reads_in_this_sample(tmp_path):
    """Its carried value is read by nothing, and still the ring must move."""
    body = Block(3, (Operation(3, "add", (1, 2)),), (0, 3))
    ring = DelayRing(Signal("late"), 2)
    loop = ForLoop((2,), 3, body, (), (0,), (0,), "turns", (ring,))
    program = Program("p", (), (Signal("u"),), (), (Signal("y"),), Block(1, (loop,), (0,)))
    compiled = CompiledC(program, tmp_path)
    compiled.run({"u": np.array([1.0])})
    # Turns add u to what was written two turns before: 1, 1, 2.
    assert sorted(compiled.memory.late) == [1.0, 2.0]


def _renamed(program: Program, old: str, new: str) -> Program:
    def named(ring: DelayRing) -> DelayRing:
        return replace(ring, signal=replace(ring.signal, name=new)) if ring.name == old else ring

    (loop,) = (s for s in program.block.statements if isinstance(s, ForLoop))
    changed = replace(loop, rings=tuple(map(named, loop.rings)))
    statements = tuple(changed if s is loop else s for s in program.block.statements)
    return replace(program, block=replace(program.block, statements=statements))
