"""One law has one digest, whatever was left out of it and wherever its constants stand."""

from clepsydra.base.signal import Signal
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, ForLoop, Program
from clepsydra.program.renumbered import renumbered


def law(block: Block, names=None) -> Program:
    return Program("law", (), (Signal("u"),), (), (Signal("y"),), block, names or {})


def form(program: Program) -> str:
    """Return what a digest is taken of."""
    return repr(renumbered(program))


def test_gaps_and_places_of_constants_are_no_part_of_it():
    """y = 2 u + 0.5, with an operation that was dropped and the constants in another order."""
    one = Block(
        1,
        (
            Operation(1, "constant", (), 2.0),
            Operation(2, "multiply", (1, 0)),
            Operation(3, "constant", (), 0.5),
            Operation(4, "add", (2, 3)),
        ),
        (4,),
    )
    other = Block(
        1,
        (
            Operation(2, "constant", (), 0.5),
            Operation(5, "constant", (), 2.0),
            Operation(7, "multiply", (5, 0)),
            Operation(8, "add", (7, 2)),
        ),
        (8,),
    )
    assert form(law(one, {2: "twice"})) == form(law(other, {7: "twice"}))


def test_what_is_computed_is():
    def sum_with(number: float, order=(0, 1)) -> str:
        block = Block(1, (Operation(1, "constant", (), number), Operation(2, "add", order)), (2,))
        return form(law(block))

    assert len({sum_with(0.0), sum_with(-0.0), sum_with(1.0), sum_with(1.0, (1, 0))}) == 4


def test_bodies_of_loops_and_called_blocks_are_counted_anew_too():
    def inside(gap: int) -> str:
        body = Block(1, (Operation(1 + gap, "add", (0, 0)),), (1 + gap,))
        called = law(Block(1, (Operation(1 + gap, "negate", (0,)),), (1 + gap,)))
        loop = ForLoop((1 + gap,), 3, body, (), (0,), (), "turns")
        call = Call((2 + gap,), called, "inner", (1 + gap,))
        return form(law(Block(1, (loop, call), (2 + gap,))))

    assert inside(0) == inside(4)
