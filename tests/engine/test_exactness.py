"""The engine's first test: a kernel without fused operations is CasADi, bit for bit.

exp, sin and others are the engine's own: see test_elementary_functions.
"""

import casadi as ca
import numpy as np
import pytest
from random_laws import evaluate, random_law

from clepsydra import Kernel, Signal, program_of
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, step_law

SAMPLES = 50


def same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    """Every bit equal; any not-a-number equals any other, and zeros may differ in sign."""
    a, b = np.ascontiguousarray(a) + 0.0, np.ascontiguousarray(b) + 0.0
    equal = a.view(np.int64) == b.view(np.int64)
    return bool(np.all(equal | (np.isnan(a) & np.isnan(b))))


def stimulus(seed: int, scenarios: int):
    random = np.random.default_rng(1000 + seed)
    inputs = random.normal(size=(SAMPLES, 3)) * 3
    parameters = random.normal(size=(3, scenarios))
    return inputs, parameters


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(40))
def test_one_run_equals_casadi_bit_for_bit(seed):
    law = random_law(seed)
    inputs, parameters = stimulus(seed, 1)
    kernel = Kernel(program_of(law), fuse=False)
    run = kernel.run(
        SAMPLES,
        inputs={f"u{i}": inputs[:, i] for i in range(3)},
        parameters={f"p{i}": parameters[i, 0] for i in range(3)},
    )
    start = np.array([signal.initial for signal in law.state])
    outputs, final = evaluate(law, inputs, parameters[:, 0], start)
    for i in range(6):
        assert same_bits(run.output(f"y{i}")[0], outputs[:, i]), f"y{i}"
    assert same_bits(run.final_state[:, 0], final)


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("fuse", [False, True])
def test_every_lane_equals_its_own_run_bit_for_bit(seed, fuse):
    """37 scenarios fill some lane groups and leave one partly empty."""
    scenarios = 37
    law = random_law(100 + seed, printed=True)
    inputs, parameters = stimulus(seed, scenarios)
    kernel = Kernel(program_of(law), fuse=fuse)
    given = {f"u{i}": inputs[:, i] for i in range(3)}
    batch = kernel.run(
        SAMPLES, inputs=given, parameters={f"p{i}": parameters[i] for i in range(3)}, threads=2
    )
    for scenario in range(scenarios):
        one = kernel.run(
            SAMPLES, inputs=given, parameters={f"p{i}": parameters[i, scenario] for i in range(3)}
        )
        for i in range(6):
            assert same_bits(batch.output(f"y{i}")[scenario], one.output(f"y{i}")[0])


def test_individual_inputs_reach_their_own_scenario():
    law = random_law(7)
    scenarios = 21
    inputs, parameters = stimulus(7, 1)
    own = np.random.default_rng(5).normal(size=(scenarios, SAMPLES))
    values = {f"p{i}": parameters[i, 0] for i in range(3)}
    kernel = Kernel(program_of(law), individual=["u1"], fuse=False)
    batch = kernel.run(
        SAMPLES, inputs={"u0": inputs[:, 0], "u1": own, "u2": inputs[:, 2]}, parameters=values
    )
    start = np.array([signal.initial for signal in law.state])
    for scenario in range(scenarios):
        mixed = np.column_stack([inputs[:, 0], own[scenario], inputs[:, 2]])
        outputs, _ = evaluate(law, mixed, parameters[:, 0], start)
        assert same_bits(batch.output("y0")[scenario], outputs[:, 0])


