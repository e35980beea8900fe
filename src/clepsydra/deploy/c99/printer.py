"""C99 from a step program: one header and one source, without allocation or recursion."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from clepsydra.base.language_words import C_WORDS
from clepsydra.deploy.c99.interface import (
    WIDTH,
    check_names,
    function_head,
    head_comment,
    print_header,
    remarked,
    structure,
)
from clepsydra.deploy.c99.statements import C99, arithmetic_check
from clepsydra.deploy.printing.body import Body, places_of
from clepsydra.deploy.printing.declarations import declared
from clepsydra.deploy.printing.heading import (
    comment,
    enclosed,
    harmless,
    number_comment,
    table_comment,
)
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.lines import folded, indented
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.whole_numbers import printed_form
from clepsydra.program.called_blocks import called_blocks
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import state_paths
from clepsydra.program.precision import Precision, in_precision
from clepsydra.program.program import Program


@dataclass(frozen=True)
class CSource:
    """A printed program: the texts of its two files.

    Parameters
    ----------
    name : str
        The program's name, from which the files get theirs.
    header, source : str
    """

    name: str
    header: str
    source: str

    @property
    def header_name(self) -> str:
        """File name of the header, as the source includes it."""
        return f"{self.name}.h"

    @property
    def source_name(self) -> str:
        """File name of the source."""
        return f"{self.name}.c"


def print_c(
    program: Program, *, origin: Origin | None = None, precision: Precision = "double"
) -> CSource:
    """Print a step program as C99.

    ``NAME_initialise`` sets the initial state, ``NAME_default_parameters`` the parameters'
    values, and ``NAME_step`` computes one sample: it reads parameters, state and inputs,
    writes outputs and the next state. Integer signals are ``int32_t``, boolean ones ``bool``,
    all others ``double`` or ``float`` in their unit. A block that the program calls becomes
    one static function ``NAME_BLOCK_step``, and each instance a member of the state.

    Parameters
    ----------
    program : Program
        Without fused operations.
    origin : Origin, optional
        What the head says of it, and where its numbers come from.
    precision : {"double", "single"}
        double or float.

    Raises
    ------
    InputError
        It is no program, an operation is fused, a name is no identifier of C, two names become
        one, an integer or boolean result may be something else, or a number or a count is
        outside single precision.
    ValueError
        Two blocks of one name compute different things, or one is called inside a loop.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_c(program).source.splitlines()[-2:]
    ['  outputs->y = inputs->x + inputs->x;', '}']
    """
    printed = printed_form(program, precision)
    language = C99(program.name, precision)
    head = head_comment(in_precision(program, precision), language, origin)
    check_names(printed)
    header = print_header(printed, head, language, origin)
    return CSource(program.name, header, _Source(printed, language, origin).text(head))


_ASSIGNED = re.compile(r"( *)(\w+) = ")


class _Source:
    def __init__(self, program: Program, language: C99, origin: Origin | None) -> None:
        self._program, self._language, self._origin = program, language, origin
        parts = ("state", "inputs", "parameters", "outputs")
        functions = ("step", "initialise", "default_parameters", "default_inputs")
        #: Names of the file, which no variable may have.
        self._taken = {*C_WORDS, *language.functions.values(), *parts}
        for each in (program.name, *(language.record(b.name) for b in called_blocks(program))):
            self._taken |= {f"{each}_{what}" for what in (*parts, *functions)}

    def text(self, head: Sequence[str]) -> str:
        program, language = self._program, self._language
        lines = [row for block in called_blocks(program) for row in self._block(block)]
        groups = ("parameters", "inputs", "state")
        tables, step = self._body(program, places_of(program, "->"), groups)
        lines += tables
        for where in groups[:2]:
            members = ((each.identifier, each) for each in getattr(program, where))
            lines += self._set(f"default_{where}", where, members)
        paths = [
            *map(".".join, state_paths(program)),
            *(r.signal.identifier for r in program.rings),
        ]
        state = zip(paths, (*program.state, *program.rings), strict=True)
        lines += self._set("initialise", "state", state)
        lines += [*function_head(program.name, "step"), *step]
        functions = "|".join(filter(str.isalnum, language.functions.values()))
        code = re.sub(r"/\*.*?\*/", "", "\n".join(lines), flags=re.DOTALL)
        called = re.search(rf"(?<![\w>.])(?:(?:{functions})\(|{language.infinity}\b)", code)
        opening = [*head, f'#include "{program.name}.h"', "", "#include <float.h>"]
        opening += ["#include <math.h>"] if called else []
        return "\n".join([*opening, "", *arithmetic_check(language.precision), *lines])

    def _block(self, program: Program) -> list[str]:
        """Return the function of a block, with its tables and the structure of its outputs.

        Inputs come by their values, state and outputs by pointers.
        """
        language, name = self._language, self._language.record(program.name)
        names = Identifiers(self._taken, ignore_case=False)
        inputs = [names.new(signal.identifier) for signal in program.inputs]
        lines, body = self._body(program, places_of(program, "->") | {"inputs": inputs}, inputs)
        if program.outputs:
            outputs = declared(program.outputs, language)
            lines += structure(name, "outputs", f"Outputs of {program.name}.", outputs)
        taken = [(f"{name}_state *state", "")] if program.state else []
        for signal, local in zip(program.inputs, inputs, strict=True):
            taken.append((f"{language.types[signal.kind]} {local}", comment(signal)))
        taken += [(f"{name}_outputs *outputs", "")] if program.outputs else []
        told = harmless(" ".join([f"One sample of {program.name}.", *program.description]))
        lines += enclosed(textwrap.wrap(told, WIDTH - 6), "/*", "*/")
        lines.append(f"static void {name}_step(")
        for place, (argument, about) in enumerate(taken, 1):
            argument += "," if place < len(taken) else ")"
            lines += [f"    {row}" for row in remarked(argument, about, 4)]
        return [*lines, *body]

    def _body(
        self, program: Program, places: Mapping[str, Sequence[str]], arguments: Iterable[str]
    ) -> tuple[list[str], list[str]]:
        """Return the tables of a function, and its statements in braces."""
        language, tables, constants = self._language, list[str](), list[str]()
        names = Identifiers({*self._taken, *places["inputs"]}, ignore_case=False)
        body = Body(program, language, names, places)
        self._taken |= body.tables.keys()
        for name, table in body.tables.items():
            texts = ", ".join(map(language.number, table.values))
            tables += [
                f"/* {table.description or table_comment(self._origin)} */",
                f"static const {language.types['real']} {name}[{len(table.values)}] = {{",
                *indented(textwrap.wrap(f"{texts},", WIDTH - 2, break_on_hyphens=False)),
                "};",
                "",
            ]
        for name, signal in body.constants.items():
            kind, value = language.types[signal.kind], language.initial(signal)
            constants += remarked(f"static const {kind} {name} = {value};", comment(signal), 2)
        # Loops beside each other use them.
        real, whole = language.types["real"], body.arrays.items()
        arrays = [f"{real} {name}{language.dimension(each)};" for name, each in whole]
        own = {name: kind for name, kind in body.temporaries.items() if name not in body.arrays}
        lines = [*arrays, *_declared(body.lines, own)]
        code = "\n".join(line for line in lines if not line.lstrip().startswith("/*"))
        unread = (each for each in arguments if not re.search(rf"(?<![\w>.]){each}\b", code))
        lines = [*(f"(void){each};" for each in unread), *lines]
        if program is self._program and not program.outputs:
            lines.append("outputs->nothing = 0;")
        wrapped = (row for line in indented(lines) for row in folded(line, WIDTH))
        return tables, ["{", *indented(constants), *wrapped, "}", ""]

    def _set(self, what: str, where: str, members: Iterable[tuple[str, Entry]]) -> list[str]:
        """Return a function that sets the members of a structure."""
        lines: list[str] = []
        for name, entry in members:
            member = f"{where}->{name}"
            if is_ring(entry):
                number = indented(self._number(f"{member}[i]", entry, 4))
                lines.append(f"for (int32_t i = 0; i < {entry.length}; ++i) {{")
                lines += [*number, "}", f"{member}_position = 0;"]
            else:
                lines += self._number(member, entry)
        lines = lines or [f"{where}->nothing = 0;"]
        return [*function_head(self._program.name, what), "{", *indented(lines), "}", ""]

    def _number(self, left: str, entry: Entry, indent: int = 2) -> list[str]:
        """Write an initial value, with its unit and where it comes from."""
        # Nobody has chosen what an input is: only numbers that stay have a source.
        stays = entry not in self._program.inputs
        source = self._origin.source_of(entry) if self._origin and stays else ""
        line = f"{left} = {self._language.initial(signal_of(entry))};"
        return remarked(line, number_comment(entry, source), indent)


def _declared(lines: list[str], kinds: dict[str, str]) -> list[str]:
    """Return statements that declare each of their own variables where it is first assigned."""
    times = Counter(name for line in lines for name in re.findall(r"(?<![\w.>])(\w+) = ", line))
    written = []
    for line in lines:
        found = _ASSIGNED.match(line)
        if found and (kind := kinds.pop(found[2], "")):
            constant = "const " if times[found[2]] == 1 else ""
            line = f"{found[1]}{constant}{kind} {line.lstrip()}"
        written.append(line)
    return written
