"""The step functions of printed C99: that of a program, and one for each of its blocks."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Iterable

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.interface import function_head
from clepsydra.deploy.c99.statements import C99
from clepsydra.deploy.c99.structures import WIDTH, remarked, structure
from clepsydra.deploy.printing.body import Body, places_of
from clepsydra.deploy.printing.declarations import declared
from clepsydra.deploy.printing.heading import comment, enclosed, harmless
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.lines import folded, indented
from clepsydra.program.program import Program

_ASSIGNED = re.compile(r"( *)(\w+) = ")


class StepFunction:
    """What a step function does with a program in its printed form.

    Parameters
    ----------
    program : Program
    language : C99
    taken : iterable of str
        Names of the file, which no variable may have.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> StepFunction(program, C99("double_it", "double"), []).text()[-3:-1]
    ['  outputs->y = inputs->x + inputs->x;', '}']
    """

    def __init__(self, program: Program, language: C99, taken: Iterable[str]) -> None:
        self._program, self._language = program, language
        names = Identifiers(taken, ignore_case=False)
        places = self._places(names)
        body = Body(program, language, names, places)
        #: Tables of the loops by name.
        self.tables = body.tables
        self.lines = _declared(body.lines, body.temporaries)
        self.constants = [row for each in body.constants.items() for row in self._constant(*each)]

    def _places(self, names: Identifiers) -> dict[str, list[str]]:
        return places_of(self._program, "->")

    def _constant(self, name: str, signal: Signal) -> list[str]:
        language = self._language
        line = f"static const {language.types[signal.kind]} {name} = {language.initial(signal)};"
        return remarked(line, comment(signal), 2)

    def reads(self, text: str) -> bool:
        """Whether some text stands in the statements, behind no part of a name."""
        code = "\n".join(line for line in self.lines if not line.lstrip().startswith("/*"))
        return re.search(rf"(?<![\w>.]){text}", code) is not None

    def text(self) -> list[str]:
        """Return the lines of the function that computes one sample."""
        program = self._program
        groups = ("parameters", "inputs", "state")
        unread = [where for where in groups if not self.reads(f"{where}->")]
        lines = [*(f"(void){where};" for where in unread), *self.lines]
        lines += [] if program.outputs else ["outputs->nothing = 0;"]
        head = [*function_head(program.name, "step"), "{"]
        return [*head, *indented(self.constants), *_wrapped(lines), "}", ""]


class BlockFunction(StepFunction):
    """The step function of a block: inputs come by their values, state and outputs by pointers.

    Parameters
    ----------
    As those of `StepFunction`.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> block = Program("twice", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print("\\n".join(BlockFunction(block, C99("law", "double"), []).text()[5:]))
    /* One sample of twice. */
    static void law_twice_step(
        double x, /* [1] */
        law_twice_outputs *outputs)
    {
      outputs->y = x + x;
    }
    <BLANKLINE>
    """

    def _places(self, names: Identifiers) -> dict[str, list[str]]:
        self._inputs = [names.new(signal.identifier) for signal in self._program.inputs]
        return {**super()._places(names), "inputs": self._inputs}

    def text(self) -> list[str]:
        """Return the structure of the outputs, and the function."""
        program, types = self._program, self._language.types
        name = self._language.record(program.name)
        lines = []
        if program.outputs:
            outputs = declared(program.outputs, self._language)
            lines = structure(name, "outputs", f"Outputs of {program.name}.", outputs)
        taken = [(f"{name}_state *state", "")] if program.state else []
        for signal, local in zip(program.inputs, self._inputs, strict=True):
            taken.append((f"{types[signal.kind]} {local}", comment(signal)))
        taken += [(f"{name}_outputs *outputs", "")] if program.outputs else []
        told = harmless(" ".join([f"One sample of {program.name}.", *program.description]))
        lines += enclosed(textwrap.wrap(told, WIDTH - 6), "/*", "*/")
        lines.append(f"static void {name}_step(")
        for place, (argument, about) in enumerate(taken, 1):
            argument += "," if place < len(taken) else ")"
            lines += [f"    {row}" for row in remarked(argument, about, 4)]
        unread = [local for local in self._inputs if not self.reads(rf"{local}\b")]
        body = [*(f"(void){local};" for local in unread), *self.lines]
        return [*lines, "{", *indented(self.constants), *_wrapped(body), "}", ""]


def _declared(lines: list[str], kinds: dict[str, str]) -> list[str]:
    """Return statements that declare each of their own variables where it is first assigned."""
    times = Counter(found[2] for line in lines if (found := _ASSIGNED.match(line)))
    written = []
    for line in lines:
        found = _ASSIGNED.match(line)
        if found and (kind := kinds.pop(found[2], "")):
            constant = "const " if times[found[2]] == 1 else ""
            line = f"{found[1]}{constant}{kind} {line.lstrip()}"
        written.append(line)
    return written


def _wrapped(lines: list[str]) -> list[str]:
    return [row for line in indented(lines) for row in folded(line, WIDTH)]
