"""A function block in matiec's C, called from outside: its ports, its scan, and its power."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.whole_numbers import printed_form
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.instances import remembering, with_block_names
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import own_state, state_paths
from clepsydra.program.precision import Precision
from clepsydra.program.program import Program

#: What matiec's C needs of the runtime that it is built into.
MATIEC_HEAD = """#include "iec_std_lib.h"
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;
"""
_SOURCE = """#include "accessor.h"
#include "POUS.h"
#include "POUS.c"
#define KEEP(variable) now->variable = before->variable;
/* The size of an instance [bytes]. */
unsigned long block_size(void) {{ return sizeof({block}); }}
/* Begins anew; where the one before is told, with what it retains. */
void block_power({block} *now, const {block} *before)
{{
    {block}_init__(now, 0);
    if (before) {{
{kept}
    }}
}}
/* One scan. */
void block_scan({block} *now, const double *given, double *found)
{{
{writes}
    {block}_body__(now);
{reads}
}}
"""


def matiec_block(
    program: Program,
    given: Sequence[Signal],
    precision: Precision = "double",
    *,
    states: bool = False,
) -> str:
    """Return C around what matiec makes of a printed function block, to be compiled with it.

    Its functions are block_size, block_power and block_scan, which takes the inputs and parameters
    that are given and gives the outputs of the program, all as doubles.

    Parameters
    ----------
    program : Program
        What the block was printed from.
    given : sequence of Signal
        Those of its inputs and parameters that are given at every scan.
    precision : {"double", "single"}
    states : bool
        Whether its states follow the outputs; of a delay ring what the next scan reads.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> text = matiec_block(program, program.inputs)
    >>> [line.strip() for line in text.splitlines() if "[0]" in line or "KEEP(X" in line]
    ['KEEP(X)', 'now->U.value = given[0];', 'found[0] = now->Y.value;']
    """
    form = with_block_names(printed_form(program, precision), dialect_of("matiec").all_words)
    writes = [
        f"    now->{signal.identifier.upper()}.value = given[{place}];"
        for place, signal in enumerate(given)
    ]
    # A structure is one value with members; a scalar is one.
    shown = [
        f"{s.variable.upper()}.value{f'.{s.part.upper()}' if s.record else ''}"
        for s in program.outputs
    ]
    if states:
        for entry, path in zip(program.state, state_paths(form), strict=True):
            name = ".".join(path).upper()
            place = f".table[now->{name}_POSITION.value]" if is_ring(entry) else ""
            shown.append(f"{name}.value{place}")
    reads = [f"    found[{place}] = now->{value};" for place, value in enumerate(shown)]
    return MATIEC_HEAD + _SOURCE.format(
        block=program.name.upper(),
        kept="\n".join(f"        KEEP({name})" for name in _retained(form)),
        writes="\n".join(writes),
        reads="\n".join(reads),
    )


def _retained(form: Program, inside: str = "") -> Iterator[str]:
    """Give the variables that a block declares RETAIN, and those of the instances in it.

    matiec marks them in what it makes, but for arrays, so that they are told here.
    """
    for entry in own_state(form):
        name = f"{inside}{signal_of(entry).identifier.upper()}"
        yield name
        if is_ring(entry):
            yield f"{name}_POSITION"
    for call in form.calls:
        yield from _retained(remembering(call.program), f"{inside}{call.identifier.upper()}.")
