"""Kernels: what goes in, what comes out, and what is refused."""

import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError, Kernel, Signal, program_of
from clepsydra.engine.host import host
from clepsydra.engine.threads import available_threads, in_threads, threads_at_most
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program
from clepsydra.program.step_law import Equations, step_law


def adder(individual=(), **options) -> Kernel:
    """A running sum: x⁺ = x + gain·u + v, with outputs x and gain·u."""
    law = step_law(
        "adder",
        inputs=[Signal("u", initial=1.0), Signal("v", initial=0.5)],
        parameters=[Signal("gain", initial=2.0)],
        state=[Signal("x", initial=10.0)],
        outputs=[Signal("now"), Signal("moved")],
        equations=lambda s: Equations(
            {"x": s["x"] + s["gain"] * s["u"] + s["v"]},
            {"now": s["x"], "moved": s["gain"] * s["u"]},
        ),
    )
    return Kernel(program_of(law), individual=individual, **options)


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return adder()


def test_what_is_left_out_keeps_its_initial_value(kernel):
    run = kernel.run(4)
    assert run.output("now").tolist() == [[10.0, 12.5, 15.0, 17.5]]
    assert run.output("moved").tolist() == [[2.0] * 4]
    assert run.state("x").tolist() == [20.0]


def test_shapes_of_one_run(kernel):
    run = kernel.run(5)
    assert run.scenarios == 1
    assert run.output("now").shape == (1, 5)
    assert run.record_of(0).shape == (5, 2)
    assert run.state("x").shape == (1,)
    assert run.final_state.shape == (1, 1)


#: Lanes of this program's batches here.
LANES = adder().prepare(1, parameters={"gain": [1.0, 2.0]}).lanes


def test_one_scenario_takes_one_lane_and_more_fill_groups(kernel):
    assert LANES > 1
    assert kernel.prepare(1).lanes == 1
    for scenarios, groups in [(2, 1), (LANES, 1), (LANES + 1, 2)]:
        job = kernel.prepare(3, parameters={"gain": np.ones(scenarios)})
        assert (job.scenarios, job.samples, job.lanes) == (scenarios, 3, LANES)
        assert job.initial.shape == job.parameters.shape == (groups, 1, LANES)
        assert job.shared.shape == (3, 2) and job.individual.shape == (groups, 3, 0, LANES)


@pytest.mark.parametrize("scenarios", [1, 2, LANES - 1, LANES, LANES + 1, 3 * LANES + 2])
@pytest.mark.parametrize("threads", [1, 2])
def test_every_number_of_scenarios_gives_each_its_own_sum(kernel, scenarios, threads):
    """Whole numbers and halves are exact, so the closed form holds to the last bit."""
    samples = 7
    gain, start = np.arange(scenarios) + 1.0, -2.0 * np.arange(scenarios)
    u, v = np.arange(samples) - 3.0, 0.25
    run = kernel.run(
        samples,
        inputs={"u": u, "v": v},
        parameters={"gain": gain},
        state={"x": start},
        threads=threads,
    )
    k = np.arange(samples + 1)
    total = start[:, None] + gain[:, None] * (k * (k - 1) / 2 - 3 * k) + 0.25 * k
    assert run.scenarios == scenarios
    assert np.array_equal(run.output("now"), total[:, :-1])
    assert np.array_equal(run.state("x"), total[:, -1])
    assert np.array_equal(run.output("moved"), gain[:, None] * u)
    for scenario in (0, scenarios - 1):
        columns = np.column_stack([total[scenario, :-1], gain[scenario] * u])
        assert np.array_equal(run.record_of(scenario), columns)


@pytest.mark.parametrize("every", [1, 2, 3, 6, 7, 100])
@pytest.mark.parametrize("scenarios", [1, LANES + 1])
def test_every_stores_the_first_sample_and_each_so_many_later(kernel, every, scenarios):
    gain = np.linspace(1, 2, scenarios)
    run = kernel.run(7, parameters={"gain": gain}, every=every)
    whole = kernel.run(7, parameters={"gain": gain})
    assert run.output("now").shape == (scenarios, math.ceil(7 / every))
    assert np.array_equal(run.output("now"), whole.output("now")[:, ::every])
    assert np.array_equal(run.final_state, whole.final_state)


