"""The interface of printed C99: names, structures with commented members, prototypes."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.heading import comment, commented, heading
from clepsydra.deploy.printing.identifiers import C_WORDS, check_distinct, check_identifier
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.program.program import Program

#: A line with its comment is no wider than this [characters].
WIDTH = 98
_TYPES = {"integer": "int32_t", "boolean": "bool"}
_REAL = {"double": "double", "single": "float"}
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
        kept(program), program.inputs, program.parameters, program.outputs,
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


def kept(program: Program) -> tuple[Entry, ...]:
    """Return what lives from sample to sample: the state, then the rings of loops.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block
    >>> kept(Program("law", (Signal("x"),), (), (), (), Block(1, (), (0,))))[0].name
    'x'
    """
    return (*program.state, *program.rings)


def print_header(
    program: Program, origin: Origin | None = None, precision: Precision = "double"
) -> str:
    """Print the header: four structures and four functions.

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
    structures = _Structures(program, origin, _REAL[precision])
    lines = head_comment(program, origin, precision)
    lines += [f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["#include <stdbool.h>", "#include <stdint.h>", ""]
    lines += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    lines += structures.parameters() + structures.state()
    lines += structures.plain("inputs", "Inputs of one sample.", program.inputs)
    lines += structures.plain("outputs", "Outputs of one sample.", program.outputs)
    lines += [
        "/* Sets the parameters' values. */",
        *default_parameters_head(name, ";"),
        "",
        "/* Sets the inputs to what they are until they are wired. */",
        *default_inputs_head(name, ";"),
        "",
        "/* Sets the initial state. */",
        *initialise_head(name, ";"),
        "",
        "/* Computes one sample: the outputs and the next state. */",
        *step_head(name, ";"),
        "",
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
    arguments = [
        f"const {name}_parameters *parameters", f"{name}_state *state",
        f"const {name}_inputs *inputs", f"{name}_outputs *outputs",
    ]  # fmt: skip
    return _function_head(f"{name}_step", arguments, end)


def initialise_head(name: str, end: str) -> list[str]:
    """Return the head of the function that sets the initial state.

    Examples
    --------
    >>> initialise_head("law", ";")
    ['void law_initialise(law_state *state);']
    """
    return _function_head(f"{name}_initialise", [f"{name}_state *state"], end)


def default_parameters_head(name: str, end: str) -> list[str]:
    """Return the head of the function that sets the parameters' values.

    Examples
    --------
    >>> default_parameters_head("law", ";")
    ['void law_default_parameters(law_parameters *parameters);']
    """
    arguments = [f"{name}_parameters *parameters"]
    return _function_head(f"{name}_default_parameters", arguments, end)


def default_inputs_head(name: str, end: str) -> list[str]:
    """Return the head of the function that sets the inputs' values before they are wired.

    Examples
    --------
    >>> default_inputs_head("law", ";")
    ['void law_default_inputs(law_inputs *inputs);']
    """
    return _function_head(f"{name}_default_inputs", [f"{name}_inputs *inputs"], end)


def _function_head(name: str, arguments: Sequence[str], end: str) -> list[str]:
    """Write one argument a line: behind the bracket, or below the name where that is too wide."""
    opening = f"void {name}("
    rows = [*(f"{argument}," for argument in arguments[:-1]), f"{arguments[-1]}){end}"]
    if len(opening) + max(map(len, rows)) > WIDTH:
        return [opening, *(f"    {row}" for row in rows)]
    indent = " " * len(opening)
    return [opening + rows[0], *(indent + row for row in rows[1:])]


class _Structures:
    """Prints the structures; numbers that come from somewhere say so."""

    def __init__(self, program: Program, origin: Origin | None, real: str) -> None:
        self._program = program
        self._origin = origin
        self._types = {**_TYPES, "real": real}

    def parameters(self) -> list[str]:
        members = [
            line
            for entry in self._program.parameters
            for line in self._member(entry, comment(entry, source=self._source(entry)))
        ]
        return self._structure("parameters", "Parameters: constant or tuned.", members)

    def state(self) -> list[str]:
        members = []
        counted = {ring.name: "turn" for ring in self._program.rings}
        for entry in kept(self._program):
            about = comment(
                entry, source=self._source(entry), counted=counted.get(entry.name, "sample")
            )
            members += self._member(entry, about)
        return self._structure("state", "State: what the next sample needs.", members)

    def plain(self, what: str, title: str, entries: Sequence[Entry]) -> list[str]:
        members = [line for entry in entries for line in self._member(entry, comment(entry))]
        return self._structure(what, title, members)

    def _source(self, entry: Entry) -> str:
        return self._origin.source_of(entry) if self._origin else ""

    def _member(self, entry: Entry, about: str) -> list[str]:
        signal = signal_of(entry)
        size = f"[{entry.length}]" if is_ring(entry) else ""
        member = f"{self._types[signal.kind]} {signal.identifier}{size};"
        lines = commented(member, about, "/*", "*/", WIDTH - 2)
        if size:
            place = f"int32_t {signal.identifier}_position;"
            lines += commented(place, "[1] place of the oldest value", "/*", "*/", WIDTH - 2)
        return [f"  {line}" for line in lines]

    def _structure(self, what: str, title: str, members: Sequence[str]) -> list[str]:
        end = f"}} {self._program.name}_{what};"
        return [f"/* {title} */", "typedef struct {", *(members or [_PLACEHOLDER]), end, ""]
