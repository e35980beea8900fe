"""The source of printed C99: tables, initial values, and the step function."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

from clepsydra.base.language_words import C_WORDS
from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.interface import function_head
from clepsydra.deploy.c99.language import C99, arithmetic_check, literal
from clepsydra.deploy.c99.step import BlockFunction, StepFunction
from clepsydra.deploy.c99.structures import WIDTH, block_name
from clepsydra.deploy.printing.heading import commented, number_comment, table_comment
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.printing.statements import indented
from clepsydra.program.called_blocks import called_blocks
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import state_paths
from clepsydra.program.program import Program


def print_source(
    program: Program, head: Sequence[str], origin: Origin | None, precision: Precision
) -> str:
    """Print the source of a program in its printed form, whose numbers and names were checked.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> tenth = Block(0, (Operation(0, "constant", (), 0.1),), (0,))
    >>> program = Program("tenth", (), (), (), (Signal("y"),), tenth)
    >>> text = print_source(program, [], None, "single")
    >>> text.splitlines()[-2]
    '  outputs->y = 0.1f;'
    """
    return _Source(program, head, origin, precision).text()


class _Source:
    def __init__(
        self, program: Program, head: Sequence[str], origin: Origin | None, precision: Precision
    ) -> None:
        self._program, self._head, self._origin = program, head, origin
        self._language = C99(program.name, precision)
        self._notation, self._real = self._language.notation, self._language.types["real"]
        name, blocks = program.name, called_blocks(program)
        parts = ("state", "inputs", "parameters", "outputs")
        taken = {*C_WORDS, *self._notation.functions.values(), *parts}
        for each in (name, *(block_name(name, block) for block in blocks)):
            functions = ("step", "initialise", "default_parameters", "default_inputs")
            taken |= {f"{each}_{what}" for what in (*parts, *functions)}
        self._blocks: list[StepFunction] = []
        for block in blocks:
            self._blocks.append(BlockFunction(block, self._language, taken))
            taken |= self._blocks[-1].tables.keys()
        self._step = StepFunction(program, self._language, taken)

    def text(self) -> str:
        lines = [*self._head, f'#include "{self._program.name}.h"', "", "#include <float.h>"]
        if self._uses_mathematics():
            lines.append("#include <math.h>")
        lines += ["", *arithmetic_check(self._notation)]
        for block in self._blocks:
            lines += [*self._tables(block), *block.text()]
        lines += self._tables(self._step)
        lines += self._defaults("parameters", self._program.parameters)
        lines += self._defaults("inputs", self._program.inputs)
        return "\n".join([*lines, *self._initialise(), *self._step.text()])

    def _tables(self, function: StepFunction) -> list[str]:
        lines = []
        for table, values in function.tables.items():
            texts = ", ".join(literal(value, "real", self._notation) for value in values)
            lines += [
                f"/* {table_comment(self._origin)} */",
                f"static const {self._real} {table}[{len(values)}] = {{",
                *indented(textwrap.wrap(f"{texts},", WIDTH - 2, break_on_hyphens=False)),
                "};",
                "",
            ]
        return lines

    def _uses_mathematics(self) -> bool:
        program = self._program
        entries = (*program.state, *program.rings, *program.parameters, *program.inputs)
        names = "|".join(name for name in self._notation.functions.values() if name.isalnum())
        return any(math.isinf(signal_of(entry).initial) for entry in entries) or any(
            function.reads(rf"(?:{names})\(|{self._notation.infinity}\b")
            for function in (*self._blocks, self._step)
        )

    def _defaults(self, where: str, entries: Sequence[Signal]) -> list[str]:
        lines = [*function_head(self._program.name, f"default_{where}"), "{"]
        for entry in entries:
            lines += self._number(f"{where}->{entry.identifier}", entry, 1)
        if not entries:
            lines.append(f"  {where}->nothing = 0;")
        return [*lines, "}", ""]

    def _initialise(self) -> list[str]:
        program = self._program
        lines = [*function_head(program.name, "initialise"), "{"]
        paths = [*state_paths(program), *((ring.signal.identifier,) for ring in program.rings)]
        for entry, path in zip((*program.state, *program.rings), paths, strict=True):
            member = f"state->{'.'.join(path)}"
            if is_ring(entry):
                lines.append(f"  for (int32_t i = 0; i < {entry.length}; ++i) {{")
                lines += self._number(f"{member}[i]", entry, 2)
                lines += ["  }", f"  {member}_position = 0;"]
            else:
                lines += self._number(member, entry, 1)
        if not paths:
            lines.append("  state->nothing = 0;")
        return [*lines, "}", ""]

    def _number(self, left: str, entry: Entry, depth: int) -> list[str]:
        """Write an initial value, with its unit and where it comes from."""
        # Nobody has chosen what an input is: only numbers that stay have a source.
        stays = entry not in self._program.inputs
        source = self._origin.source_of(entry) if self._origin and stays else ""
        indent, signal = "  " * depth, signal_of(entry)
        line = f"{left} = {literal(signal.initial, signal.kind, self._notation)};"
        about = number_comment(entry, source)
        return [indent + row for row in commented(line, about, "/*", "*/", WIDTH - len(indent))]
