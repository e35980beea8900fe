"""What a loop or a conditional is given and does not need: no variable of the printed C is idle."""

import casadi as ca
import numpy as np
import pytest
from deployed import CompiledC, all_bits
from test_needed import IDLE

from clepsydra import Signal, program_of
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.program import Program
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


@pytest.mark.parametrize("name", IDLE)
def test_what_nobody_reads_in_a_loop_or_a_conditional(name, tmp_path):
    proved(IDLE[name], tmp_path)
