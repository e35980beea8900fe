"""What a loop or a conditional is given and does not need: no variable of the printed C is idle."""

import casadi as ca
import numpy as np
import pytest
from deployed import CompiledC, all_bits

from clepsydra import Signal, program_of
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.needed import needed_part
from clepsydra.program.program import Block, Conditional, Loop, Operation, Program
from clepsydra.program.step_law import Equations, step_law


def proved(program: Program, folder) -> None:
    """Build the C with every warning an error, and compare it with the engine."""
    random = np.random.default_rng(3)
    inputs = {signal.name: random.normal(size=200) for signal in program.inputs}
    found = CompiledC(program, folder).run(inputs)
    assert np.array_equal(all_bits(found), all_bits(engine_run(program, inputs)))


@pytest.mark.parametrize("body", ["total + row", "total", "row"])
def test_a_law_hands_a_loop_more_than_it_reads(body, tmp_path):
    """As a user writes one: the last of three invariants is a root that nobody looks at."""
    row, total, given = ca.SX.sym("row"), ca.SX.sym("total"), ca.SX.sym("given", 3)
    following = {"total + row": total + row, "total": total, "row": row}[body]
    turn = ca.Function("turn", [row, total, given], [following + given[0] * 0.5])

    def equations(s):
        root = ca.sqrt(ca.fabs(s["x"]) + 1)
        held = ca.vertcat(s["x"], root, ca.if_else(root > 2, root, s["y"]))
        table = [[0.5, 2.0, 1.0]]
        value = counted_loop("turns", 3, turn, carried=s["y"], tables=table, invariants=held)
        return Equations({}, {"moved": value})

    law = step_law(
        "law",
        inputs=[Signal("x"), Signal("y")],
        parameters=[],
        state=[],
        outputs=[Signal("moved")],
        equations=equations,
    )
    proved(program_of(law), tmp_path)


def test_a_carried_value_that_only_feeds_itself_and_others_like_it(tmp_path):
    """The second and third values of a turn make one another, and nobody reads either."""
    turn = Block(
        3,
        (Operation(3, "add", (0, 0)), Operation(4, "add", (1, 2)), Operation(5, "negate", (1,))),
        (3, 4, 5),
    )
    statements = (
        Operation(1, "floor", (0,)),
        Loop((2, 3, 4), 2, turn, (), (0, 1, 1), (), "turns"),
    )
    program = Program("law", (), (Signal("x"),), (), (Signal("y"),), Block(1, statements, (2,)))
    kept, read = needed_part(program.block)
    assert [type(statement).__name__ for statement in kept.statements] == ["Loop"]
    assert read[0] == 1 and read[1] == 0
    proved(program, tmp_path)


def test_the_condition_of_a_body_that_hands_on_what_it_gets(tmp_path):
    statements = (
        Operation(2, "constant", (), 0.1),
        Operation(3, "less", (1, 2)),
        Conditional((4,), 3, Block(1, (), (0,)), (0,), (), "nothing"),
        Operation(5, "add", (4, 4)),
    )
    block = Block(2, statements, (5,), frozenset({3}))
    program = Program("law", (), (Signal("x"), Signal("y")), (), (Signal("z"),), block)
    kept, _ = needed_part(block)
    assert [getattr(s, "code", "conditional") for s in kept.statements] == ["conditional", "add"]
    proved(program, tmp_path)