@pytest.mark.parametrize("scenarios", [1, LANES + 1])
def test_without_a_record_the_final_state_is_the_same(kernel, scenarios):
    given = {"gain": np.linspace(1, 2, scenarios)}
    bare = adder(record=False).run(9, parameters=given)
    assert bare.record.size == 0
    assert np.array_equal(bare.final_state, kernel.run(9, parameters=given).final_state)


def test_a_laid_out_job_can_be_started_often(kernel):
    job = kernel.prepare(6, parameters={"gain": np.array([1.0, 3.0])})
    first, second = job.run(), job.run(threads=2)
    assert np.array_equal(first.record_of(1), second.record_of(1))
    assert np.array_equal(first.final_state, second.final_state)
    assert first.state("x").tolist() == [10 + 6 * 1.5, 10 + 6 * 3.5]


@pytest.mark.parametrize("lanes", [1, 2, 3, 8])
def test_any_number_of_lanes_computes_the_same(kernel, lanes):
    gain = np.linspace(-1, 1, 11)
    other = adder(lanes=lanes).run(5, parameters={"gain": gain})
    assert np.array_equal(
        other.output("now"), kernel.run(5, parameters={"gain": gain}).output("now")
    )


def test_individual_inputs_belong_to_one_scenario_each():
    scenarios, samples = LANES + 2, 4
    u = np.arange(scenarios * samples, dtype=float).reshape(scenarios, samples)
    run = adder(individual=["u"]).run(samples, inputs={"u": u, "v": 0.0})
    assert np.array_equal(run.output("moved"), 2.0 * u)
    assert np.array_equal(run.state("x"), 10.0 + 2.0 * u.sum(axis=1))
    alone = adder(individual=["u"]).run(samples, inputs={"u": u[3:4], "v": 0.0})
    assert np.array_equal(alone.output("moved"), 2.0 * u[3:4])


def test_an_individual_input_that_is_left_out_keeps_its_initial_value():
    run = adder(individual=["u"]).run(3, parameters={"gain": np.array([1.0, 4.0])})
    assert run.output("moved").tolist() == [[1.0] * 3, [4.0] * 3]


@pytest.mark.parametrize("scenarios", [1, LANES + 1])
def test_a_program_without_parameters_and_inputs_runs(scenarios):
    law = step_law(
        "clock",
        inputs=[],
        parameters=[],
        state=[Signal("time", initial=3.0)],
        outputs=[Signal("doubled")],
        equations=lambda s: Equations({"time": s["time"] + 1}, {"doubled": 2 * s["time"]}),
    )
    start = np.arange(scenarios, dtype=float)
    run = Kernel(program_of(law)).run(3, state={"time": start})
    assert np.array_equal(run.output("doubled"), 2 * (start[:, None] + np.arange(3)))


@pytest.mark.parametrize("scenarios", [1, LANES + 1])
def test_a_program_without_state_runs(scenarios):
    law = step_law(
        "doubler",
        inputs=[Signal("u")],
        parameters=[Signal("gain")],
        state=[],
        outputs=[Signal("y")],
        equations=lambda s: Equations({}, {"y": s["gain"] * s["u"]}),
    )
    gain = np.arange(scenarios) + 2.0
    run = Kernel(program_of(law)).run(3, inputs={"u": [1, 2, 3]}, parameters={"gain": gain})
    assert np.array_equal(run.output("y"), gain[:, None] * np.array([1.0, 2.0, 3.0]))


