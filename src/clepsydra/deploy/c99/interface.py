"""The interface of printed C99: names, structures with commented members, prototypes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clepsydra.base.language_words import C_WORDS
from clepsydra.deploy.c99.language import REAL
from clepsydra.deploy.c99.layout import instances
from clepsydra.deploy.c99.structures import WIDTH, Structures, block_name
from clepsydra.deploy.printing.heading import heading
from clepsydra.deploy.printing.identifiers import check_distinct, check_identifier
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.program.called_blocks import called_blocks
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import own_state
from clepsydra.program.program import Program

_NUMBERS: dict[Precision, tuple[str, str]] = {
    "double": (
        "Needs IEEE 754 doubles, evaluated as doubles; the source switches fused multiply-add off",
        "and refuses -ffast-math (clang: no -ffp-contract=fast). Then it equals the simulation.",
    ),
    "single": (
        "Needs IEEE 754 floats, evaluated as floats; the source switches fused multiply-add off",
        "and refuses -ffast-math (clang: no -ffp-contract=fast). The simulation has doubles.",
    ),
}
_NOTES = ("No allocation, no recursion, no static state: one state structure for each instance.",)


def check_names(program: Program) -> None:
    """Refuse names that C does not accept or cannot tell apart.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block
    >>> check_names(Program("law", (), (Signal("tank_1.level"),), (), (), Block(1, (), ())))
    """
    for each in (*called_blocks(program), program):
        place = f"program {each.name}"
        check_identifier(each.name, place, "C", C_WORDS, ignore_case=False)
        for group in (each.inputs, each.parameters, each.outputs):
            check_distinct(_checked(place, group), "C", ignore_case=False)
        called = [(call.identifier, f"{place}, {call.identifier}") for call in instances(each)]
        check_distinct([*_checked(place, own_state(each)), *called], "C", ignore_case=False)
        for name, where in called:
            check_identifier(name, where, "C", C_WORDS, ignore_case=False)


def _checked(place: str, group: Sequence[Entry]) -> Iterator[tuple[str, str]]:
    """Yield the names of members and where they stand; refuse what C does not accept."""
    for entry in group:
        name = signal_of(entry).identifier
        check_identifier(name, f"{place}, {entry.name}", "C", C_WORDS, ignore_case=False)
        yield name, f"{place}, {entry.name}"
        if is_ring(entry):
            yield f"{name}_position", f"{place}, position in {entry.name}"


def print_header(
    program: Program,
    head: Sequence[str],
    origin: Origin | None = None,
    precision: Precision = "double",
) -> str:
    """Print the header: four structures, those of the blocks' states, and four functions.

    Parameters
    ----------
    program : Program
        In its printed form.
    head : sequence of str
        The comment that it begins with.
    origin : Origin, optional
    precision : {"double", "single"}

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> "void double_it_initialise(double_it_state *state);" in print_header(program, [])
    True
    """
    name = program.name
    guard = f"{name.upper()}_H"
    structures = Structures(name, REAL[precision], origin)
    of_blocks = Structures(name, REAL[precision])
    lines = [*head, f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["#include <stdbool.h>", "#include <stdint.h>", ""]
    lines += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    lines += structures.parameters(program)
    for block in called_blocks(program):
        if block.state:
            title = f"What an instance of {block.name} keeps."
            lines += of_blocks.state(block, block_name(name, block), title)
    lines += structures.state(program, name, "State: what the next sample needs.")
    lines += structures.plain(program.inputs, name, "inputs", "Inputs of one sample.")
    lines += structures.plain(program.outputs, name, "outputs", "Outputs of one sample.")
    lines += [
        *(row for what, about in _ABOUT.items() for row in _declared(name, what, about)),
        *("#ifdef __cplusplus", "}", "#endif", ""),
        "#endif",
        "",
    ]
    return "\n".join(lines)


def head_comment(
    program: Program, origin: Origin | None = None, precision: Precision = "double"
) -> list[str]:
    """Return the comment that both files begin with.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> head_comment(program)[0]
    '/* double_it: one sample of a step law, in C99.'
    """
    first, *rest = heading(program, "C99", (*_NUMBERS[precision], *_NOTES), origin)
    return [f"/* {first}", *(f" * {line}" for line in rest), " */", ""]


_ABOUT = {
    "default_parameters": "Sets the parameters' values.",
    "default_inputs": "Sets the inputs to what they are until they are wired.",
    "initialise": "Sets the initial state.",
    "step": "Computes one sample: the outputs and the next state.",
}


def _declared(name: str, what: str, about: str) -> list[str]:
    return [f"/* {about} */", *function_head(name, what, ";"), ""]


#: What the functions of a program take, where NAME stands for its name.
_TAKEN = {
    "default_parameters": ("NAME_parameters *parameters",),
    "default_inputs": ("NAME_inputs *inputs",),
    "initialise": ("NAME_state *state",),
    "step": (
        "const NAME_parameters *parameters",
        "NAME_state *state",
        "const NAME_inputs *inputs",
        "NAME_outputs *outputs",
    ),
}


def function_head(name: str, what: str, end: str = "") -> list[str]:
    """Return the head of a function of a program.

    One argument a line: behind the bracket, or below the name where that is too wide.

    Examples
    --------
    >>> function_head("law", "initialise", ";")
    ['void law_initialise(law_state *state);']
    >>> print("\\n".join(function_head("law", "step")))
    void law_step(const law_parameters *parameters,
                  law_state *state,
                  const law_inputs *inputs,
                  law_outputs *outputs)
    """
    opening = f"void {name}_{what}("
    *others, last = (argument.replace("NAME", name) for argument in _TAKEN[what])
    rows = [*(f"{argument}," for argument in others), f"{last}){end}"]
    if len(opening) + max(map(len, rows)) > WIDTH:
        return [opening, *(f"    {row}" for row in rows)]
    indent = " " * len(opening)
    return [opening + rows[0], *(indent + row for row in rows[1:])]
