"""A sample without its unlikely branches gives every bit that all of it gives."""

import re
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from patched_printers import keep_nothing
from random_laws import evaluate

import clepsydra as cl
from clepsydra import Kernel, Signal, program_of
from clepsydra.engine.host import host
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.likely_path import likely_path
from clepsydra.engine.vector_code import vector_code
from clepsydra.engine.vector_text import bits as bits_of
from clepsydra.program.operation import Operation
from clepsydra.program.step_law import Equations, step_law

TANKS = 3
STATES = "x", "kept", "last"
#: Some as they were (0.5), some that change, one that is zero of another sign, and no numbers.
GAINS = 0.5, 0.5, 0.3, 0.0, -0.0, 0.5, 0.5, 0.5, np.nan, np.inf


def draining() -> object:
    """Levels that drain by a root, near their floors by another law, and are filled by what is
    known, which a gain shifts when it changes."""

    def equations(s):
        following, flows = {}, {}
        for k in range(TANKS):
            x, low, given = s[f"x{k}"], s["low"], s[f"u{k}"]
            small = ca.fmax(x, 0) / low
            laminar = small * (1.5 - 0.5 * small * small) * (1 + 0.1 * small * (1 - small))
            root = ca.if_else(x < low, ca.sqrt(low) * laminar, ca.sqrt(ca.fmax(x, low)))
            number = ca.fabs(given) <= 1e300
            filled = ca.if_else(number, given, s[f"kept{k}"])
            gain, last = s["gain"], s[f"last{k}"]
            shift = ca.if_else(gain != last, ca.exp(-x * x) * (gain - last), 0.0)
            following |= {f"x{k}": x + 0.1 * (filled - root) + shift, f"kept{k}": filled}
            following[f"last{k}"] = ca.if_else(ca.fabs(gain) <= 1e300, gain, last)
            flows[f"flow{k}"] = root
        return Equations(following, flows)

    each = range(TANKS)
    return step_law(
        "draining",
        inputs=[Signal(f"u{k}") for k in each],
        parameters=[Signal("low", initial=0.01), Signal("gain", initial=0.5)],
        state=[Signal(f"{name}{k}", initial=0.5) for name in STATES for k in each],
        outputs=[Signal(f"flow{k}") for k in each],
        equations=equations,
    )


LAW = draining()