@pytest.mark.parametrize("scenarios", [1, LANES + 1])
def test_a_ring_begins_filled_with_its_own_initial_value(scenarios):
    law = step_law(
        "pipe",
        inputs=[Signal("u")],
        parameters=[],
        state=[DelayRing(Signal("pipe", initial=7.0), 3)],
        outputs=[Signal("old")],
        equations=lambda s: Equations({"pipe": s["u"]}, {"old": s["pipe"]}),
    )
    kernel = Kernel(program_of(law))
    u = np.array([1.0, 2.0, 3.0, 4.0])
    assert kernel.run(4, inputs={"u": u}).output("old").tolist() == [[7.0, 7.0, 7.0, 1.0]]
    start = np.arange(scenarios) - 5.0
    run = kernel.run(4, inputs={"u": u}, state={"pipe": start})
    assert np.array_equal(run.output("old")[:, :3], np.repeat(start[:, None], 3, axis=1))
    assert np.all(run.output("old")[:, 3] == 1.0)


SPECIAL = [0.0, -0.0, 1.0, -1.0, 1e300, 2e300, math.inf, -math.inf, math.nan]


def same(got: np.ndarray, expected: list[float]) -> bool:
    """Return whether bits are equal, the sign of zero included, all not-a-numbers alike."""
    expected = np.array(expected)
    equal = np.ascontiguousarray(got).view(np.int64) == expected.view(np.int64)
    return bool(np.all(equal | (np.isnan(got) & np.isnan(expected))))


@pytest.mark.parametrize("shared", [True, False])
def test_maximum_minimum_and_select_on_every_pair(shared):
    """Once as inputs in the time loop of one run, once as parameters of a batch."""
    outputs = ("maximum", "minimum", "select", "bad")
    law = step_law(
        "pairs",
        inputs=[Signal("a"), Signal("b")] if shared else [],
        parameters=[] if shared else [Signal("a"), Signal("b")],
        state=[Signal("unused")],
        outputs=[Signal(name) for name in outputs],
        equations=lambda s: Equations(
            {"unused": s["unused"]},
            {
                "maximum": ca.fmax(s["a"], s["b"]),
                "minimum": ca.fmin(s["a"], s["b"]),
                "select": ca.if_else(s["a"] <= s["b"], s["a"], s["b"]),
                "bad": ca.logic_not(ca.fabs(s["a"]) <= 1e300),
            },
        ),
    )
    a, b = np.repeat(SPECIAL, len(SPECIAL)), np.tile(SPECIAL, len(SPECIAL))
    kernel = Kernel(program_of(law), fuse=False)
    if shared:
        run = kernel.run(len(a), inputs={"a": a, "b": b})
        got = {name: run.output(name)[0] for name in outputs}
    else:
        run = kernel.run(1, parameters={"a": a, "b": b})
        got = {name: run.output(name)[:, 0] for name in outputs}
    pairs = list(zip(a.tolist(), b.tolist(), strict=True))
    assert same(got["maximum"], [p if p > q else q for p, q in pairs])
    assert same(got["minimum"], [p if p < q else q for p, q in pairs])
    assert same(got["select"], [p if p <= q else q for p, q in pairs])
    assert same(got["bad"], [float(math.isnan(p) or abs(p) > 1e300) for p, _ in pairs])


def product_sum(fused_product: bool, fused_sum: bool) -> Program:
    builder = BlockBuilder(4)
    product = builder.operation("multiply", 1, 2, fused=fused_product)
    block = builder.finish([0, builder.operation("add", product, 3, fused=fused_sum)])
    inputs = tuple(Signal(name) for name in "abc")
    return Program("product_sum", (Signal("x"),), inputs, (), (Signal("y"),), block)


def test_only_marked_operations_are_fused_and_then_with_one_rounding():
    random = np.random.default_rng(1)
    a, b = random.normal(size=(2, 200))
    c = -a * b * (1 + random.choice([0, 1e-16, -1e-16, 1e-9], size=200))
    inputs = {"a": a, "b": b, "c": c}
    once = [float(Fraction(x) * Fraction(y) + Fraction(z)) for x, y, z in zip(a, b, c, strict=True)]
    assert np.count_nonzero(np.array(once) != a * b + c) > 100

    def run(fuse: bool, *marks: bool) -> np.ndarray:
        return Kernel(product_sum(*marks), fuse=fuse).run(200, inputs=inputs).output("y")[0]

    assert np.array_equal(run(True, False, False), a * b + c)
    assert np.array_equal(run(False, True, True), a * b + c)
    assert np.array_equal(run(True, True, True), once if host().fuses else a * b + c)


