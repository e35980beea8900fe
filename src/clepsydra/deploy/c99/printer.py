"""C99 from a step program: one header and one source, without allocation or recursion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.interface import check_names, head_comment, print_header, step_head
from clepsydra.deploy.c99.statements import FUNCTIONS, NOTATION, array, assign, statement
from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.expressions import Expression, flag, render, variable
from clepsydra.deploy.printing.folding import list_block
from clepsydra.deploy.printing.heading import check_printable
from clepsydra.deploy.printing.identifiers import (
    C_WORDS,
    Identifiers,
)
from clepsydra.deploy.printing.listing import Listing
from clepsydra.deploy.printing.whole_numbers import check_whole_results
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


def print_c(program: Program) -> CSource:
    """Print a step program as C99.

    ``NAME_initialise`` sets the initial state, ``NAME_default_parameters`` the parameters'
    values, and ``NAME_step`` computes one sample: it reads parameters, state and inputs,
    writes outputs and the next state. Integer signals are ``int32_t``, boolean ones ``bool``,
    all others ``double`` in their SI unit.

    Parameters
    ----------
    program : Program
        Without fused operations.

    Returns
    -------
    CSource

    Raises
    ------
    InputError
        It is no program, an operation is fused, a name is no identifier of C, two names become
        one, or an integer or boolean result may be something else.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_c(program).source.splitlines()[-4:]
    ['', '  /* outputs */', '  outputs->y = x + x;', '}']
    """
    check_printable(program)
    check_whole_results(program)
    check_names(program)
    return CSource(program.name, print_header(program), _Printer(program).source())


class _Printer:
    def __init__(self, program: Program) -> None:
        self._program = program
        name = program.name
        self._names = Identifiers(
            {*C_WORDS, *FUNCTIONS.values(), "HUGE_VAL", "state", "inputs", "parameters"}
            | {"outputs", f"{name}_state", f"{name}_inputs", f"{name}_parameters"}
            | {f"{name}_outputs", f"{name}_step", f"{name}_initialise"},
            ignore_case=False,
        )
        self._used = program.block.uses()
        self._loads: list[str] = []
        arguments = [self._load(value) for value in range(program.block.arguments)]
        labels = {
            value: self._names.new(label)
            for value, label in program.names.items()
            if value >= program.block.arguments and value in self._used
        }
        preferred: dict[int, str] = {}
        for entry, value in zip(program.outputs, program.output_values, strict=True):
            preferred.setdefault(value, entry.identifier)
        for state, value in zip(program.state, program.next_state, strict=True):
            preferred.setdefault(value, f"next_{signal_of(state).identifier}")
        self._listing: Listing = list_block(
            program.block, arguments, NOTATION, self._names, labels=labels, preferred=preferred
        )

    def _load(self, value: int) -> Expression:
        """Copy an argument that is read into a local, so that the state can be overwritten."""
        program = self._program
        if value not in self._used:
            return variable("")
        if value in program.state_arguments:
            where, entry = "state", program.state[value]
        elif value in program.input_arguments:
            where, entry = "inputs", program.inputs[value - program.input_arguments.start]
        else:
            first = program.parameter_arguments.start
            where, entry = "parameters", program.parameters[value - first]
        signal = signal_of(entry)
        member = f"{where}->{signal.identifier}"
        if is_ring(entry):
            member = f"{member}[{member}_position]"
        local = self._names.new(signal.identifier)
        if signal.kind == "boolean":
            self._loads.append(f"  const bool {local} = {member};")
            return Expression("number", (flag(local),))
        cast = "(double)" if signal.kind == "integer" else ""
        self._loads.append(f"  const double {local} = {cast}{member};")
        return variable(local)

    def source(self) -> str:
        program, name = self._program, self._program.name
        lines = head_comment(program) + [f'#include "{name}.h"', "", "#include <float.h>"]
        if self._uses_mathematics():
            lines.append("#include <math.h>")
        lines += [
            "",
            "#if FLT_EVAL_METHOD == 2 || FLT_EVAL_METHOD < 0",
            '#error "this compiler does not evaluate doubles as doubles: results would differ"',
            "#endif",
            "",
        ]
        for table, values in self._listing.tables.items():
            lines += array(f"static const double {table}[{len(values)}]", values)
        lines += self._defaults() + self._initialise() + self._step()
        return "\n".join(lines)

    def _uses_mathematics(self) -> bool:
        expressions = self._listing.expressions()
        initial = [entry.initial for entry in map(signal_of, self._program.state)]
        initial += [entry.initial for entry in self._program.parameters]
        return any(map(math.isinf, initial)) or any(
            part.code in FUNCTIONS or (part.code == "constant" and math.isinf(part.number))
            for part in expressions
        )

    def _defaults(self) -> list[str]:
        name = self._program.name
        lines = [f"void {name}_default_parameters({name}_parameters *parameters)", "{"]
        for entry in self._program.parameters:
            lines.append(f"  parameters->{entry.identifier} = {_literal(entry)};")
        if not self._program.parameters:
            lines.append("  parameters->nothing = 0;")
        return [*lines, "}", ""]

    def _initialise(self) -> list[str]:
        name = self._program.name
        lines = [f"void {name}_initialise({name}_state *state)", "{"]
        for entry in self._program.state:
            signal = signal_of(entry)
            member = f"state->{signal.identifier}"
            if is_ring(entry):
                lines += [
                    f"  for (int32_t i = 0; i < {entry.length}; ++i) {{",
                    f"    {member}[i] = {_literal(signal)};",
                    "  }",
                    f"  {member}_position = 0;",
                ]
            else:
                lines.append(f"  {member} = {_literal(signal)};")
        if not self._program.state:
            lines.append("  state->nothing = 0;")
        return [*lines, "}", ""]

    def _step(self) -> list[str]:
        program = self._program
        lines = [*step_head(program.name, ""), "{"]
        pointers = {
            "parameters": program.parameter_arguments,
            "inputs": program.input_arguments,
        }
        for pointer, arguments in pointers.items():
            if not any(value in self._used for value in arguments):
                lines.append(f"  (void){pointer};")
        if not program.state:
            lines.append("  (void)state;")
        lines += self._loads
        if self._loads and self._listing.statements:
            lines.append("")
        for entry in self._listing.statements:
            lines += statement(entry, 1)
        if not program.outputs:
            lines.append("  outputs->nothing = 0;")
        results = self._listing.results
        lines += self._stores("outputs", program.outputs, results[len(program.state) :])
        lines += self._stores("state", program.state, results[: len(program.state)])
        return [*lines, "}", ""]

    def _stores(
        self,
        where: str,
        entries: Sequence[Entry],
        results: Sequence[Expression],
    ) -> list[str]:
        title = "next state" if where == "state" else where
        lines = ["", f"  /* {title} */"] if entries else []
        for entry, result in zip(entries, results, strict=True):
            signal = signal_of(entry)
            member = f"{where}->{signal.identifier}"
            text = _converted(result, signal)
            if is_ring(entry):
                lines += assign(f"{member}[{member}_position]", text, 1)
                following = f"{member}_position + 1"
                lines += assign(
                    f"{member}_position",
                    f"{following} < {entry.length} ? {following} : 0",
                    1,
                )
            else:
                lines += assign(member, text, 1)
        return lines


def _literal(signal: Signal) -> str:
    """Write the initial value of a signal in its type."""
    if signal.kind == "integer":
        # The lowest 32-bit integer has no literal of its own in C.
        whole = int(signal.initial)
        return "INT32_MIN" if whole == -(2**31) else str(whole)
    if signal.kind == "boolean":
        return "true" if signal.initial else "false"
    return render(Expression("constant", number=signal.initial), NOTATION)


def _converted(result: Expression, signal: Signal) -> str:
    """Write a result in the type of its signal; that it fits has been proved."""
    if signal.kind == "boolean":
        if result.code == "number":
            return render(result.operands[0], NOTATION)
        return render(Expression("truth", (result,)), NOTATION)
    text = render(result, NOTATION)
    if signal.kind == "integer":
        return f"(int32_t){text}" if result.code == "variable" else f"(int32_t)({text})"
    return text
