"""C99 from a step program: one header and one source, without allocation or recursion."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.deploy.c99.interface import check_names, head_comment, print_header
from clepsydra.deploy.c99.source import print_source
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision, in_precision
from clepsydra.deploy.printing.printed_form import printed_form
from clepsydra.program.program import Program


@dataclass(frozen=True)
class CSource:
    """A printed program: the texts of its two files.

    Parameters
    ----------
    name : str
        The program's name, from which the files get theirs.
    header, source : str

    Examples
    --------
    >>> printed = CSource("level_control", "/* header */", "/* source */")
    >>> printed.header_name, printed.source_name
    ('level_control.h', 'level_control.c')
    """

    name: str
    header: str
    source: str

    @property
    def header_name(self) -> str:
        """File name of the header, as the source includes it."""
        return f"{self.name}.h"

    @property
    def source_name(self) -> str:
        """File name of the source."""
        return f"{self.name}.c"


def print_c(
    program: Program, *, origin: Origin | None = None, precision: Precision = "double"
) -> CSource:
    """Print a step program as C99.

    ``NAME_initialise`` sets the initial state, ``NAME_default_parameters`` the parameters'
    values, and ``NAME_step`` computes one sample: it reads parameters, state and inputs,
    writes outputs and the next state. Integer signals are ``int32_t``, boolean ones ``bool``,
    all others ``double`` or ``float`` in their unit. A block that the program calls becomes
    one static function ``NAME_BLOCK_step``, and each instance a member of the state.

    Parameters
    ----------
    program : Program
        Without fused operations.
    origin : Origin, optional
        What the head says of it, and where its numbers come from.
    precision : {"double", "single"}
        double or float.

    Returns
    -------
    CSource

    Raises
    ------
    InputError
        It is no program, an operation is fused, a name is no identifier of C, two names become
        one, an integer or boolean result may be something else, or a number or a count is
        outside single precision.
    ValueError
        Two blocks of one name compute different things, or one is called inside a loop.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_c(program).source.splitlines()[-2:]
    ['  outputs->y = inputs->x + inputs->x;', '}']
    """
    printed = printed_form(program, precision)
    head = head_comment(in_precision(program, precision), origin, precision)
    check_names(printed)
    header = print_header(printed, head, origin, precision)
    return CSource(program.name, header, print_source(printed, head, origin, precision))
