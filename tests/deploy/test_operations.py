"""Every operation, loop, delay and type in C and in Structured Text, against other routes."""

import math

import casadi as ca
import numpy as np
import pytest
from deployed import CompiledC, InterpretedText, all_bits, bits, run_both

from clepsydra import Kernel, Signal, program_of
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import EXACT, Operation
from clepsydra.program.program import Block, Program
from clepsydra.program.step_law import Equations, step_law

NASTY = [
    0.0, -0.0, 1.0, -1.0, 0.5, -0.3, 0.1, 2.5, -2.5, 5e-324, -5e-324, 2.0**-1022, 1e22, 1e300,
    -1e300, 2.0**31 - 0.5, 2.0**31 + 0.5, -(2.0**31) - 0.5, 2.0**51 + 0.5, -(2.0**51) - 0.5,
    2.0**52 - 0.5, 2.0**52, 2.0**53, -(2.0**52) + 0.5, 1.7976931348623157e308,
    123456789.75, -123456789.25, math.nan, math.inf, -math.inf,
]  # fmt: skip

NUMBERS = {
    "add": np.add,
    "subtract": np.subtract,
    "multiply": np.multiply,
    "divide": np.divide,
    "minimum": lambda a, b: np.where(a < b, a, b),
    "maximum": lambda a, b: np.where(a > b, a, b),
    "negate": lambda a, b: np.negative(a),
    "square_root": lambda a, b: np.sqrt(a),
    "absolute": lambda a, b: np.abs(a),
    "floor": lambda a, b: np.floor(a),
    "ceiling": lambda a, b: np.ceil(a),
    "select": lambda a, b: np.where(b < a, a, b),
    "constant": lambda a, b: np.full_like(a, 0.1),
}
TRUTHS = {
    "less": np.less,
    "less_equal": np.less_equal,
    "equal": np.equal,
    "not_equal": np.not_equal,
    "truth": lambda a, b: a != 0.0,
    "not": lambda a, b: ~(b < a),
    "and": lambda a, b: (b < a) & (a != 0.0),
    "or": lambda a, b: (b < a) | (a != 0.0),
}


def program_of_block(block: Block, inputs: int, name: str = "block") -> Program:
    return Program(
        name,
        (),
        tuple(Signal(f"u{i}") for i in range(inputs)),
        (),
        tuple(Signal(f"y{i}") for i in range(len(block.results))),
        block,
    )


def every_operation() -> Block:
    """Each exact operation on two arguments; the truth values b < a and a != 0 serve the rest."""
    statements = [Operation(2, "less", (1, 0)), Operation(3, "truth", (0,))]
    operands = {"select": (2, 0, 1), "not": (2,), "and": (2, 3), "or": (2, 3), "constant": ()}
    results, truths = [], {2, 3}
    for code in [*NUMBERS, *TRUTHS]:
        one = code in ("negate", "square_root", "absolute", "floor", "ceiling", "truth")
        arguments = operands.get(code, (0,) if one else (0, 1))
        target = len(statements) + 2
        statements.append(Operation(target, code, arguments, 0.1))
        if code in TRUTHS:
            truths.add(target)
            statements.append(Operation(target + 1, "number", (target,)))
            target += 1
        results.append(target)
    return Block(2, tuple(statements), tuple(results), frozenset(truths))


def test_every_exact_operation_on_nasty_numbers(tmp_path):
    assert {*NUMBERS, *TRUTHS, "number"} == EXACT
    a, b = (grid.ravel() for grid in np.meshgrid(NASTY, NASTY))
    with np.errstate(all="ignore"):
        expected = np.column_stack([f(a, b) for f in [*NUMBERS.values(), *TRUTHS.values()]])
    found = run_both(program_of_block(every_operation(), 2), tmp_path, {"u0": a, "u1": b})
    for table in found:
        assert np.array_equal(all_bits(table), all_bits(expected))