def stimulus(samples, scenarios, seed=3):
    """Inputs that empty a level now and then, or are no number for a while; so are some starts."""
    random = np.random.default_rng(seed)
    shape = (TANKS, scenarios, samples // 50, 1)
    given = [0.0, np.nan, np.inf, -1e300, 2e300, 0.02, 0.3, 0.9]
    likely = [0.02, 0.003, 0.001, 0.0002, 0.0008, 0.005, 0.48, 0.49]
    inputs = random.choice(given, size=shape, p=likely)
    inputs = np.broadcast_to(inputs, (*shape[:3], 50)).reshape(TANKS, scenarios, -1)
    starts = random.choice([0.0, 0.01, 0.5], size=(TANKS, scenarios), p=[0.05, 0.05, 0.9])
    starts[:, ~np.isfinite(np.resize(GAINS, scenarios))] = 0.5
    for k in range(TANKS if scenarios > TANKS else 0):
        starts[k, scenarios - 1 - k] = np.nan
    return inputs, starts


def run(samples, scenarios, lanes=None, fuse=True, threads=None):
    names = [f"u{k}" for k in range(TANKS)]
    inputs, starts = stimulus(samples, scenarios)
    kernel = Kernel(program_of(LAW), individual=names, lanes=lanes, fuse=fuse)
    gains = np.resize(GAINS, scenarios)
    lasts = np.where(np.isfinite(gains), np.array([[0.5], [-0.0], [0.25]]), gains)
    state = {f"x{k}": starts[k] for k in range(TANKS)}
    state |= {f"last{k}": lasts[k] for k in range(TANKS)}
    parameters = {"gain": gains}
    inputs = dict(zip(names, inputs, strict=True))
    return kernel.run(samples, inputs=inputs, state=state, parameters=parameters, threads=threads)


def bits(found):
    values = [*(found.output(f"flow{k}") for k in range(TANKS)), found.final_state]
    return [np.where(np.isnan(each), np.nan, each).view(np.int64) for each in values]


def assert_same_bits(one, other):
    for each, its in zip(bits(one), bits(other), strict=True):
        np.testing.assert_array_equal(each, its)


@pytest.fixture
def without(monkeypatch):
    """Return a function that runs what has no likely path."""

    def plain(*arguments, **options):
        with monkeypatch.context() as patched:
            keep_nothing(patched)
            patched.setattr("clepsydra.engine.likely_path._FEWEST", 10**9)
            return run(*arguments, **options)

    return plain


def test_its_law_has_a_likely_path_and_leaves_it():
    code = vector_code(program_of(LAW), KernelForm(4, processor=replace(host(), refines=False)))
    # A declaration, the root of `low`, and those of the tanks twice.
    assert "\nlikely:" in code and code.count("sqrt.v4f64(") == 2 + 2 * TANKS
    assert "\nlikely:" not in vector_code(program_of(LAW), KernelForm(4))
    refined = vector_code(program_of(LAW), KernelForm(8, processor=replace(host(), refines=True)))
    assert "rsqrt14" in refined and "rsqrt14" not in code
    found = run(2_000, 12, lanes=8)
    flows = np.stack([found.output(f"flow{k}")[:8] for k in range(TANKS)])
    usual = np.all(flows > 0.1, axis=0)  # above the root of `low`, each tank of a lane
    # Each lane of the group leaves it, at another time than others, and the group comes back.
    assert not usual.all(axis=1).any() and 0.2 < np.mean(usual.all(axis=0)) < 0.8
    assert np.sum(np.diff(usual.all(axis=0).astype(int)) == 1) > 5


@pytest.mark.parametrize("lanes", [1, 4, 8, 16])
@pytest.mark.parametrize("fuse", [False, True])
def test_every_bit_is_that_of_all_statements(lanes, fuse, without):
    options = {"lanes": lanes, "fuse": fuse}
    assert_same_bits(run(5_000, 19, **options), without(5_000, 19, **options))


@pytest.mark.thorough
def test_a_million_samples_have_the_same_bits_in_any_lanes_on_any_threads(without):
    whole = without(20_000, 51)
    for lanes in (1, 2, 4, 8, 16):
        for threads in (1, 2):
            assert_same_bits(run(20_000, 51, lanes, threads=threads), whole)


def test_one_run_is_casadi_bit_for_bit():
    found, (inputs, starts) = run(1_000, 1, lanes=1, fuse=False), stimulus(1_000, 1)
    start = np.array([*starts[:, 0], *[0.5] * TANKS, 0.5, -0.0, 0.25])
    outputs, final = evaluate(LAW, inputs[:, 0].T, np.array([0.01, GAINS[0]]), start)
    for k in range(TANKS):
        np.testing.assert_array_equal(found.output(f"flow{k}")[0], outputs[:, k])
    np.testing.assert_array_equal(found.final_state[:, 0], final)


@pytest.mark.parametrize("lanes", [1, 8])
@pytest.mark.parametrize(
    ("low", "level", "given"),
    [
        pytest.param(-1e301, -1.5e300, 2e300, id="a level outweighs what is no number"),
        pytest.param(1e-310, 1e-308, 0.0, id="a root near zero has no digits left"),
    ],
)
def test_a_bound_that_would_hide_something_is_no_likely_path(
    low, level, given, lanes, without, monkeypatch
):
    def bounded():
        kernel = Kernel(program_of(LAW), lanes=lanes)
        state = {"x0": level, "x1": min(abs(level), 1.0), "x2": min(abs(level), 1.0)}
        return kernel.run(40, inputs={"u0": given}, state=state, parameters={"low": low})

    monkeypatch.setitem(globals(), "run", bounded)
    assert_same_bits(bounded(), without())


def by_arguments(each):
    return each.arguments


def test_what_saves_little_has_no_likely_path():
    statements = [
        Operation(2, "less", (0, 1)), Operation(3, "maximum", (0, 1)),
        Operation(4, "multiply", (0, 0)), Operation(5, "select", (2, 4, 3)),
    ]  # fmt: skip
    assert likely_path(statements, {}, {0, 1}, {}, [5], by_arguments) == ()


def test_what_nobody_reads_makes_no_likely_path():
    unread = [Operation(k, "multiply", (k - 1, 0)) for k in range(2, 40)]
    condition = [Operation(40, "less", (0, 1)), Operation(41, "maximum", (0, 1))]
    chosen = Operation(42, "select", (40, 0, 41))
    for statements in ([*unread, chosen], [*unread, *condition, chosen]):
        assert likely_path(statements, {}, {0, 1}, {}, [42], by_arguments) == ()


def test_a_bound_that_moves_is_none_of_a_law():
    few = [Operation(k, "multiply", (k - 1, 0)) for k in range(4, 24)]
    statements = [
        Operation(2, "less", (0, 1)), Operation(3, "maximum", (0, 1)), *few,
        Operation(24, "select", (2, 23, 3)),
    ]  # fmt: skip
    assert likely_path(statements, {}, {1}, {}, [24], by_arguments)
    assert likely_path(statements, {}, {}, {}, [24], by_arguments) == ()


def test_only_a_magnitude_says_that_it_is_a_number():
    few = [Operation(k, "multiply", (k - 1, 0)) for k in range(4, 24)]
    statements = [
        Operation(2, "absolute", (0,)), Operation(3, "less_equal", (2, 1)), *few,
        Operation(24, "select", (3, 0, 23)),
    ]  # fmt: skip
    assert likely_path(statements, {1: 1e300}, {1}, {}, [24], by_arguments)
    statements[1] = Operation(3, "less_equal", (0, 1))
    assert likely_path(statements, {1: 1e300}, {1}, {}, [24], by_arguments) == ()


@pytest.mark.parametrize(("after", "usual"), [(25, True), (1, True), (24, False), (2, False)])
def test_a_setting_is_usually_what_it_was(after, usual):
    # Value 1 is held, 2 is of the state and becomes `after`.
    few = [Operation(k, "multiply", (k - 1, 0)) for k in range(4, 24)]
    statements = [
        Operation(3, "not_equal", (1, 2)), *few, Operation(24, "select", (3, 23, 0)),
        Operation(25, "select", (3, 1, 2)),
    ]  # fmt: skip
    path = likely_path(statements, {}, {1}, {2: after}, [24, 25], by_arguments)
    assert bool(path) == usual


def test_the_checks_of_a_law_for_numbers_are_known():
    law = cl.design.simc("quadruple-tank").law
    code = vector_code(program_of(law), KernelForm(4, processor=host()))
    begin = code.index("\nlikely:")
    path, whole = code[begin : code.index("\ngeneral:")], code[code.index("\ngeneral:") :]
    checks = re.compile(rf"fcmp ole .*{bits_of(1e300)}")
    assert len(checks.findall(path)) < len(checks.findall(whole)) // 2
