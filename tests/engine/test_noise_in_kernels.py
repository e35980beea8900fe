"""Noise that kernels make while they run, against NumPy's, bit for bit."""

import numpy as np
import pytest
from patched_printers import keep_nothing
from random_laws import random_law
from refusals import refused
from test_interruption import Counted
from test_loop_rings import ring_program

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine import vector_parts
from clepsydra.engine.batch_noise import BatchNoise, InputNoise
from clepsydra.engine.noise_code import CHUNK
from clepsydra.engine.stepping import SteppedKernel
from clepsydra.engine.white_noise import seed_of, stream_of, white_noise
from clepsydra.program.step_law import Equations, step_law

SAMPLES = 3 * CHUNK + 11
NAMES = ("u", "v", "w")
LARGEST = 2**32 - 1


@pytest.fixture(scope="module")
def seen():
    """Return a program that shows its inputs as they come."""
    return program_of(
        step_law(
            "seen",
            inputs=[Signal(name) for name in NAMES],
            parameters=[],
            state=[],
            outputs=[Signal(f"{name}_seen") for name in NAMES],
            equations=lambda s: Equations({}, {f"{name}_seen": s[name] for name in NAMES}),
        )
    )


def added(column, noise, seed, start=0):
    """Return an input [samples] with the noise of a seed, as loops add it."""
    whole = np.array(column, dtype=float)
    first, last = (
        np.clip(sample - start, 0, len(whole))
        for sample in (noise.first, noise.first + noise.count)
    )
    white = white_noise(seed, noise.stream, start + first, last - first)
    whole[first:last] += noise.deviation * white
    return whole


def in_bits(array):
    return np.asarray(array, dtype=float).tobytes()


@pytest.mark.parametrize("lanes", [1, 2, 3, 4, 8, 12, 16, 32])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize(
    ("seed", "numbers", "start"),
    [
        (0, range(21), 0),
        (7, range(100, 142, 2), 2**33 + 37),
        (LARGEST, range(LARGEST, LARGEST - 21, -1), 2 * CHUNK),
    ],
)
def test_every_bit_in_every_lane(seen, lanes, threads, seed, numbers, start):
    """Shared and individual inputs, whose stretches begin and end anywhere."""
    random = np.random.default_rng(lanes)
    noises = {
        "u": InputNoise(stream_of("level_1"), 0.05, start, SAMPLES),
        "v": InputNoise(LARGEST, 3e5, start + CHUNK + 7, CHUNK),
        "w": InputNoise(0, 1e-9, 0, start + 2 * CHUNK + 1),
    }
    inputs = {
        "u": random.normal(size=SAMPLES),
        "v": random.normal(size=(21, SAMPLES)),
        "w": -0.0,
    }
    kernel = Kernel(seen, individual=["v"], lanes=lanes)
    noise = BatchNoise(noises, seed, np.array(numbers, np.uint64), start)
    run = kernel.run(SAMPLES, inputs=inputs, noise=noise, threads=threads)
    for scenario, number in enumerate(numbers):
        for name in NAMES:
            quiet = np.broadcast_to(inputs[name], (21, SAMPLES))[scenario]
            expected = added(quiet, noises[name], seed_of(seed, number), start)
            assert in_bits(run.output(f"{name}_seen")[scenario]) == in_bits(expected)


@pytest.mark.parametrize("first", [0, 1, 2, 63, 64, 65, 117, SAMPLES - 1, SAMPLES, SAMPLES + 9])
@pytest.mark.parametrize("count", [0, 1, 2, 5, 64, SAMPLES])
def test_any_stretch(seen, first, count):
    noise = InputNoise(11, 1.0, first, count)
    kernel = Kernel(seen, lanes=4)
    run = kernel.run(SAMPLES, inputs={"v": -0.0}, noise=BatchNoise({"v": noise}, 5, range(4)))
    for number in range(4):
        expected = added(np.full(SAMPLES, -0.0), noise, seed_of(5, number))
        assert in_bits(run.output("v_seen")[number]) == in_bits(expected)
    assert not run.output("u_seen").any()


