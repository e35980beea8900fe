"""A program without fused operations: in its block, in loops, in conditionals."""

from clepsydra.deploy.process_program import without_fused
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Conditional, ForLoop, Program


def fused_square(builder: BlockBuilder) -> int:
    return builder.operation("add", builder.operation("multiply", 0, 0, fused=True), 0, fused=True)


def nested() -> Program:
    innermost, inner, outer = BlockBuilder(1), BlockBuilder(1), BlockBuilder(1)
    body = innermost.finish([fused_square(innermost)])
    positive = inner.operation("less", inner.constant(0.0), 0)
    (value,) = inner.conditional("positive", positive, body, [fused_square(inner)], [])
    loop_body = inner.finish([value])
    (result,) = outer.loop("turns", loop_body, 3, [], [fused_square(outer)], [])
    return Program("nested", (), (), (), (), outer.finish([result]))


def test_every_operation_is_reached():
    program = nested()
    kinds = {type(s) for s in program.block.statements}
    kinds |= {type(s) for loop in program.block.statements if isinstance(loop, ForLoop)
              for s in loop.body.statements}  # fmt: skip
    assert {ForLoop, Conditional} <= kinds
    before = list(program.block.operations())
    after = list(without_fused(program).block.operations())
    assert sum(operation.fused for operation in before) == 6
    assert not any(operation.fused for operation in after)
    # Nothing else is another one.
    assert [(o.target, o.code, o.arguments, o.constant) for o in before] == [
        (o.target, o.code, o.arguments, o.constant) for o in after
    ]
