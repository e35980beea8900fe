"""Conditionals in C and in Structured Text, against a plain interpreter, bit for bit."""

import deployed
import numpy as np
import pytest
from block_interpreter import evaluate_block
from deployed import all_bits, run_both
from random_blocks import FINITE, random_block, stimulus
from refusals import refused

from clepsydra import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Conditional, Program

ARGUMENTS, RESULTS, SAMPLES = 4, 6, 30


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(4))
def test_random_programs_equal_the_interpreter(seed, tmp_path, monkeypatch):
    # Nothing is simplified in these blocks, so much of what they compute is read by nothing.
    unread = [f"-Wno-unused-{what}" for what in ("but-set-variable", "variable", "const-variable")]
    monkeypatch.setattr(deployed, "STRICT", [*deployed.STRICT, *unread])
    plain, _ = random_block(
        7000 + seed, ARGUMENTS, RESULTS, nesting=0.15, library=False, special=FINITE
    )
    rows = stimulus(seed, SAMPLES, ARGUMENTS)
    program = Program(
        f"random_{seed}",
        (Signal("x", initial=0.5),),
        tuple(Signal(f"u{i}") for i in range(1, ARGUMENTS)),
        (),
        tuple(Signal(f"y{i}") for i in range(1, RESULTS)),
        plain,
    )
    state, expected = 0.5, []
    for row in rows:
        state, *outputs = evaluate_block(plain, [state, *row[1:]])
        expected.append([*outputs, state])
    inputs = {f"u{i}": rows[:, i] for i in range(1, ARGUMENTS)}
    for table in run_both(program, tmp_path, inputs):
        assert np.array_equal(all_bits(table), all_bits(np.array(expected)))


def spill_program(kind: str = "real") -> Program:
    """Above its limit a level is set back, the rest is spilt and the count goes up by one."""
    body = BlockBuilder(4)  # level, spilt, spills; limit
    over = body.operation("subtract", 0, 3)
    spilt = body.operation("add", 1, over)
    block = body.finish([3, spilt, body.constant(1.0)])
    builder = BlockBuilder(3)  # level, spilt; inflow
    limit, zero = builder.constant(2.0), builder.constant(0.0)
    level = builder.operation("add", 0, 2)
    full = builder.operation("less", limit, level)
    results = builder.conditional("spill", full, block, [level, 1, zero], [limit])
    return Program(
        "spill",
        (Signal("level", "m"), Signal("spilt", "m")),
        (Signal("inflow", "m"),),
        (),
        (Signal("spills", kind=kind),),
        builder.finish(results),
    )


def test_a_conditional_reads_like_written_by_hand():
    """What is limited is kept until the volume above the limit has been read."""
    source, text = print_c(spill_program()).source, print_structured_text(spill_program())
    assert "/* spill */\n" in source and "  outputs->spills = 0.0;\n  if (sum > 2.0) {\n" in source
    assert "    next_level = 2.0;\n" in source and "    outputs->spills = 1.0;\n  }\n" in source
    assert "(* spill *)\n" in text and "\nspills := 0.0;\nIF sum > 2.0 THEN\n" in text
    assert "  next_level := 2.0;\n" in text and "  spills := 1.0;\nEND_IF;\n" in text


@pytest.mark.parametrize("kind", ["real", "integer", "boolean"])
def test_results_of_a_conditional_may_be_whole_numbers(kind, tmp_path):
    """The count is 0 or 1 whichever way is taken, so it may be declared so."""
    inflow = np.array([0.5, 1.0, 1.0, -0.25, 0.5, 0.0])
    level, spilt, rows = 0.0, 0.0, []
    for flow in inflow:
        total = level + flow
        level, spilt = min(total, 2.0), spilt + max(total - 2.0, 0.0)
        rows.append([float(total > 2.0), level, spilt])
    for table in run_both(spill_program(kind), tmp_path, {"inflow": inflow}):
        assert table.tolist() == rows


@pytest.mark.parametrize("body_value", [0.5, 2.0])
def test_one_way_that_leaves_the_range_is_refused(body_value):
    body = Block(1, (Operation(1, "constant", (), body_value),), (1,))
    statements = (
        Operation(1, "truth", (0,)),
        Operation(2, "constant", (), 1.0),
        Conditional((3,), 1, body, (2,), (), "other"),
    )
    block = Block(1, statements, (3,), frozenset({1}))
    program = Program("law", (), (Signal("u"),), (), (Signal("y", kind="boolean"),), block)
    for printer in (print_c, print_structured_text):
        with refused(expected="0 or 1"):
            printer(program)


def test_values_that_nothing_reads_afterwards_get_no_variable(tmp_path):
    """The first carried value serves the body only, the third nobody; the last stays itself."""
    body = Block(4, (Operation(4, "multiply", (0, 1)), Operation(5, "negate", (2,))), (0, 4, 5, 3))
    statements = (
        Operation(1, "less", (0, 0)),
        Operation(2, "not", (1,)),
        Operation(3, "square_root", (0,)),
        Conditional((4, 5, 6, 7), 2, body, (3, 0, 0, 0), (), "turn"),
    )
    block = Block(1, statements, (5, 7), frozenset({1, 2}))
    program = Program("law", (), (Signal("u"),), (), (Signal("y"), Signal("z")), block)
    source = print_c(program).source
    assert source.count("\n  const double ") == 1 and "\n  double " not in source
    for table in run_both(program, tmp_path, {"u": np.array([4.0, 0.25])}):
        assert table.tolist() == [[8.0, 4.0], [0.125, 0.25]]


def test_a_body_that_changes_nothing_is_no_branch(tmp_path):
    same = Conditional((2,), 1, Block(1, (), (0,)), (0,), (), "nothing")
    block = Block(1, (Operation(1, "truth", (0,)), same), (2,), frozenset({1}))
    program = Program("law", (), (Signal("u"),), (), (Signal("y"),), block)
    assert "if (" not in print_c(program).source
    for table in run_both(program, tmp_path, {"u": np.array([0.0, 3.0])}):
        assert table.tolist() == [[0.0], [3.0]]


def test_the_digest_covers_conditionals():
    def program(name: str, condition: int) -> Program:
        truths = (Operation(2, "less", (0, 1)), Operation(3, "less", (1, 0)))
        body = Block(1, (Operation(1, "negate", (0,)),), (1,))
        turned = Conditional((4,), condition, body, (0,), (), name)
        block = Block(2, (*truths, turned), (4,), frozenset({2, 3}))
        return Program("law", (), (Signal("u"), Signal("v")), (), (Signal("y"),), block)

    given = [program("turn", 2), program("turn", 3), program("flip", 2)]
    assert len({digest(one) for one in given}) == 3
    assert len({print_structured_text(one).split("FUNCTION_BLOCK")[1] for one in given}) == 3
