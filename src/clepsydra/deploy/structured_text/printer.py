"""IEC 61131-3 Structured Text from a step program: one FUNCTION_BLOCK, no libraries."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.expressions import Expression, decimal, flag, render, variable
from clepsydra.deploy.printing.folding import list_block
from clepsydra.deploy.printing.heading import check_printable, heading
from clepsydra.deploy.printing.identifiers import STRUCTURED_TEXT_WORDS, Identifiers
from clepsydra.deploy.printing.listing import Assignment, CountedLoop, ListingStatement
from clepsydra.deploy.printing.whole_numbers import check_whole_results
from clepsydra.deploy.structured_text.interface import (
    check_names,
    declaration,
    output_declaration,
    section,
    state_declaration,
)
from clepsydra.deploy.structured_text.statements import NOTATION, assign, statement, wrapped
from clepsydra.program.program import Program

_NOTES = (
    "LREAL must be the IEEE 754 double, without fused multiply-add: then it equals the",
    "simulation. Call once in every sampling period. Parameters are inputs with defaults.",
)


def print_structured_text(program: Program) -> str:
    """Print a step program as a FUNCTION_BLOCK of IEC 61131-3, third edition.

    Inputs and parameters are VAR_INPUT (parameters with their value as default), outputs
    VAR_OUTPUT, the state VAR with its initial value; real signals are LREAL in their SI unit,
    integer ones DINT, boolean ones BOOL. The operations of `clepsydra.program.program.EXACT`
    compute every bit of the simulation; the functions EXP, LN, SIN … are the target's own and
    may differ in the last bits.

    Parameters
    ----------
    program : Program
        Without fused operations.

    Raises
    ------
    InputError
        It is no program, an operation is fused or not in the standard, a number is not finite,
        a name is no identifier or a word of the language, two names differ in case only, or an
        integer or boolean result may be something else.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_structured_text(program).splitlines()[-2:]
    ['y := x + x;', 'END_FUNCTION_BLOCK']
    """
    check_printable(program)
    check_whole_results(program)
    check_names(program)
    return _Printer(program).text()


class _Printer:
    def __init__(self, program: Program) -> None:
        self._program = program
        entries = (*program.state, *program.inputs, *program.parameters)
        declared = [signal_of(entry).identifier for entry in (*entries, *program.outputs)]
        declared += [f"{name}_position" for name in declared]
        self._names = Identifiers(
            [*declared, program.name, *STRUCTURED_TEXT_WORDS], ignore_case=True
        )
        arguments = [self._argument(entry) for entry in entries]
        labels, preferred = self._labels()
        self._listing = list_block(
            program.block, arguments, NOTATION, self._names, labels=labels, preferred=preferred
        )
        self._statements = [*self._listing.statements]
        results = self._listing.results
        self._next_state = self._kept(results[: len(program.state)])
        self._outputs = [
            self._plain(output, result)
            for output, result in zip(program.outputs, results[len(program.state) :], strict=True)
        ]

    def _argument(self, entry: Entry) -> Expression:
        signal = signal_of(entry)
        name = signal.identifier
        if is_ring(entry):
            name = f"{name}[{name}_position]"
        if signal.kind == "boolean":
            return Expression("number", (flag(name),))
        return variable(f"DINT_TO_LREAL({name})" if signal.kind == "integer" else name)

    def _labels(self) -> tuple[dict[int, str], dict[int, str]]:
        """Return the names of values that have one: the law's own, outputs, next states."""
        program, used = self._program, self._program.block.uses()
        first = program.block.arguments
        labels: dict[int, str] = {}
        preferred: dict[int, str] = {}
        for output, value in zip(program.outputs, program.output_values, strict=True):
            # An output variable may be read back: the value needs no other name.
            unnamed = program.names.get(value, output.name) == output.name
            if output.kind == "real" and value >= first and unnamed:
                labels.setdefault(value, output.identifier)
            preferred.setdefault(value, f"{output.identifier}_number")
        results = dict(zip(program.output_values, program.outputs, strict=True))
        for value, name in program.names.items():
            own = value in results and results[value].name == name
            if value >= first and value in used and value not in labels and not own:
                labels[value] = self._names.new(name)
        for entry, value in zip(program.state, program.next_state, strict=True):
            if value not in labels and value not in results:
                preferred[value] = f"next_{signal_of(entry).identifier}"
        return labels, preferred

    def _kept(self, results: Sequence[Expression]) -> list[Expression]:
        """Give the next values variables where a state that they read is overwritten before."""
        kept = []
        overwritten: list[Expression] = []
        for entry, result in zip(self._program.state, results, strict=True):
            signal = signal_of(entry)
            if any(_reads(result, before) for before in overwritten):
                result = self._variable(f"next_{signal.identifier}", result)
            kept.append(self._plain(signal, result))
            overwritten.append(self._argument(entry))
        return kept

    def _plain(self, signal: Signal, result: Expression) -> Expression:
        """Give a result that is to be converted a variable where it is no expression."""
        direct = signal.kind == "real" or (signal.kind == "boolean" and result.code == "number")
        if direct or result.code not in NOTATION.statements:
            return result
        return self._variable(f"{signal.identifier}_number", result)

    def _variable(self, wanted: str, expression: Expression) -> Expression:
        name = self._names.new(wanted)
        self._statements.append(Assignment(name, expression))
        return variable(name)

    def text(self) -> str:
        program = self._program
        first, *rest = heading(program, "IEC 61131-3 Structured Text", _NOTES)
        lines = [f"(* {first}", *(f"   {line}" for line in rest)]
        lines[-1] += " *)"
        lines.append(f"FUNCTION_BLOCK {program.name}")
        lines += section("VAR_INPUT", "inputs of one sample", program.inputs, declaration)
        lines += section("VAR_INPUT", "parameters", program.parameters, declaration)
        lines += section("VAR_OUTPUT", "outputs", program.outputs, output_declaration)
        lines += section("VAR", "state", program.state, state_declaration)
        lines += self._tables()
        lines += self._temporaries()
        for entry in self._statements:
            lines += statement(entry)
        lines += self._stores()
        return "\n".join([*lines, "END_FUNCTION_BLOCK", ""])

    def _tables(self) -> list[str]:
        if not self._listing.tables:
            return []
        lines = ["VAR CONSTANT"]
        for name, values in self._listing.tables.items():
            texts = [decimal(value) for value in values]
            rows = [", ".join(texts[first : first + 6]) for first in range(0, len(texts), 6)]
            lines.append(f"  {name} : ARRAY[0..{len(values) - 1}] OF LREAL := [")
            lines += [f"    {row}," for row in rows[:-1]] + [f"    {rows[-1]}];"]
        return [*lines, "END_VAR"]

    def _temporaries(self) -> list[str]:
        outputs = {output.identifier for output in self._program.outputs}
        kinds = {name: kind for name, kind in _declared(self._statements) if name not in outputs}
        if not kinds:
            return []
        return ["VAR_TEMP", *(f"  {name} : {kind};" for name, kind in kinds.items()), "END_VAR"]

    def _stores(self) -> list[str]:
        program = self._program
        lines: list[str] = []
        for output, result in zip(program.outputs, self._outputs, strict=True):
            if result != variable(output.identifier):
                lines += _store(output.identifier, result, output)
        if lines:
            lines.insert(0, "(* outputs *)")
        if program.state:
            lines.append("(* next state *)")
        for entry, result in zip(program.state, self._next_state, strict=True):
            signal = signal_of(entry)
            name = signal.identifier
            if is_ring(entry):
                position = f"{name}_position"
                lines += _store(f"{name}[{position}]", result, signal)
                lines.append(f"{position} := ({position} + 1) MOD {entry.length};")
            elif result != self._argument(entry):
                lines += _store(name, result, signal)
        return lines


def _reads(expression: Expression, argument: Expression) -> bool:
    """Whether an expression reads an argument, as a number or as a truth value."""
    parts = (argument, *argument.operands)
    return expression in parts or any(_reads(part, argument) for part in expression.operands)


def _store(name: str, result: Expression, signal: Signal) -> list[str]:
    """Write a result in the type of its signal; that it fits has been proved."""
    if signal.kind == "real":
        return assign(name, result)
    if signal.kind == "boolean":
        truth = result.operands[0] if result.code == "number" else Expression("truth", (result,))
        return assign(name, truth)
    return wrapped(name, f"LREAL_TO_DINT({render(result, NOTATION)})")


def _declared(statements: Sequence[ListingStatement]) -> list[tuple[str, str]]:
    """Return name and type of every variable that statements assign, in order."""
    found: list[tuple[str, str]] = []
    for entry in statements:
        if isinstance(entry, Assignment):
            found.append((entry.name, "BOOL" if entry.expression.is_truth else "LREAL"))
            continue
        if isinstance(entry, CountedLoop):
            found.append((entry.index, "DINT"))
        found += _declared(entry.start) + _declared(entry.body)
    return found
