"""A step program as a function block: its interface, and its statements."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.expressions import Expression, decimal, flag, variable
from clepsydra.deploy.printing.folding import list_block
from clepsydra.deploy.printing.heading import check_printable, heading
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import Assignment, CountedLoop, ListingStatement
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision, in_precision
from clepsydra.deploy.printing.whole_numbers import check_whole_results
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.interface import Interface, check_names
from clepsydra.deploy.structured_text.pou import Section, Unit, Variable
from clepsydra.deploy.structured_text.statements import (
    advance,
    assign,
    ring_place,
    statement,
    wrapped,
)
from clepsydra.deploy.structured_text.wording import Wording
from clepsydra.program.program import Program

_NUMBERS = {
    "double": "LREAL must be the IEEE 754 double, without fused multiply-add: then it equals the",
    "single": "REAL must be the IEEE 754 single, without fused multiply-add: then it equals the",
}
_NOTES = (
    "simulation in that precision. Call it once in every sampling period. Parameters are inputs",
    "with defaults.",
)


def function_block(
    program: Program, dialect: Dialect, precision: Precision, origin: Origin | None = None
) -> Unit:
    """Return a step program as a function block of a dialect.

    Raises
    ------
    InputError
        See `clepsydra.deploy.structured_text.printer.print_structured_text`.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> function_block(program, dialect_of("codesys"), "double").body
    ('y := x + x;',)
    """
    check_printable(program)
    program = in_precision(program, precision)
    check_whole_results(program, precision)
    check_names(program, dialect)
    return _Printer(program, dialect, precision).unit(origin)


#: So many factors of a product on a line.
_FACTORS_A_LINE = 3


class _Printer:
    def __init__(self, program: Program, dialect: Dialect, precision: Precision) -> None:
        self._program = program
        self._dialect = dialect
        entries = (*program.state, *program.inputs, *program.parameters)
        declared = [signal_of(entry).identifier for entry in (*entries, *program.rings)]
        declared += [output.identifier for output in program.outputs]
        declared += [f"{name}_position" for name in declared]
        self._names = Identifiers([*declared, program.name, *dialect.all_words], ignore_case=True)
        self._wording = Wording(dialect, precision, self._names)
        arguments = [self._argument(entry) for entry in entries]
        labels, preferred = self._labels()
        self._listing = list_block(
            program.block,
            arguments,
            self._wording.notation,
            self._names,
            labels=labels,
            preferred=preferred,
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
        name = ring_place(signal.identifier, is_ring(entry))
        if signal.kind == "boolean":
            return Expression("number", (flag(name),))
        real = self._wording.real
        return variable(f"DINT_TO_{real}({name})" if signal.kind == "integer" else name)

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
        if direct or result.code not in self._wording.notation.statements:
            return result
        return self._variable(f"{signal.identifier}_number", result)

    def _variable(self, wanted: str, expression: Expression) -> Expression:
        name = self._names.new(wanted)
        self._statements.append(Assignment(name, expression))
        return variable(name)

    def unit(self, origin: Origin | None) -> Unit:
        program, wording = self._program, self._wording
        body = [line for entry in self._statements for line in statement(entry, wording)]
        body += self._stores()
        # Only now is known which numbers the system cannot read.
        body = [*self._products(), *body]
        notes = (_NUMBERS[wording.precision], *_NOTES)
        head = heading(program, "IEC 61131-3 Structured Text", notes, origin)
        sections = [
            *Interface(wording, origin).sections(program),
            self._tables(),
            self._temporaries(),
        ]
        local = {entry.name.lower() for section in sections for entry in section.variables}
        return Unit(
            "FUNCTION_BLOCK",
            program.name,
            tuple(head),
            tuple(sections),
            tuple(wording.marked(line, local) for line in body),
        )

    def _products(self) -> list[str]:
        lines = []
        for name, (number, product) in self._wording.products.items():
            why = f"{name} is {decimal(number)}, beyond the numbers that the system reads"
            rows = [
                product[k : k + _FACTORS_A_LINE] for k in range(0, len(product), _FACTORS_A_LINE)
            ]
            text = "\n    * ".join(" * ".join(row) for row in rows)
            lines += [self._dialect.commented(why), *f"{name} := {text};".splitlines()]
        return lines

    def _tables(self) -> Section:
        wording = self._wording
        tables = tuple(
            Variable(
                name,
                wording.real,
                tuple(wording.number(value, f"an entry of {name}") for value in values),
                len(values),
            )
            for name, values in self._listing.tables.items()
        )
        return Section(
            "VAR", "CONSTANT" if self._dialect.constant_arrays else "", (("tables", tables),)
        )

    def _temporaries(self) -> Section:
        outputs = {output.identifier for output in self._program.outputs}
        kinds = dict.fromkeys(self._wording.products, self._wording.real)
        for name, kind in _declared(self._statements, self._wording.real):
            if name not in outputs:
                kinds[name] = kind
        variables = tuple(Variable(name, kind) for name, kind in kinds.items())
        return Section("VAR_TEMP", "", (("values of one sample", variables),))

    def _stores(self) -> list[str]:
        program, comment = self._program, self._dialect.commented
        lines: list[str] = []
        for output, result in zip(program.outputs, self._outputs, strict=True):
            if result != variable(output.identifier):
                lines += self._store(output.identifier, result, output)
        if lines:
            lines.insert(0, comment("outputs"))
        if program.state:
            lines.append(comment("next state"))
        for entry, result in zip(program.state, self._next_state, strict=True):
            signal = signal_of(entry)
            name = signal.identifier
            if is_ring(entry):
                lines += self._store(ring_place(name), result, signal)
                lines += advance(name, entry.length)
            elif result != self._argument(entry):
                lines += self._store(name, result, signal)
        return lines

    def _store(self, name: str, result: Expression, signal: Signal) -> list[str]:
        """Write a result in the type of its signal; that it fits has been proved."""
        wording = self._wording
        if signal.kind == "real":
            return assign(name, result, wording)
        if signal.kind == "boolean":
            truth = (
                result.operands[0] if result.code == "number" else Expression("truth", (result,))
            )
            return assign(name, truth, wording)
        return wrapped(name, f"{wording.real}_TO_DINT({wording.expression(result)})")


def _reads(expression: Expression, argument: Expression) -> bool:
    """Whether an expression reads an argument, as a number or as a truth value."""
    parts = (argument, *argument.operands)
    return expression in parts or any(_reads(part, argument) for part in expression.operands)


def _declared(statements: Sequence[ListingStatement], real: str) -> list[tuple[str, str]]:
    """Return name and type of every variable that statements assign, in order."""
    found: list[tuple[str, str]] = []
    for entry in statements:
        if isinstance(entry, Assignment):
            found.append((entry.name, "BOOL" if entry.expression.is_truth else real))
            continue
        if isinstance(entry, CountedLoop):
            found.append((entry.index, "DINT"))
            found += [(turn.oldest, real) for turn in entry.rings if turn.oldest]
        found += _declared(entry.start, real) + _declared(entry.body, real)
    return found
