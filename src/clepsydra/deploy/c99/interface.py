"""The interface of printed C99: names, structures with commented members, prototypes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from clepsydra.base.language_words import C_WORDS
from clepsydra.deploy.c99.statements import C99
from clepsydra.deploy.printing.declarations import Variable, check_scope, declared, records_of
from clepsydra.deploy.printing.heading import commented, heading
from clepsydra.deploy.printing.identifiers import NameRules
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.called_blocks import called_blocks
from clepsydra.program.owned_state import own_state
from clepsydra.program.program import Call, Program

#: A line with its comment is no wider than this [characters].
WIDTH = 98
_PLACEHOLDER = "char nothing; /* a structure of C99 has at least one member */"
_EQUAL = {"double": "Then it equals the simulation.", "float": "The simulation has doubles."}
_RULES = NameRules("C", C_WORDS)
#: What the functions of a program do, and the structures that they take.
_FUNCTIONS = {
    "default_parameters": ("Sets the parameters' values.", "parameters"),
    "default_inputs": ("Sets the inputs to what they are until they are wired.", "inputs"),
    "initialise": ("Sets the initial state.", "state"),
    "step": (
        "Computes one sample: the outputs and the next state.",
        "const parameters, state, const inputs, outputs",
    ),
}


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
        _RULES.check(each.name, place)
        groups = (each.inputs, each.parameters, each.outputs, own_state(each))
        for group, calls in zip(groups, ((), (), (), instances(each)), strict=True):
            check_scope(place, group, calls, _RULES)


def structure(name: str, what: str, title: str, variables: Iterable[Variable]) -> list[str]:
    """Return a structure of a program or of one of its blocks.

    Parameters
    ----------
    name : str
        What the names of its types begin with.
    what : str
        What the structure holds.
    title : str
        The comment above it.
    variables : iterable of Variable

    Examples
    --------
    >>> print("\\n".join(structure("law", "inputs", "Inputs.", [Variable("u", "double")])))
    /* Inputs. */
    typedef struct {
      double u;
    } law_inputs;
    <BLANKLINE>
    """
    members = []
    for each in variables:
        size = f"[{each.length}]" if each.length else ""
        line = f"{each.type} {each.name}{size};"
        wide = what == "state" and each.is_block and len(line) > WIDTH - 2
        members += [each.type, f"    {each.name};"] if wide else remarked(line, each.comment, 2)
    members = indented(members or [_PLACEHOLDER])
    return [f"/* {title} */", "typedef struct {", *members, f"}} {name}_{what};", ""]


def remarked(line: str, text: str, indent: int) -> list[str]:
    """Return a line of C with a comment, if there is any, that is to be indented.

    Examples
    --------
    >>> remarked("double u;", "[V]", 2)
    ['double u; /* [V] */']
    """
    return commented(line, text, "/*", "*/", WIDTH - indent)


def state_structure(
    program: Program, language: C99, name: str, title: str, origin: Origin | None = None
) -> list[str]:
    """Return the structure of what a program or a block keeps, its instances inside.

    Parameters
    ----------
    program : Program
    language : C99
    name, title : str
        See `structure`.
    origin : Origin, optional
        Where the numbers of the program come from; those of a block differ by instance.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block
    >>> law = Program("law", (Signal("x"),), (), (), (), Block(1, (), (0,)))
    >>> state_structure(law, C99("law", "double"), "law", "State.")[2]
    '  double x; /* [1] */'
    """
    kept = declared(own_state(program), language, origin, program.rings)
    for call in instances(program):
        kind = f"{language.record(call.program.name)}_state"
        kept += (Variable(call.identifier, kind, is_block=True),)
    return structure(name, "state", title, kept)


def instances(program: Program) -> tuple[Call, ...]:
    """Return the calls of a printed program whose instances keep something."""
    return tuple(call for call in program.calls if call.program.state)


def print_header(
    program: Program, head: Sequence[str], language: C99, origin: Origin | None = None
) -> str:
    """Print the header: four structures, those of the blocks' states, and four functions.

    Parameters
    ----------
    program : Program
        In its printed form.
    head : sequence of str
        The comment that it begins with.
    language : C99
    origin : Origin, optional

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> text = print_header(program, [], C99("double_it", "double"))
    >>> "void double_it_initialise(double_it_state *state);" in text
    True
    """
    name = program.name
    guard = f"{name.upper()}_H"
    lines = [*head, f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["#include <stdbool.h>", "#include <stdint.h>", ""]
    lines += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    parameters = declared(program.parameters, language, origin)
    lines += structure(name, "parameters", "Parameters: constant or tuned.", parameters)
    for block in called_blocks(program):
        if block.state:
            title = f"What an instance of {block.name} keeps."
            lines += state_structure(block, language, language.record(block.name), title)
    lines += state_structure(program, language, name, "State: what the next sample needs.", origin)
    for kind, members in records_of((*called_blocks(program), program), language).items():
        what = kind.removeprefix(f"{name}_")
        lines += structure(name, what, f"Outputs that belong together: {what}.", members)
    for what, entries in (("inputs", program.inputs), ("outputs", program.outputs)):
        title = f"{what.capitalize()} of one sample."
        lines += structure(name, what, title, declared(entries, language))
    for what, (about, _) in _FUNCTIONS.items():
        lines += [f"/* {about} */", *function_head(name, what, ";"), ""]
    return "\n".join([*lines, "#ifdef __cplusplus", "}", "#endif", "", "#endif", ""])


def head_comment(program: Program, language: C99, origin: Origin | None = None) -> list[str]:
    """Return the comment that both files begin with.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> head_comment(program, C99("double_it", "double"))[0]
    '/* double_it: one sample of a step law, in C99.'
    """
    real = language.types["real"]
    notes = (
        f"Needs IEEE 754 {real}s, evaluated as {real}s; the source switches fused multiply-add off",
        f"and refuses -ffast-math (clang: no -ffp-contract=fast). {_EQUAL[real]}",
        "No allocation, no recursion, no static state: one state structure for each instance.",
    )
    first, *rest = heading(program, "C99", notes, origin)
    return [f"/* {first}", *(f" * {line}" for line in rest), " */", ""]


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
    pointed = re.sub(r"(\w+)(,|$)", rf"{name}_\1 *\1\2", _FUNCTIONS[what][1])
    rows = f"{pointed}){end}".replace(", ", ",\n").split("\n")
    if len(opening) + max(map(len, rows)) > WIDTH:
        return [opening, *(f"    {row}" for row in rows)]
    indent = " " * len(opening)
    return [opening + rows[0], *(indent + row for row in rows[1:])]
