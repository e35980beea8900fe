"""A step program as a function block: its interface, and its statements."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.deploy.printing.body import Body, Places
from clepsydra.deploy.printing.expressions import decimal
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.line_breaking import dense, folded
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.interface import Interface, block_type, check_names
from clepsydra.deploy.structured_text.pou import Section, Unit, Variable
from clepsydra.deploy.structured_text.wording import Wording
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program


def function_block(
    program: Program,
    dialect: Dialect,
    precision: Precision,
    head: Sequence[str] = (),
    origin: Origin | None = None,
) -> Unit:
    """Return a program as a function block of a dialect; what it calls is declared elsewhere.

    Parameters
    ----------
    program : Program
        In its precision, checked, and with calls that own their state.
    dialect : Dialect
    precision : {"double", "single"}
    head : sequence of str
        Lines of its head comment.
    origin : Origin, optional

    Raises
    ------
    InputError
        A name is none of the language, or the system has no such operation.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> function_block(program, dialect_of("codesys"), "double").body
    ('y := x + x;',)
    """
    check_names(program, dialect)
    return _Printer(program, dialect, precision).unit(head, origin)


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
        declared += [block_type(call.program) for call in program.calls]
        self._names = Identifiers([*declared, program.name, *dialect.all_words], ignore_case=True)
        self._wording = Wording(dialect, precision, self._names)
        self._body = Body(program, self._wording, self._names, Places.of(program))

    def unit(self, head: Sequence[str], origin: Origin | None) -> Unit:
        program, wording = self._program, self._wording
        body = self._body.lines()
        # Only now is known which numbers the system cannot read.
        body = [*self._products(), *body]
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
            tuple(
                part
                for line in dense([wording.marked(line, local) for line in body])
                for part in folded(line)
            ),
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
            for name, values in self._body.tables.items()
        )
        return Section(
            "VAR", "CONSTANT" if self._dialect.constant_arrays else "", (("tables", tables),)
        )

    def _temporaries(self) -> Section:
        kinds = dict.fromkeys(self._wording.products, self._wording.real)
        kinds |= self._body.temporaries()
        by_type = sorted(kinds.items(), key=lambda each: each[1])
        variables = tuple(Variable(name, kind) for name, kind in by_type)
        return Section("VAR_TEMP", "", (("values of one sample", variables),))