@pytest.mark.parametrize("record", [True, False])
def test_the_far_ends_of_the_distribution(record):
    """The largest sums of 3,000 scenarios, by kernels that store their inputs or add them up."""
    law = step_law(
        "largest",
        inputs=[Signal("u")],
        parameters=[],
        state=[Signal("total")],
        outputs=[Signal("u_seen")],
        equations=lambda s: Equations({"total": s["total"] + s["u"]}, {"u_seen": s["u"]}),
    )
    noise = BatchNoise({"u": InputNoise(3, 1.0, 0, 400)}, 9, np.arange(3000))
    run = Kernel(program_of(law), record=record).run(400, noise=noise)
    whole = np.array([white_noise(seed_of(9, number), 3, 0, 400) for number in range(3000)])
    assert np.max(np.abs(whole)) > 4.5
    total = np.zeros(3000)
    for sample in range(400):
        total += whole[:, sample]
    assert in_bits(run.state("total")) == in_bits(total)
    if record:
        assert in_bits(run.output("u_seen")) == in_bits(whole)


def same(found, expected):
    return all(
        in_bits(getattr(found, each)) == in_bits(getattr(expected, each))
        for each in ("record", "final_state", "held")
    )


@pytest.mark.parametrize("pace", [1, 5, 36, 64, 100])
@pytest.mark.parametrize("every", [1, 3, 100])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_run_in_parts(pace, every, threads, monkeypatch):
    """Calls that end anywhere in a chunk, and begin with an odd sample."""
    program = program_of(random_law(11))
    names = [signal.name for signal in program.inputs]
    kernel = Kernel(program, lanes=2)
    noise = BatchNoise(
        {names[0]: InputNoise(1, 0.5, 3, 150), names[2]: InputNoise(2, 0.1, 0, 1000)}, 4,
        range(7), 41,
    )  # fmt: skip
    whole = kernel.run(SAMPLES, noise=noise, every=every, threads=1)
    Counted.asked, Counted.calls = pace, 0
    monkeypatch.setattr("clepsydra.engine.job.Pacing", Counted)
    assert same(kernel.run(SAMPLES, noise=noise, every=every, threads=threads), whole)
    assert Counted.calls >= 8


def given_by_values(noise, scenarios, samples, seed):
    """Return individual inputs that are the noise."""
    return {
        name: [added(np.zeros(samples), each, seed_of(seed, number)) for number in range(scenarios)]
        for name, each in noise.items()
    }


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_a_program_takes_noise_as_it_takes_its_values(seed, large, monkeypatch):
    """In registers, and in memory where a large program is printed in parts."""
    if large:
        keep_nothing(monkeypatch)
        monkeypatch.setattr(vector_parts, "LARGEST_WHOLE", 0)
        monkeypatch.setattr(vector_parts, "LARGEST_PART", 5)
    program = program_of(random_law(seed))
    names = [signal.name for signal in program.inputs][:2]
    noise = {name: InputNoise(k, 0.5 + k, 9 * k, 120) for k, name in enumerate(names)}
    made = Kernel(program, lanes=8).run(
        SAMPLES, inputs=dict.fromkeys(names, 0.0), noise=BatchNoise(noise, 6, range(19))
    )
    values = given_by_values(noise, 19, SAMPLES, 6)
    given = Kernel(program, individual=names, lanes=8).run(SAMPLES, inputs=values)
    assert same(made, given)
    assert np.any(made.record_of(0) != made.record_of(1))


def test_one_number_is_the_same_noise_for_all(seen):
    noise = BatchNoise({"u": InputNoise(1, 2.0, 0, 9)}, 3, 8)
    run = Kernel(seen, lanes=4, individual=["v"]).run(
        9, inputs={"v": np.zeros((6, 9))}, noise=noise
    )
    expected = added(np.zeros(9), noise.inputs["u"], seed_of(3, 8))
    assert in_bits(run.output("u_seen")) == in_bits(np.tile(expected, (6, 1)))