def looped_law(count: int):
    """A polynomial by Horner's rule and a weighted sum, both in one counted loop."""
    coefficients = np.random.default_rng(3).normal(size=count)
    weights = np.random.default_rng(4).normal(size=count)
    row, carried, constant = ca.SX.sym("row", 2), ca.SX.sym("c", 2), ca.SX.sym("v", 2)
    body = ca.Function(
        "turn",
        [row, carried, constant],
        [
            ca.vertcat(
                carried[0] * constant[0] + row[0],
                carried[1] + row[1] * ca.fmax(constant[1], carried[0] / (1 + carried[0] ** 2)),
            )
        ],
    )

    def equations(s):
        both = counted_loop(
            "horner",
            count,
            body,
            carried=ca.vertcat(0, s["x"]),
            tables=[coefficients, weights],
            invariants=ca.vertcat(s["u"] / 4, s["p"]),
        )
        return Equations({"x": both[1] / count}, {"polynomial": both[0], "sum": both[1]})

    return step_law(
        "looped",
        inputs=[Signal("u")],
        parameters=[Signal("p")],
        state=[Signal("x")],
        outputs=[Signal("polynomial"), Signal("sum")],
        equations=equations,
    )


@pytest.mark.parametrize("scenarios", [1, 19])
def test_a_counted_loop_stays_a_loop_and_equals_casadi(scenarios):
    law = looped_law(101)
    program = program_of(law)
    assert len(program.block.statements) < 20
    assert len(list(program.block.operations())) < 40
    u = np.random.default_rng(1).normal(size=(SAMPLES, 1))
    p = np.linspace(-1, 1, scenarios)
    run = Kernel(program, fuse=False).run(SAMPLES, inputs={"u": u[:, 0]}, parameters={"p": p})
    for scenario in range(scenarios):
        outputs, _ = evaluate(law, u, p[scenario : scenario + 1], np.zeros(1))
        assert same_bits(run.output("polynomial")[scenario], outputs[:, 0])
        assert same_bits(run.output("sum")[scenario], outputs[:, 1])


@pytest.mark.parametrize("length", [1, 2, 7, 50, 80])
@pytest.mark.parametrize("scenarios", [1, 19])
def test_a_delay_ring_returns_what_was_written_length_samples_ago(length, scenarios):
    law = step_law(
        "delayed",
        inputs=[Signal("u")],
        parameters=[Signal("gain")],
        state=[DelayRing(Signal("pipe", initial=-3.0), length), DelayRing(Signal("short"), 2)],
        outputs=[Signal("old"), Signal("older")],
        equations=lambda s: Equations(
            {"pipe": s["gain"] * s["u"], "short": s["pipe"]},
            {"old": s["pipe"], "older": s["short"]},
        ),
    )
    u = np.random.default_rng(2).normal(size=SAMPLES)
    gain = np.linspace(1, 2, scenarios)
    run = Kernel(program_of(law)).run(SAMPLES, inputs={"u": u}, parameters={"gain": gain})
    for scenario in range(scenarios):
        written = np.concatenate([np.full(length, -3.0), gain[scenario] * u])[:SAMPLES]
        assert same_bits(run.output("old")[scenario], written)
        assert same_bits(run.output("older")[scenario][2:], written[:-2])


def test_records_can_be_thinned_out():
    law = random_law(11)
    inputs, _ = stimulus(11, 1)
    kernel = Kernel(program_of(law))
    given = {f"u{i}": inputs[:, i] for i in range(3)}
    all_samples = kernel.run(SAMPLES, inputs=given, parameters={"p0": np.ones(5)})
    thinned = kernel.run(SAMPLES, inputs=given, parameters={"p0": np.ones(5)}, every=7)
    assert same_bits(thinned.output("y2"), all_samples.output("y2")[:, ::7])
    assert same_bits(thinned.final_state, all_samples.final_state)


def test_fusing_changes_only_what_is_marked():
    """A law is never fused: only values that are marked so may be computed with one rounding."""
    law = random_law(13)
    inputs, _ = stimulus(13, 1)
    given = {f"u{i}": inputs[:, i] for i in range(3)}
    fused = Kernel(program_of(law), fuse=True).run(SAMPLES, inputs=given)
    plain = Kernel(program_of(law), fuse=False).run(SAMPLES, inputs=given)
    assert same_bits(fused.output("y0"), plain.output("y0"))