@pytest.mark.parametrize("group", ["inputs", "parameters", "state"])
def test_an_unknown_name_is_refused_with_the_known_ones(kernel, group):
    known = {"inputs": ["u", "v"], "parameters": ["gain"], "state": ["x"]}[group]
    with pytest.raises(InputError) as refusal:
        kernel.run(3, **{group: {"gian": 1.0}})
    message = str(refusal.value)
    assert message.startswith("run of adder")
    assert "'gian'" in message
    assert all(name in message.split("gian", 1)[1] for name in known)


@pytest.mark.parametrize(
    ("given", "place", "shape"),
    [
        ({"inputs": {"u": np.ones(4)}}, "u", "[4]"),
        ({"inputs": {"u": np.ones(6)}}, "u", "[6]"),
        ({"inputs": {"v": np.ones((2, 5))}}, "v", "[2, 5]"),
        ({"parameters": {"gain": np.ones((2, 2))}}, "gain", "[2, 2]"),
        ({"state": {"x": np.ones((1, 5))}}, "x", "[1, 5]"),
    ],
)
def test_a_shape_that_does_not_fit_is_refused(kernel, given, place, shape):
    with pytest.raises(InputError) as refusal:
        kernel.run(5, **given)
    message = str(refusal.value)
    assert message.startswith(f"run of adder, {place}: got ")
    assert shape in message.split(", expected")[0]


@pytest.mark.parametrize("shape", [(5,), (3, 4), (2, 6), (3, 5, 1), ()])
def test_an_individual_input_of_another_shape_is_refused(shape):
    with refused(place="adder"):
        adder(individual=["u"]).run(
            5, inputs={"u": np.ones(shape)}, parameters={"gain": np.ones(3)}
        )


def test_numbers_of_scenarios_that_differ_are_refused(kernel):
    with pytest.raises(InputError) as refusal:
        kernel.run(5, parameters={"gain": np.ones(3)}, state={"x": np.ones(4)})
    message = str(refusal.value)
    assert message.startswith("run of adder: got ")
    assert "gain" in message and "x" in message and "3" in message and "4" in message


@pytest.mark.parametrize("given", [{"samples": 0}, {"samples": -2}, {"samples": 3, "every": 0}])
def test_no_sample_at_all_is_refused(kernel, given):
    with refused(place="run of adder", expected="at least 1"):
        kernel.run(**given)


def test_an_unknown_output_or_state_is_not_answered(kernel):
    run = kernel.run(2)
    with refused(expected="an output that was stored"):
        run.output("x")
    with refused(expected="one of its states"):
        run.state("now")


@pytest.mark.parametrize("count", [1, 2, 7, 64, 65])
@pytest.mark.parametrize("threads", [1, 2, 5, 100])
def test_threads_cover_every_item_once(count, threads):
    seen = np.zeros(count, dtype=int)

    def work(start: int, stop: int) -> Iterator[None]:
        assert 0 <= start < stop <= count
        for item in range(start, stop):
            seen[item] += 1
            yield

    in_threads(work, count, threads)
    assert np.all(seen == 1)


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_on_a_thread_reaches_the_caller(threads):
    def work(start: int, stop: int) -> Iterator[None]:
        yield
        raise ArithmeticError(start)

    with pytest.raises(ArithmeticError):
        in_threads(work, 10, threads)


def test_there_is_at_least_one_thread():
    assert available_threads() >= 1


def test_threads_are_bounded_where_that_is_asked_for_and_no_further():
    before = available_threads()
    with threads_at_most(1):
        assert available_threads() == 1
        with ThreadPoolExecutor(1) as pool:  # others have their own bound
            assert pool.submit(available_threads).result() == before
        with threads_at_most(1000):
            assert available_threads() == before
    assert available_threads() == before
