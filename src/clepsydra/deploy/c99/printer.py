"""C99 from a step program: one header and one source, without allocation or recursion."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from clepsydra.base.language_words import C_WORDS
from clepsydra.deploy.c99.interface import check_names, function_head, head_comment, print_header
from clepsydra.deploy.c99.statements import C99, arithmetic_check
from clepsydra.deploy.c99.step import BlockFunction, StepFunction
from clepsydra.deploy.c99.structures import WIDTH, remarked
from clepsydra.deploy.printing.heading import number_comment, table_comment
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.printed_form import printed_form
from clepsydra.program.called_blocks import called_blocks
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import state_paths
from clepsydra.program.precision import Precision, in_precision
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
    language = C99(program.name, precision)
    head = head_comment(in_precision(program, precision), language, origin)
    check_names(printed)
    header = print_header(printed, head, language, origin)
    return CSource(program.name, header, _Source(printed, language, origin).text(head))


class _Source:
    def __init__(self, program: Program, language: C99, origin: Origin | None) -> None:
        self._program, self._language, self._origin = program, language, origin
        name, blocks = program.name, called_blocks(program)
        parts = ("state", "inputs", "parameters", "outputs")
        functions = ("step", "initialise", "default_parameters", "default_inputs")
        taken = {*C_WORDS, *language.notation.functions.values(), *parts}
        for each in (name, *(language.record(block.name) for block in blocks)):
            taken |= {f"{each}_{what}" for what in (*parts, *functions)}
        self._functions: list[StepFunction] = []
        for block in blocks:
            self._functions.append(BlockFunction(block, language, taken))
            taken |= self._functions[-1].tables.keys()
        self._functions.append(StepFunction(program, language, taken))

    def text(self, head: Sequence[str]) -> str:
        program = self._program
        *blocks, step = self._functions
        lines = [row for block in blocks for row in (*self._tables(block), *block.text())]
        lines += self._tables(step)
        for where in ("parameters", "inputs"):
            members = ((each.identifier, each) for each in getattr(program, where))
            lines += self._set(f"default_{where}", where, members)
        paths = [
            *map(".".join, state_paths(program)),
            *(e.signal.identifier for e in program.rings),
        ]
        state = zip(paths, (*program.state, *program.rings), strict=True)
        lines += [*self._set("initialise", "state", state), *step.text()]
        mathematics = ["#include <math.h>"] if self._uses_mathematics() else []
        opening = [*head, f'#include "{program.name}.h"', "", "#include <float.h>", *mathematics]
        return "\n".join([*opening, "", *arithmetic_check(self._language.notation), *lines])

    def _tables(self, function: StepFunction) -> list[str]:
        lines, language = [], self._language
        for name, table in function.tables.items():
            texts = ", ".join(map(language.number, table.values))
            lines += [
                f"/* {table.description or table_comment(self._origin)} */",
                f"static const {language.types['real']} {name}[{len(table.values)}] = {{",
                *indented(textwrap.wrap(f"{texts},", WIDTH - 2, break_on_hyphens=False)),
                "};",
                "",
            ]
        return lines

    def _uses_mathematics(self) -> bool:
        program, notation = self._program, self._language.notation
        entries = (*program.state, *program.rings, *program.parameters, *program.inputs)
        names = "|".join(name for name in notation.functions.values() if name.isalnum())
        called = rf"(?:{names})\(|{notation.infinity}\b"
        infinite = any(math.isinf(signal_of(entry).initial) for entry in entries)
        return infinite or any(function.reads(called) for function in self._functions)

    def _set(self, what: str, where: str, members: Iterable[tuple[str, Entry]]) -> list[str]:
        """Return a function that sets the members of a structure."""
        lines: list[str] = []
        for name, entry in members:
            member = f"{where}->{name}"
            if is_ring(entry):
                number = indented(self._number(f"{member}[i]", entry, 4))
                lines.append(f"for (int32_t i = 0; i < {entry.length}; ++i) {{")
                lines += [*number, "}", f"{member}_position = 0;"]
            else:
                lines += self._number(member, entry)
        lines = lines or [f"{where}->nothing = 0;"]
        return [*function_head(self._program.name, what), "{", *indented(lines), "}", ""]

    def _number(self, left: str, entry: Entry, indent: int = 2) -> list[str]:
        """Write an initial value, with its unit and where it comes from."""
        # Nobody has chosen what an input is: only numbers that stay have a source.
        stays = entry not in self._program.inputs
        source = self._origin.source_of(entry) if self._origin and stays else ""
        line = f"{left} = {self._language.initial(signal_of(entry))};"
        return remarked(line, number_comment(entry, source), indent)