def test_constants_come_back_with_every_bit(tmp_path):
    random = np.random.default_rng(3)
    drawn = random.integers(-(2**63), 2**63 - 1, size=200, dtype=np.int64).view(np.float64)
    constants = [v for v in [*NASTY, *drawn.tolist()] if math.isfinite(v)]
    statements = tuple(Operation(1 + k, "constant", (), value) for k, value in enumerate(constants))
    block = Block(1, statements, tuple(range(1, 1 + len(constants))))
    program = program_of_block(block, 1)
    for instance in (CompiledC(program, tmp_path), InterpretedText(program)):
        assert list(map(bits, instance({"u0": 0.0}))) == list(map(bits, constants))


EXACT_UNARY = [
    lambda a: -a,
    lambda a: ca.sqrt(ca.fabs(a)),
    ca.fabs,
    ca.floor,
    ca.ceil,
    ca.sign,
    lambda a: a**2,
    lambda a: 2 * a,
    lambda a: 1 / a,
]
EXACT_BINARY = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / b,
    ca.fmin,
    ca.fmax,
    lambda a, b: a < b,
    lambda a, b: a <= b,
    lambda a, b: a == b,
    lambda a, b: ca.logic_and(a > 0, b != 0),
    lambda a, b: ca.logic_or(a > 0.5, ca.logic_not(b)),
    lambda a, b: ca.if_else(a > b, a - 0.125, 0.25 * b),
    lambda a, b: ca.if_else(ca.logic_not(ca.fabs(a) <= 1e300), b, a),
    lambda a, b: ca.if_else(a < 0, ca.if_else(b < 0, 3.0, a), ca.if_else(b < 1, b, a * b)),
]


def exact_law(seed: int):
    """A random law of exact operations; its states read one another, so their order matters."""
    random = np.random.default_rng(seed)

    def equations(symbols):
        pool = [*symbols.values(), ca.SX(0.3), ca.SX(-1.75)]
        for _ in range(70):
            first, second = (pool[i] for i in random.integers(len(pool), size=2))
            if random.random() < 0.3:
                pool.append(EXACT_UNARY[random.integers(len(EXACT_UNARY))](first))
            else:
                pool.append(EXACT_BINARY[random.integers(len(EXACT_BINARY))](first, second))
        late = pool[-20:]
        written = {f"x{i}": ca.fmin(ca.fmax(late[i], -9.0), 9.0) for i in range(4)}
        written |= {"x4": symbols["x5"], "x5": symbols["x4"], "x6": symbols["x0"]}
        return Equations(
            {**written, "x7": symbols["x4"] + symbols["x5"] - symbols["x6"]},
            {f"y{i}": late[-1 - i] for i in range(6)},
            {"first_value": late[-1], "second_value": late[10], "third_value": pool[20]},
        )

    return step_law(
        f"law_{seed}",
        inputs=[Signal(f"u{i}") for i in range(3)],
        parameters=[Signal(f"p{i}", initial=float(random.normal())) for i in range(3)],
        state=[Signal(f"x{i}", initial=float(random.normal())) for i in range(8)],
        outputs=[Signal(f"y{i}") for i in range(6)],
        equations=equations,
    )


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(8))
def test_random_laws_equal_casadi_and_the_engine(seed, tmp_path):
    law, samples = exact_law(seed), 60
    program = program_of(law)
    random = np.random.default_rng(100 + seed)
    inputs = {f"u{i}": random.normal(size=samples) * 3 for i in range(3)}
    inputs["u0"][::7] = random.choice(NASTY, size=len(inputs["u0"][::7]))
    state = np.array([entry.initial for entry in program.state])
    parameters = [signal.initial for signal in program.parameters]
    rows = []
    for k in range(samples):
        following, outputs, _ = law.function(
            state, [inputs[f"u{i}"][k] for i in range(3)], parameters
        )
        state = np.array(following).ravel()
        rows.append([*np.array(outputs).ravel(), *state])
    in_c, in_text = run_both(program, tmp_path, inputs)
    # CasADi writes a choice as a sum, in which the sign of a zero is lost.
    assert np.array_equal(all_bits(in_c + 0.0), all_bits(np.array(rows) + 0.0))
    assert np.array_equal(all_bits(in_c), all_bits(in_text))
    run = Kernel(program).run(samples, inputs=inputs)
    engine = np.column_stack([run.output(f"y{i}")[0] for i in range(6)])
    assert np.array_equal(all_bits(engine), all_bits(in_c[:, :6]))


