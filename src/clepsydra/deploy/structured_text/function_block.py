"""A step program as a function block: its interface, and its statements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.body import Body, places_of
from clepsydra.deploy.printing.decimal_text import decimal
from clepsydra.deploy.printing.declarations import Variable, check_scope, declared
from clepsydra.deploy.printing.lines import folded
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.pou import Section, Unit
from clepsydra.deploy.structured_text.statements import StructuredText, joined
from clepsydra.program.entries import signal_of
from clepsydra.program.owned_state import own_state
from clepsydra.program.precision import Precision
from clepsydra.program.program import Program

#: What a variable is that is declared without a value.
ZEROS = (("0.0",), ("0",), ("FALSE",))


def block_type(block: Program) -> str:
    """Return what a block that is called is named as a function block.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> block_type(Program("signal_check", (), (), (), (), Block(0, (), ())))
    'FB_SignalCheck'
    """
    return f"FB_{joined(block.name)}"


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
    _check_names(program, dialect)
    entries = (*program.state, *program.rings, *program.inputs, *program.parameters)
    taken = [signal_of(entry).variable for entry in (*entries, *program.outputs)]
    taken += [f"{name}_position" for name in taken]
    taken += [program.name, *(block_type(call.program) for call in program.calls)]
    wording = StructuredText(dialect, precision, taken)
    body = Body(program, wording, wording.names, places_of(program))
    temporaries = dict.fromkeys(wording.products, wording.real) | body.temporaries
    by_type = sorted(temporaries.items(), key=lambda each: each[1])
    variables = tuple(Variable(name, kind) for name, kind in by_type)
    arrays = _arrays(body, wording)
    declarations = (
        *_sections(program, wording, origin),
        *_constants(body, wording),
        # matiec translates no array of VAR_TEMP into C.
        Section("VAR", "", (("arrays of one sample", arrays),)),
        Section("VAR_TEMP", "", (("values of one sample", variables),)),
    )
    local = {entry.name.lower() for section in declarations for entry in section.variables}
    lines = (wording.marked(line, local) for line in (*_products(wording), *body.lines))
    text = tuple(part for line in lines for part in folded(line))
    return Unit("FUNCTION_BLOCK", program.name, tuple(head), declarations, text)


def _check_names(program: Program, dialect: Dialect) -> None:
    """Refuse names that a dialect does not accept or cannot tell apart."""
    place, rules = f"program {program.name}", dialect.names
    rules.check(program.name, place)
    for call in program.calls:
        rules.check(block_type(call.program), f"block {call.program.name}")
    signals = (*program.inputs, *program.parameters, *program.outputs, *own_state(program))
    check_scope(place, (Signal(program.name), *signals), program.calls, rules)


def _sections(program: Program, wording: StructuredText, origin: Origin | None) -> list[Section]:
    """Return the declarations of inputs, parameters, outputs, instances and state of a program."""
    inputs = ("inputs of one sample", declared(program.inputs, wording))
    parameters = ("parameters", declared(program.parameters, wording, origin))
    # An output begins with zero by itself.
    shown = tuple(
        replace(each, initial=() if each.initial in ZEROS else each.initial)
        for each in declared(program.outputs, wording)
    )
    instances = (
        Variable(call.identifier, block_type(call.program), is_block=True) for call in program.calls
    )
    blocks = tuple(sorted(instances, key=lambda instance: instance.type))
    state = declared(own_state(program), wording, origin, program.rings)
    return [
        Section("VAR_INPUT", "", (inputs, parameters)),
        Section("VAR_OUTPUT", "", (("outputs", shown),)),
        Section("VAR", "", (("blocks", blocks),)),
        Section("VAR", "RETAIN", (("state", state),)),
    ]


def _products(wording: StructuredText) -> list[str]:
    """Return what computes the numbers that the system cannot read."""
    lines = []
    for name, (number, product) in wording.products.items():
        why = f"{name} is {decimal(number)}, beyond the numbers that the system reads"
        rows = (" * ".join(product[k : k + 3]) for k in range(0, len(product), 3))
        text = "\n    * ".join(rows)
        lines += [wording.dialect.commented(why), *f"{name} := {text};".splitlines()]
    return lines


def _arrays(body: Body, wording: StructuredText) -> tuple[Variable, ...]:
    found = []
    for name, array in body.arrays.items():
        place = f"an entry of {name}"
        texts = tuple(wording.number(value, place) for value in array.initial)
        found += [Variable(name, wording.real, texts, array.length)] if array.length else []
    return tuple(found)


def _constants(body: Body, wording: StructuredText) -> list[Section]:
    constants = body.constants.items()
    named = [replace(declared([each], wording)[0], name=name) for name, each in constants]
    tables = []
    for name, table in body.tables.items():
        texts = tuple(wording.number(value, f"an entry of {name}") for value in table.values)
        tables.append(Variable(name, wording.real, texts, len(texts), table.description))
    groups = ("numbers", tuple(named)), ("tables", tuple(tables))
    if wording.dialect.constant_arrays:
        return [Section("VAR", "CONSTANT", groups)]
    return [Section("VAR", "CONSTANT", groups[:1]), Section("VAR", "", groups[1:])]