@pytest.mark.parametrize("cut", [1, 30, 64, 101])
@pytest.mark.parametrize("lanes", [1, 4, 8])
def test_a_run_in_two_pieces_is_the_whole(cut, lanes):
    """Each scenario goes on with its own content of every ring, of the state and of loops."""
    program, random = ring_program(7), np.random.default_rng(2)
    kernel = Kernel(program, lanes=lanes)
    u, parameters = random.normal(size=SAMPLES), {"gain": random.uniform(0.1, 0.4, 11)}
    start = {"x": random.normal(size=11)}

    def run(first, last, **stood):
        noise = BatchNoise({"u": InputNoise(1, 0.3, 20, 170)}, 2, np.arange(11), first)
        return kernel.run(
            last - first, inputs={"u": u[first:last]}, parameters=parameters, noise=noise, **stood
        )

    whole = run(0, SAMPLES, state=start)
    one = run(0, cut, state=start)
    other = run(cut, SAMPLES, state={"x": one.state("x")}, rings=one.rings())
    assert in_bits(other.state("x")) == in_bits(whole.state("x"))
    for name, content in whole.rings().items():
        assert in_bits(other.rings()[name]) == in_bits(content)
        assert np.ptp(content, axis=0).all()
    for name in ("out", "x_now"):
        both = np.concatenate([one.output(name), other.output(name)], axis=1)
        assert in_bits(both) == in_bits(whole.output(name))


def test_rings_of_scenarios_say_how_many_there_are():
    kernel = Kernel(ring_program(7), lanes=4)
    content = np.arange(15.0).reshape(5, 3)
    run = kernel.run(1, rings={"pipe": content})
    assert run.scenarios == 5
    assert run.rings()["pipe"][:, :2].tolist() == content[:, 1:].tolist()
    with refused(value=[3, 5]):
        kernel.run(1, rings={"pipe": content}, parameters={"gain": np.ones(3)})
    with refused(place="pipe", value=[5, 2]):
        kernel.run(1, rings={"pipe": content[:, :2]})


def test_a_run_without_noise_is_what_it_was(seen):
    """Noise of no input needs no other machine code."""
    kernel = Kernel(seen, lanes=2)
    quiet = kernel.run(5, inputs={"u": 1.0})
    assert same(kernel.run(5, inputs={"u": 1.0}, noise=BatchNoise({}, 1)), quiet)
    SteppedKernel(Kernel(seen)).step({"u": 1.0})


@pytest.mark.parametrize(
    ("changed", "place", "value"),
    [
        ({"seed": -1}, "seed", -1),
        ({"seed": 2**32}, "seed", 2**32),
        ({"seed": 1.5}, "seed", 1.5),
        ({"numbers": [0, -3]}, "number of a scenario", -3),
        ({"numbers": [2**32 + 5, 1]}, "number of a scenario", 2**32 + 5),
        ({"numbers": 0.5}, "numbers", 0.5),
        ({"numbers": []}, "run of seen", [0]),
        ({"sample": -1}, "first sample", -1),
        ({"sample": 2**62}, "first sample", 2**62),
        ({"inputs": {"level": InputNoise(1, 1.0, 0, 5)}}, "seen", "level"),
        ({"inputs": {"u": InputNoise(2**32, 1.0, 0, 5)}}, "u", 2**32),
        ({"inputs": {"u": InputNoise(1, 1.0, -1, 5)}}, "u", -1),
        ({"inputs": {"u": InputNoise(1, 1.0, 0, -5)}}, "u", -5),
        ({"inputs": {"u": InputNoise(1, np.inf, 0, 5)}}, "u", np.inf),
    ],
)
def test_what_is_no_noise_is_refused(seen, changed, place, value):
    given = {"inputs": {"u": InputNoise(1, 1.0, 0, 5)}, "seed": 1, **changed}
    with refused(place=place, value=value):
        Kernel(seen).run(5, noise=BatchNoise(**given))


def test_numbers_of_more_scenarios_than_there_are_are_refused(seen):
    noise = BatchNoise({"u": InputNoise(1, 1.0, 0, 5)}, 1, range(4))
    with refused(place="run of seen", value=[3, 4]):
        Kernel(seen, individual=["v"]).run(5, inputs={"v": np.zeros((3, 5))}, noise=noise)