def fibonacci_law():
    """Two carried values that exchange places, a table, an invariant and a loop in a loop."""
    row, carried, scale = ca.SX.sym("row", 2), ca.SX.sym("carried", 2), ca.SX.sym("scale")
    forward = ca.vertcat(carried[1], carried[0] + carried[1])
    fibonacci = ca.Function("turn", [ca.SX(0, 1), carried, ca.SX(0, 1)], [forward])
    total = ca.SX.sym("total")
    weighted = ca.Function("weighted", [row, total, scale], [total + row[0] * (row[1] + scale)])
    inner_row, inner = ca.SX.sym("inner_row"), ca.SX.sym("inner")
    inner_turn = ca.Function("inner_turn", [inner_row, inner, total], [inner + inner_row * total])
    outer_turn = ca.Function(
        "outer_turn",
        [row[0], total, scale],
        [counted_loop("inside", 3, inner_turn, carried=total, tables=[[1, 2, 3]],
                      invariants=row[0] * scale)],
    )  # fmt: skip

    def equations(s):
        pair = counted_loop("fibonacci", 12, fibonacci, carried=ca.vertcat(s["a"], s["b"]))
        table = [[1.0, 0.1, -2.0, 1e-3], [3.0, 0.7, -0.0, 5e300]]
        total = counted_loop(
            "weights", 4, weighted, carried=s["a"] * 2, tables=table, invariants=s["scale"] + 1
        )
        nested = counted_loop(
            "nested", 2, outer_turn, carried=ca.SX(0), tables=[[1.0, 10.0]], invariants=s["scale"]
        )
        return Equations(
            {"kept": pair[0] + s["kept"]},
            {"first": pair[0], "second": pair[1], "total": total, "nested": nested},
            {"weighted_sum": total},
        )

    return step_law(
        "loops",
        inputs=[Signal("a"), Signal("b"), Signal("scale")],
        parameters=[],
        state=[Signal("kept")],
        outputs=[Signal(name) for name in ("first", "second", "total", "nested")],
        equations=equations,
    )


def test_counted_loops(tmp_path):
    program = program_of(fibonacci_law())
    assert "for (int32_t" in print_c(program).source
    assert "FOR i := 0 TO 11 DO" in print_structured_text(program)
    inputs = {"a": np.array([0.0, 1.0]), "b": np.array([1.0, 1.0]), "scale": np.array([2.0, -0.3])}
    for table in run_both(program, tmp_path, inputs):
        # Twelve turns from F(0), F(1) and from F(1), F(2): the Fibonacci numbers themselves.
        assert table[:, :2].tolist() == [[144.0, 233.0], [233.0, 377.0]]
        assert table[:, 4].tolist() == [144.0, 377.0]
        for k in range(2):
            scale, total = inputs["scale"][k], 2 * inputs["a"][k]
            for weight, offset in zip([1.0, 0.1, -2.0, 1e-3], [3.0, 0.7, -0.0, 5e300], strict=True):
                total = total + weight * (offset + (scale + 1))
            nested = 0.0
            for outer in (1.0, 10.0):
                for inner in (1.0, 2.0, 3.0):
                    nested = nested + inner * (outer * scale)
            assert bits(table[k, 2]) == bits(total)
            assert bits(table[k, 3]) == bits(nested)


