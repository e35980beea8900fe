"""IEC 61131-3 Structured Text from a step program: a FUNCTION_BLOCK for each of its blocks."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.library import function_blocks
from clepsydra.deploy.structured_text.pou_text import comment_lines, unit_text
from clepsydra.program.program import Program


def print_structured_text(
    program: Program,
    *,
    origin: Origin | None = None,
    precision: Precision = "double",
    dialect: str = "codesys",
) -> str:
    """Print a step program as a FUNCTION_BLOCK of IEC 61131-3, third edition.

    Before it stand the function blocks of what it calls, each once however many instances it
    has; what an instance remembers lives in the instance.

    Inputs and parameters are VAR_INPUT (parameters with their value as default), outputs
    VAR_OUTPUT, the state VAR RETAIN with its initial value, so that a warm start keeps it; real
    signals are LREAL or REAL in their unit, integer ones DINT, boolean ones BOOL. The
    operations of `clepsydra.program.program.EXACT` compute every bit of the simulation; the
    functions EXP, LN, SIN … are the target's own and may differ in the last bits.

    Parameters
    ----------
    program : Program
        Without fused operations.
    origin : Origin, optional
        What the head says of it, and where its numbers come from.
    precision : {"double", "single"}
        LREAL or REAL.
    dialect : {"codesys", "matiec", "scl"}
        For CODESYS and TwinCAT 3, for OpenPLC and Beremiz, or for Siemens TIA Portal.

    Raises
    ------
    InputError
        It is no program, an operation is fused or the system has none of it, a number is not
        finite or outside the range of REAL or of what the system reads, a name is no identifier
        or a word of the language, two names differ in case only, or an integer or boolean result
        may be something else.
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_structured_text(program).splitlines()[-2:]
    ['y := x + x;', 'END_FUNCTION_BLOCK']
    >>> print_structured_text(program, dialect="scl").splitlines()[-3:]
    ['BEGIN', '#y := #x + #x;', 'END_FUNCTION_BLOCK']
    """
    spoken = dialect_of(dialect)
    *library, main = function_blocks(program, spoken, precision, origin)
    lines: list[str] = []
    if library and not spoken.attributes:
        # Who opens the file reads first what it is; the blocks that it calls have to come before.
        lines += [*comment_lines(main.head, spoken), ""]
        main = replace(main, head=())
    for unit in (*library, main):
        lines += [*unit_text(unit, spoken), ""]
    return "\n".join(lines)
