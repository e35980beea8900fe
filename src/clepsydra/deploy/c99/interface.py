"""The interface of printed C99: names, structures with commented members, prototypes."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.heading import comment, commented, heading
from clepsydra.deploy.printing.identifiers import C_WORDS, check_distinct, check_identifier
from clepsydra.program.program import Program

_TYPES = {"real": "double", "integer": "int32_t", "boolean": "bool"}
_WIDTH = 98
_NOTES = (
    "Needs IEEE 754 doubles, evaluated as doubles and without fused multiply-add",
    "(gcc, clang: -ffp-contract=off, never -ffast-math); then it equals the simulation.",
    "No allocation, no recursion, no static state: one state structure for each instance.",
)
_PLACEHOLDER = "  char nothing; /* a structure of C99 has at least one member */"


def check_names(program: Program) -> None:
    """Refuse names that C does not accept or cannot tell apart.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block
    >>> check_names(Program("law", (), (Signal("tank_1.level"),), (), (), Block(1, (), ())))
    """
    place = f"program {program.name}"
    check_identifier(program.name, place, "C", C_WORDS, ignore_case=False)
    groups: list[Sequence[Entry]] = [
        program.state, program.inputs, program.parameters, program.outputs,
    ]  # fmt: skip
    for group in groups:
        entries = []
        for entry in group:
            name = signal_of(entry).identifier
            check_identifier(name, f"{place}, {entry.name}", "C", C_WORDS, ignore_case=False)
            entries.append((name, f"{place}, {entry.name}"))
            if is_ring(entry):
                entries.append((f"{name}_position", f"{place}, position in {entry.name}"))
        check_distinct(entries, "C", ignore_case=False)


def print_header(program: Program) -> str:
    """Print the header: four structures and three functions.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> "void double_it_initialise(double_it_state *state);" in print_header(program)
    True
    """
    name = program.name
    guard = f"{name.upper()}_H"
    lines = head_comment(program)
    lines += [f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["#include <stdbool.h>", "#include <stdint.h>", ""]
    lines += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    lines += _structure(f"{name}_parameters", "Parameters: constant or tuned.", program.parameters)
    lines += _structure(f"{name}_state", "State: what the next sample needs.", program.state)
    lines += _structure(f"{name}_inputs", "Inputs of one sample.", program.inputs)
    lines += _structure(f"{name}_outputs", "Outputs of one sample.", program.outputs)
    lines += [
        "/* Sets the parameters' values. */",
        f"void {name}_default_parameters({name}_parameters *parameters);",
        "",
        "/* Sets the initial state. */",
        f"void {name}_initialise({name}_state *state);",
        "",
        "/* Computes one sample: the outputs and the next state. */",
        *step_head(name, ";"),
        "",
        *("#ifdef __cplusplus", "}", "#endif", ""),
        "#endif",
        "",
    ]
    return "\n".join(lines)


def head_comment(program: Program) -> list[str]:
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
    first, *rest = heading(program, "C99", _NOTES)
    return [f"/* {first}", *(f" * {line}" for line in rest), " */", ""]


def step_head(name: str, end: str) -> list[str]:
    """Return the head of the function that computes one sample.

    Examples
    --------
    >>> print("\\n".join(step_head("law", ";")))
    void law_step(const law_parameters *parameters,
                  law_state *state,
                  const law_inputs *inputs,
                  law_outputs *outputs);
    """
    indent = " " * len(f"void {name}_step(")
    return [
        f"void {name}_step(const {name}_parameters *parameters,",
        f"{indent}{name}_state *state,",
        f"{indent}const {name}_inputs *inputs,",
        f"{indent}{name}_outputs *outputs){end}",
    ]


def _structure(name: str, title: str, entries: Sequence[Entry]) -> list[str]:
    lines = [f"/* {title} */", "typedef struct {"]
    for entry in entries:
        signal = signal_of(entry)
        size = ""
        if is_ring(entry):
            size = f"[{entry.length}]"
        member = f"{_TYPES[signal.kind]} {signal.identifier}{size};"
        lines += [f"  {line}" for line in commented(member, comment(entry), "/*", "*/", _WIDTH)]
        if size:
            lines.append(
                f"  int32_t {signal.identifier}_position; /* [1] place of the oldest value */"
            )
    if not entries:
        lines.append(_PLACEHOLDER)
    return [*lines, f"}} {name};", ""]
