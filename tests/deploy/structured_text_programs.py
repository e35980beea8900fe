"""Programs that the tests of Structured Text and of PLCopen XML print."""

from clepsydra import Signal
from clepsydra.deploy.plcopen.printer import document
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.printer import function_blocks
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, ForLoop, Program


def every_kind() -> Program:
    """Inputs, parameters, outputs and states of all types, a ring, tables and rounding.

    The state counts up to 3, the ring keeps u for 3 samples, the table is added up times gain.
    """
    turn = Block(3, (Operation(3, "multiply", (0, 2)), Operation(4, "add", (1, 3))), (4,))
    once = Block(2, (Operation(2, "add", (1, 0)),), (2,))
    statements = (
        # 0 count, 1 late, 2 u, 3 good, 4 gain
        Operation(5, "constant", (), 1.0),
        Operation(6, "add", (0, 5)),
        Operation(7, "constant", (), 3.0),
        Operation(8, "minimum", (6, 7)),
        Operation(9, "floor", (2,)),
        Operation(10, "constant", (), 0.0),
        ForLoop((11,), 4, turn, ((1.0, 0.5, 0.25, 0.1),), (10,), (4,), "weights"),
        ForLoop((12,), 1, once, ((7.0,),), (11,), (), "single"),
        Operation(13, "constant", (), 1e300),
        Operation(14, "absolute", (2,)),
        Operation(15, "less_equal", (14, 13)),
        Operation(16, "truth", (3,)),
        Operation(17, "and", (15, 16)),
        Operation(18, "number", (17,)),
        Operation(19, "constant", (), -0.1),
        Operation(20, "multiply", (9, 19)),
        Operation(21, "add", (12, 20)),
    )
    block = Block(5, statements, (8, 2, 21, 1, 18), frozenset({15, 16, 17}))
    return Program(
        "every_kind",
        (
            Signal("count", kind="integer", initial=-2.0, description="scans so far"),
            DelayRing(Signal("late", "m", initial=0.25), 3),
        ),
        (Signal("u", "m", low=0.0, high=2.0, initial=0.5), Signal("good", kind="boolean")),
        (Signal("gain", "V/m", initial=0.3),),
        (
            Signal("y", "V"),
            Signal("then_u", "m"),
            Signal("fine", kind="boolean"),
        ),
        block,
    )


def pipe() -> Program:
    """Two rings that advance with the turns of a loop: one of six turns, one of one."""
    flow = DelayRing(Signal("pipe.flow", "m^3/s", initial=0.25), 6)
    last = DelayRing(Signal("last.flow", "m^3/s", initial=-1.0), 1)
    body = Block(
        5,
        (
            Operation(5, "add", (1, 2)),
            Operation(6, "multiply", (4, 0)),
            Operation(7, "add", (6, 3)),
        ),
        (5, 7, 6),
    )
    loop = ForLoop((2,), 4, body, (SHARES,), (1,), (0,), "pipe", (flow, last))
    block = Block(1, (Operation(1, "constant"), loop), (2,))
    return Program("pipe", (), (Signal("u", "m^3/s"),), (), (Signal("y", "m^3/s"),), block)


SHARES = (1.0, 0.5, 0.25, 2.0)


def flow_of_pipe(given: list[float]) -> list[float]:
    """What comes out of the pipe, by a list that is shifted."""
    inside, last, found = [0.25] * 6, -1.0, []
    for u in given:
        total = 0.0
        for share in SHARES:
            total += inside.pop(0)
            inside.append(u * share + last)
            last = u * share
        found.append(total)
    return found


def plcopen_of(
    program: Program,
    *,
    dialect: str = "codesys",
    precision: str = "double",
    origin: Origin | None = None,
) -> str:
    """The function blocks of a program as PLCopen XML."""
    spoken = dialect_of(dialect)
    return document(program.name, function_blocks(program, spoken, precision, origin), spoken)
