"""IEC 61131-3 Structured Text from a step program: a FUNCTION_BLOCK for each of its blocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from clepsydra.deploy.printing.declarations import Variable, declared, records_of
from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.heading import heading
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.whole_numbers import printed_form
from clepsydra.deploy.structured_text.dialect import OWN, Dialect, dialect_of
from clepsydra.deploy.structured_text.function_block import ZEROS, block_type, function_block
from clepsydra.deploy.structured_text.instances import remembering, with_block_names
from clepsydra.deploy.structured_text.pou import Section, Unit, comment_lines, unit_text
from clepsydra.deploy.structured_text.statements import REAL, StructuredText
from clepsydra.program.called_blocks import called_blocks
from clepsydra.program.precision import Precision, in_precision
from clepsydra.program.program import Program

# A double of this size or above is a whole number already, and so is a single-precision number.
_WHOLE = {"double": 2.0**52, "single": 2.0**23}
# Quotient and rest by this divisor fit a DINT for every smaller double, and both are exact.
_SPLIT = 2.0**21
_ABOUT = {
    "maximum": "the larger of two numbers; b where they are equal or one is not a number.",
    "minimum": "the smaller of two numbers; b where they are equal or one is not a number.",
    "floor": "the largest whole number not above a number, with its zero's sign.",
    "ceiling": "the smallest whole number not below a number, with its zero's sign.",
}
_NOTES = (
    "simulation in that precision. Call it once in every sampling period. Parameters are inputs",
    "with defaults.",
)


def print_structured_text(
    program: Program,
    *,
    origin: Origin | None = None,
    precision: Precision = "double",
    dialect: str = "codesys",
) -> str:
    """Print a step program as a FUNCTION_BLOCK of IEC 61131-3, third edition.

    Before it stand the function blocks of what it calls, each once however many instances it
    has; what an instance remembers lives in the instance.

    Inputs and parameters are VAR_INPUT (parameters with their value as default), outputs
    VAR_OUTPUT, the state VAR RETAIN with its initial value, so that a warm start keeps it; real
    signals are LREAL or REAL in their unit, integer ones DINT, boolean ones BOOL. The
    operations of `clepsydra.program.program.EXACT` compute every bit of the simulation; the
    functions EXP, LN, SIN … are the target's own and may differ in the last bits.

    Parameters
    ----------
    program : Program
        Without fused operations.
    origin : Origin, optional
        What the head says of it, and where its numbers come from.
    precision : {"double", "single"}
        LREAL or REAL.
    dialect : {"codesys", "matiec", "scl"}
        For CODESYS and TwinCAT 3, for OpenPLC and Beremiz, or for Siemens TIA Portal.

    Raises
    ------
    InputError
        It is no program, an operation is fused or the system has none of it, a number is not
        finite or outside the range of REAL or of what the system reads, a name is no identifier
        or a word of the language, two names differ in case only, or an integer or boolean result
        may be something else.
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_structured_text(program).splitlines()[-2:]
    ['y := x + x;', 'END_FUNCTION_BLOCK']
    >>> print_structured_text(program, dialect="scl").splitlines()[-3:]
    ['BEGIN', '#y := #x + #x;', 'END_FUNCTION_BLOCK']
    """
    spoken = dialect_of(dialect)
    *library, main = function_blocks(program, spoken, precision, origin)
    lines: list[str] = []
    if library and not spoken.attributes:
        # Who opens the file reads first what it is; the blocks that it calls have to come before.
        lines += [*comment_lines(main.head, spoken), ""]
        main = replace(main, head=())
    for unit in (*library, main):
        lines += [*unit_text(unit, spoken), ""]
    return "\n".join(lines)


def function_blocks(
    program: Program, dialect: Dialect, precision: Precision, origin: Origin | None = None
) -> tuple[Unit, ...]:
    """Return a step program as function blocks: first what it calls, itself last.

    The state of a call lives in its instance where nothing else reads it. Its start values are
    inputs: a retained state of the instance says whether it has run.

    Raises
    ------
    InputError
        See `clepsydra.deploy.structured_text.printer.print_structured_text`.
    ValueError
        Two blocks of one name compute something else.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.program.program import Block, Call, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("flow_total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "feed", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> units = function_blocks(law, dialect_of("codesys"), "double")
    >>> [unit.name for unit in units], units[-1].body[0]
    (['FB_FlowTotal', 'law'], 'feed(u := u, y => y);')
    """
    printed = printed_form(program, precision)
    main = with_block_names(printed, dialect.all_words)
    library = []
    # What the program says of its inputs, and structures of their members, is not said again.
    wording = StructuredText(dialect, precision)
    own = [
        *main.inputs,
        *main.parameters,
        *(signal.port for signal in (*main.inputs, *main.parameters)),
    ]
    types = records_of((*called_blocks(main), main), wording)
    told = {replace(each, initial=()) for each in declared(own, wording)}
    told.update(*types.values())
    for block in called_blocks(main):
        name = block_type(block)
        head = (f"{name}:", *block.description)
        named = replace(remembering(block), name=name)
        unit = function_block(named, dialect, precision, head)
        library.append(replace(unit, sections=tuple(_told_once(s, told) for s in unit.sections)))
    exact = f"{REAL[precision]} must be the IEEE 754 {precision}, without fused multiply-add:"
    notes = (f"{exact} then it equals the", *_NOTES)
    about = heading(in_precision(program, precision), "IEC 61131-3 Structured Text", notes, origin)
    blocks = (*library, function_block(main, dialect, precision, about, origin))
    return (
        *(_structure(name, members) for name, members in types.items()),
        *_called_functions(blocks, dialect, precision),
        *blocks,
    )


def _structure(name: str, members: Sequence[Variable]) -> Unit:
    """Return the type of a structure that a program or its blocks give."""
    return Unit("TYPE", name, (), (Section("STRUCT", "", (("members", tuple(members)),)),), ())


#: What is said of a number that has neither unit nor words.
_NO_WORDS = "[1]"


def _told_once(section: Section, told: set[Variable]) -> Section:
    """Return the declarations of a block, without what another one has said of the same name.

    They are wired, so they begin with no value of their own; what needs no comment stands last.
    """
    groups = []
    for title, variables in section.groups:
        found = []
        for each in variables:
            each = replace(each, initial=() if each.initial in ZEROS else each.initial)
            silent = each in told or each.comment == _NO_WORDS
            found.append(replace(each, comment="") if silent else each)
            told.add(each)
        found.sort(key=lambda each: "" if each.comment else each.type)
        groups.append((title, tuple(found)))
    return replace(section, groups=tuple(groups))


def _called_functions(
    units: Iterable[Unit], dialect: Dialect, precision: Precision
) -> tuple[Unit, ...]:
    """Return the functions of `OWN` that units call."""
    text = "\n".join(line for unit in units for line in unit.body)
    return tuple(
        _function(code, StructuredText(dialect, precision))
        for code, name in OWN.items()
        if f"{dialect.quoted(name)}(" in text
    )


def _function(code: str, wording: StructuredText) -> Unit:
    name = OWN[code]
    lines, inputs = _whole(code, wording), "a"
    if code in ("maximum", "minimum"):
        a, b = variable("a"), variable("b")
        larger = Expression("less" if code == "minimum" else "greater", (a, b))
        lines, inputs = wording.assign(name, Expression("select", (larger, a, b))), "ab"
    variables = tuple(Variable(each, wording.real) for each in inputs)
    return Unit(
        "FUNCTION",
        name,
        (f"{name}: {_ABOUT[code]}",),
        (Section("VAR_INPUT", "", (("", variables),)),),
        tuple(wording.marked(line, {*inputs, name.lower()}) for line in lines),
        wording.real,
    )


def _whole(code: str, wording: StructuredText) -> list[str]:
    """Write a number cut off, and corrected.

    The standard has a cut-off to a DINT only. A double is cut off in two parts that both fit; a
    single-precision number that is not whole fits at once. The product with zero keeps the sign
    of zero; not a number and infinity stay what they are.
    """
    name, (beyond, back) = OWN[code], (">", "-") if code == "floor" else ("<", "+")
    one, zero, split = map(wording.literal, (1.0, 0.0, _SPLIT))

    def cut(value: str) -> str:
        return f"DINT_TO_{wording.real}({wording.dialect.truncate}({value}))"

    parts = [f"  {name} := {cut('a')};"]
    if wording.precision == "double":
        parts = [
            f"  {name} := {split} * {cut(f'a / {split}')};",
            f"  {name} := {name} + {cut(f'a - {name}')};",
        ]
    return [
        f"{name} := a;",
        f"IF ABS(a) < {wording.literal(_WHOLE[wording.precision])} THEN",
        *parts,
        f"  IF {name} {beyond} a THEN {name} := {name} {back} {one}; END_IF;",
        f"  IF {name} = {zero} THEN {name} := a * {zero}; END_IF;",
        "END_IF;",
    ]
