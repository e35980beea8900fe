"""A program as it is printed: checked, in its precision, its blocks with all that is theirs."""

from __future__ import annotations

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.deploy.printing.whole_numbers import check_whole_results
from clepsydra.program.called_blocks import without_untold
from clepsydra.program.owned_state import with_owned_state
from clepsydra.program.precision import Precision, in_precision
from clepsydra.program.program import Program


def printed_form(program: Program, precision: Precision) -> Program:
    """Return a program whose calls own their state and tell nothing that nobody reads.

    Structured Text has no fused operation, and a controller must compute the same bits
    everywhere.

    Raises
    ------
    InputError
        It is no program, some operation is fused, or it cannot be printed in that precision.
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> fused = Block(1, (Operation(1, "multiply", (0, 0), fused=True),), (1,))
    >>> try:
    ...     printed_form(Program("law", (), (Signal("u"),), (), (Signal("y"),), fused), "double")
    ... except InputError as error:
    ...     print(error.value)
    a fused multiply
    """
    remedy = "give controller.program(), or program_of(law) of a step law"
    require_type(program, Program, "print", "a Program", remedy)
    for operation in program.block.operations():
        if operation.fused:
            raise InputError(
                f"program {program.name}, value {operation.target}",
                f"a fused {operation.code}",
                "a program without fused operations",
                "print the controller's own program, or a process without fused operations",
            )
    program = without_untold(with_owned_state(in_precision(program, precision)))
    check_whole_results(program, precision)
    return program
