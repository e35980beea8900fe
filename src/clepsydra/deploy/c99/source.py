"""The source of printed C99: tables, initial values, and the step function."""

from __future__ import annotations

import math
from collections.abc import Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.interface import (
    WIDTH,
    default_inputs_head,
    default_parameters_head,
    head_comment,
    initialise_head,
    kept,
    step_head,
)
from clepsydra.deploy.c99.notation import arithmetic_check, notation_of, real_type
from clepsydra.deploy.c99.statements import advance, array, assign, statement
from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.expressions import Expression, flag, render, variable
from clepsydra.deploy.printing.folding import list_block
from clepsydra.deploy.printing.heading import commented, number_comment, table_comment
from clepsydra.deploy.printing.identifiers import C_WORDS, Identifiers
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.program.program import Program


def print_source(program: Program, origin: Origin | None, precision: Precision) -> str:
    """Print the source of a program whose numbers and names were checked.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> tenth = Block(0, (Operation(0, "constant", (), 0.1),), (0,))
    >>> text = print_source(Program("tenth", (), (), (), (Signal("y"),), tenth), None, "single")
    >>> text.splitlines()[-2]
    '  outputs->y = 0.1f;'
    """
    return _Source(program, origin, precision).text()


class _Source:
    def __init__(self, program: Program, origin: Origin | None, precision: Precision) -> None:
        self._program = program
        self._origin = origin
        self._precision = precision
        self._notation = notation_of(precision)
        self._real = real_type(self._notation)
        name = program.name
        self._names = Identifiers(
            {*C_WORDS, *self._notation.functions.values(), "state", "inputs", "parameters"}
            | {"outputs", f"{name}_state", f"{name}_inputs", f"{name}_parameters"}
            | {f"{name}_outputs", f"{name}_step", f"{name}_initialise"}
            | {f"{name}_default_parameters", f"{name}_default_inputs"},
            ignore_case=False,
        )
        self._used = program.block.uses()
        self._locals: dict[str, tuple[str, str]] = {}
        arguments = [self._argument(value) for value in range(program.block.arguments)]
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
        self._listing = list_block(
            program.block, arguments, self._notation, self._names,
            labels=labels, preferred=preferred,
        )  # fmt: skip
        # A loop may be given an argument that its body does not read.
        read = {part.text for part in self._listing.expressions()}
        self._locals = {name: load for name, load in self._locals.items() if name in read}

    def _argument(self, value: int) -> Expression:
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
            self._locals[local] = where, f"const bool {local} = {member};"
            return Expression("number", (flag(local),))
        cast = f"({self._real})" if signal.kind == "integer" else ""
        self._locals[local] = where, f"const {self._real} {local} = {cast}{member};"
        return variable(local)

    def text(self) -> str:
        lines = head_comment(self._program, self._origin, self._precision)
        lines += [f'#include "{self._program.name}.h"', "", "#include <float.h>"]
        if self._uses_mathematics():
            lines.append("#include <math.h>")
        lines += ["", *arithmetic_check(self._notation)]
        for table, values in self._listing.tables.items():
            head = f"static const {self._real} {table}[{len(values)}]"
            lines += [f"/* {table_comment(self._origin)} */", *array(head, values, self._notation)]
        name, program = self._program.name, self._program
        lines += self._defaults(default_parameters_head(name, ""), "parameters", program.parameters)
        lines += self._defaults(default_inputs_head(name, ""), "inputs", program.inputs)
        return "\n".join([*lines, *self._initialise(), *self._step()])

    def _uses_mathematics(self) -> bool:
        program = self._program
        signals = [*map(signal_of, kept(program)), *program.parameters, *program.inputs]
        return any(math.isinf(signal.initial) for signal in signals) or any(
            part.code in self._notation.functions
            or (part.code == "constant" and math.isinf(part.number))
            for part in self._listing.expressions()
        )

    def _defaults(self, head: list[str], where: str, entries: Sequence[Signal]) -> list[str]:
        lines = [*head, "{"]
        for entry in entries:
            lines += self._number(f"{where}->{entry.identifier}", entry, 1)
        if not entries:
            lines.append(f"  {where}->nothing = 0;")
        return [*lines, "}", ""]

    def _initialise(self) -> list[str]:
        name = self._program.name
        lines = [*initialise_head(name, ""), "{"]
        for entry in kept(self._program):
            member = f"state->{signal_of(entry).identifier}"
            if is_ring(entry):
                lines.append(f"  for (int32_t i = 0; i < {entry.length}; ++i) {{")
                lines += self._number(f"{member}[i]", entry, 2)
                lines += ["  }", f"  {member}_position = 0;"]
            else:
                lines += self._number(member, entry, 1)
        if not kept(self._program):
            lines.append("  state->nothing = 0;")
        return [*lines, "}", ""]

    def _number(self, left: str, entry: Entry, depth: int) -> list[str]:
        """Write an initial value, with its unit and where it comes from."""
        # Nobody has chosen what an input is: only numbers that stay have a source.
        stays = entry not in self._program.inputs
        source = self._origin.source_of(entry) if self._origin and stays else ""
        indent = "  " * depth
        line = f"{left} = {self._literal(signal_of(entry))};"
        about = number_comment(entry, source)
        return [indent + row for row in commented(line, about, "/*", "*/", WIDTH - len(indent))]

    def _literal(self, signal: Signal) -> str:
        """Write the initial value of a signal in its type."""
        if signal.kind == "integer":
            # The lowest 32-bit integer has no literal of its own in C.
            whole = int(signal.initial)
            return "INT32_MIN" if whole == -(2**31) else str(whole)
        if signal.kind == "boolean":
            return "true" if signal.initial else "false"
        return render(Expression("constant", number=signal.initial), self._notation)

    def _step(self) -> list[str]:
        program = self._program
        lines = [*step_head(program.name, ""), "{"]
        loaded = {where for where, _ in self._locals.values()}
        lines += [f"  (void){where};" for where in ("parameters", "inputs") if where not in loaded]
        if not kept(program):
            lines.append("  (void)state;")
        lines += [f"  {load}" for _, load in self._locals.values()]
        if self._locals and self._listing.statements:
            lines.append("")
        for entry in self._listing.statements:
            lines += statement(entry, self._notation, 1)
        if not program.outputs:
            lines.append("  outputs->nothing = 0;")
        results = self._listing.results
        lines += self._stores("outputs", program.outputs, results[len(program.state) :])
        lines += self._stores("state", program.state, results[: len(program.state)])
        return [*lines, "}", ""]

    def _stores(
        self, where: str, entries: Sequence[Entry], results: Sequence[Expression]
    ) -> list[str]:
        title = "next state" if where == "state" else where
        lines = ["", f"  /* {title} */"] if entries else []
        for entry, result in zip(entries, results, strict=True):
            signal = signal_of(entry)
            member = f"{where}->{signal.identifier}"
            text = self._converted(result, signal)
            if is_ring(entry):
                lines += assign(f"{member}[{member}_position]", text, 1)
                lines += advance(member, entry.length, 1)
            else:
                lines += assign(member, text, 1)
        return lines

    def _converted(self, result: Expression, signal: Signal) -> str:
        """Write a result in the type of its signal; that it fits has been proved."""
        if signal.kind == "boolean":
            truth = Expression("truth", (result,))
            return render(result.operands[0] if result.code == "number" else truth, self._notation)
        text = render(result, self._notation)
        if signal.kind == "integer":
            return f"(int32_t){text}" if result.code == "variable" else f"(int32_t)({text})"
        return text
