"""What nothing needs of a block does not count: neither its statements nor what they read."""

from clepsydra import Signal
from clepsydra.program.needed import needed_part
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Conditional, ForLoop, Program

#: The second and third values of a turn make one another, and nobody reads either.
_TURN = Block(
    3,
    (Operation(3, "add", (0, 0)), Operation(4, "add", (1, 2)), Operation(5, "negate", (1,))),
    (3, 4, 5),
)
_LOOPED = Block(
    1,
    (Operation(1, "floor", (0,)), ForLoop((2, 3, 4), 2, _TURN, (), (0, 1, 1), (), "turns")),
    (2,),
)
#: The condition of a body that hands on what it gets.
_CHOSEN = Block(
    2,
    (
        Operation(2, "constant", (), 0.1),
        Operation(3, "less", (1, 2)),
        Conditional((4,), 3, Block(1, (), (0,)), (0,), (), "nothing"),
        Operation(5, "add", (4, 4)),
    ),
    (5,),
    frozenset({3}),
)
IDLE = {
    "carried values": Program("law", (), (Signal("x"),), (), (Signal("y"),), _LOOPED),
    "condition": Program("law", (), (Signal("x"), Signal("y")), (), (Signal("z"),), _CHOSEN),
}


def test_a_carried_value_that_only_feeds_itself_and_others_like_it():
    kept, read = needed_part(IDLE["carried values"].block)
    assert [type(statement).__name__ for statement in kept.statements] == ["ForLoop"]
    assert read[0] == 1 and read[1] == 0


def test_the_condition_of_a_body_that_hands_on_what_it_gets():
    kept, _ = needed_part(IDLE["condition"].block)
    assert [getattr(s, "code", "conditional") for s in kept.statements] == ["conditional", "add"]