def delay_law():
    return step_law(
        "delays",
        inputs=[Signal("u"), Signal("good", kind="boolean")],
        parameters=[],
        state=[
            DelayRing(Signal("late", initial=0.25), 5),
            DelayRing(Signal("next_one", initial=-1.0), 1),
            DelayRing(Signal("later", initial=2.0), 3),
            DelayRing(Signal("was_good", kind="boolean", initial=1.0), 4),
            Signal("sum"),
        ],
        outputs=[Signal("y"), Signal("z"), Signal("then_good", kind="boolean")],
        equations=lambda s: Equations(
            # A ring that feeds a ring: the second must read what the first held before.
            {"late": s["u"], "next_one": s["u"], "later": s["late"], "was_good": s["good"],
             "sum": s["later"] + s["late"]},
            {"y": s["late"], "z": s["next_one"] + s["sum"], "then_good": s["was_good"]},
        ),
    )  # fmt: skip


def test_delay_rings(tmp_path):
    program, samples = program_of(delay_law()), 40
    random = np.random.default_rng(8)
    u, good = random.normal(size=samples), random.integers(2, size=samples).astype(float)
    late = np.concatenate([np.full(5, 0.25), u])[:samples]
    later = np.concatenate([np.full(3, 2.0), late])[:samples]
    one = np.concatenate([[-1.0], u])[:samples]
    total = np.concatenate([[0.0], later + late])[:samples]
    was_good = np.concatenate([np.ones(4), good])[:samples]
    for table in run_both(program, tmp_path, {"u": u, "good": good}):
        assert np.array_equal(table[:, 0], late)
        assert np.array_equal(table[:, 1], one + total)
        assert np.array_equal(table[:, 2], was_good)


def counter_law():
    def equations(s):
        following = ca.fmax(ca.fmin(s["count"] + s["increment"], 5), -9)
        over = ca.logic_or(following >= 5, s["latched"])
        return Equations(
            {"count": ca.if_else(s["reset"], -3, following), "latched": over},
            {
                "doubled": 2 * s["count"],
                "level": s["gain"] * s["count"],
                "rounded": ca.fmin(ca.fmax(ca.floor(s["signal"]), -9), 9),
                "alarm": ca.logic_and(over, ca.logic_not(s["reset"])),
                "same": ca.if_else(s["reset"], s["count"], 7),
            },
        )

    return step_law(
        "counter",
        inputs=[
            Signal("increment", kind="integer", low=-3, high=3),
            Signal("reset", kind="boolean"),
            Signal("signal", "m"),
        ],
        parameters=[Signal("gain", initial=0.1)],
        state=[Signal("count", kind="integer", initial=-3), Signal("latched", kind="boolean")],
        outputs=[
            Signal("doubled"),
            Signal("level", "m"),
            Signal("rounded", kind="integer"),
            Signal("alarm", kind="boolean"),
            Signal("same", kind="integer"),
        ],
        equations=equations,
    )


def test_integers_and_booleans(tmp_path):
    program, samples = program_of(counter_law()), 200
    random = np.random.default_rng(4)
    inputs = {
        "increment": random.integers(-1, 4, size=samples).astype(float),
        "reset": (random.random(samples) < 0.1).astype(float),
        "signal": random.choice(NASTY, size=samples),
    }
    rows, count, latched = [], -3, False
    for step, reset, signal in zip(*inputs.values(), strict=True):
        following = max(min(count + int(step), 5), -9)
        over = following >= 5 or latched
        rounded = -9.0 if math.isnan(signal) else max(-9.0, min(9.0, np.floor(signal)))
        alarm, same = over and not reset, count if reset else 7
        row = [2.0 * count, 0.1 * count, rounded, alarm, same]
        count, latched = (-3 if reset else following), over
        rows.append([*row, count, latched])
    for table in run_both(program, tmp_path, inputs):
        assert np.array_equal(table, np.array(rows, dtype=float))
    text = InterpretedText(program).block
    kinds = {name: entry.type for name, entry in text.declared.items()}
    assert (kinds["count"], kinds["alarm"], kinds["level"]) == ("DINT", "BOOL", "LREAL")
