"""The step functions of printed C99: that of a program, and one for each of its blocks."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.interface import step_head
from clepsydra.deploy.c99.notation import literal, real_type
from clepsydra.deploy.c99.statements import advance, assign, call, declare, statement
from clepsydra.deploy.c99.structures import TYPES, WIDTH, Structures, block_name
from clepsydra.deploy.printing.expressions import Expression, Notation, flag, render, variable
from clepsydra.deploy.printing.folding import list_block
from clepsydra.deploy.printing.heading import comment, commented, harmless
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import BlockCall
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.needed import needed_part
from clepsydra.program.owned_state import owned_by_calls
from clepsydra.program.program import Call, Program


class StepFunction:
    """What a step function does with a program in its printed form.

    Parameters
    ----------
    program : Program
    name : str
        What the names of the blocks' types and functions begin with.
    notation : Notation
    taken : iterable of str
        Names of the file, which no variable may have.

    Examples
    --------
    >>> from clepsydra.deploy.c99.notation import notation_of
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> StepFunction(program, "double_it", notation_of("double"), []).text()[-2]
    '}'
    """

    def __init__(
        self, program: Program, name: str, notation: Notation, taken: Iterable[str]
    ) -> None:
        self._program, self._name = program, name
        self._notation, self._real = notation, real_type(notation)
        self._names = Identifiers(taken, ignore_case=False)
        self._used = program.block.uses()
        self._owned = owned_by_calls(program)
        calls = program.calls
        #: How often instances get a value.
        self._handed = Counter(
            v for call in calls for v in call.arguments[len(call.program.state) :]
        )
        self._locals: dict[str, str] = {}
        #: Numbers that are read from a whole one, and how that is written.
        self._whole: dict[str, str] = {}
        arguments = [self._argument(value) for value in range(program.block.arguments)]
        labels = {
            value: self._names.new(label)
            for value, label in program.names.items()
            if value >= program.block.arguments and value in self._used
        }
        preferred: dict[int, str] = {}
        for entry, value in zip(program.outputs, program.output_values, strict=True):
            preferred.setdefault(value, entry.identifier)
        for state, value in zip(program.state, program.next_state, strict=True):
            preferred.setdefault(value, f"next_{signal_of(state).identifier}")
        self.listing = list_block(
            program.block, arguments, notation, self._names,
            labels=labels, preferred=preferred, read=self._read,
        )  # fmt: skip
        # A loop may be given an argument that its body does not read.
        self._reads = {part.text for part in self.listing.expressions()}
        self._locals = {name: load for name, load in self._locals.items() if name in self._reads}

    def _argument(self, value: int) -> Expression:
        """Copy an argument that is read into a local, so that the state can be overwritten.

        Inputs and parameters that instances get are read where they are: an integer comes to them
        without being a number between, which a float may not hold.
        """
        program = self._program
        if value not in self._used or value in self._owned:
            return variable("")
        if value in program.state_arguments:
            where, entry = "state", program.state[value]
        elif value in program.input_arguments:
            where, entry = "inputs", program.inputs[value - program.input_arguments.start]
        else:
            first = program.parameter_arguments.start
            where, entry = "parameters", program.parameters[value - first]
        signal = signal_of(entry)
        member = f"{where}->{signal.identifier}"
        if is_ring(entry):
            member = f"{member}[{member}_position]"
        handed = self._handed[value]
        if (
            where != "state"
            and handed
            and (signal.kind == "integer" or handed == self._used[value])
        ):
            return self._read(signal, member)
        local = self._names.new(signal.identifier)
        if signal.kind == "boolean":
            self._locals[local] = f"const bool {local} = {member};"
            return Expression("number", (flag(local),))
        cast = f"({self._real})" if signal.kind == "integer" else ""
        self._locals[local] = f"const {self._real} {local} = {cast}{member};"
        return variable(local)

    def _read(self, signal: Signal, text: str) -> Expression:
        """Return what reads an output of an instance, or an input that is handed over."""
        if signal.kind == "boolean":
            return Expression("number", (flag(text),))
        if signal.kind == "real":
            return variable(text)
        self._whole[f"({self._real}){text}"] = text
        return variable(f"({self._real}){text}")

    def text(self) -> list[str]:
        """Return the lines of the function that computes one sample."""
        program = self._program
        lines = [*step_head(program.name, ""), "{"]
        read = " ".join([*self._reads, *self._locals.values()])
        lines += [
            f"  (void){where};" for where in ("parameters", "inputs") if f"{where}->" not in read
        ]
        if not (program.state or program.rings):
            lines.append("  (void)state;")
        lines += self._body()
        if not program.outputs:
            lines.append("  outputs->nothing = 0;")
        return [*lines, "}", ""]

    def _body(self) -> list[str]:
        program = self._program
        lines = [f"  {load}" for load in self._locals.values()]
        if self._locals and self.listing.statements:
            lines.append("")
        needed = needed_part(program.block)[0].statements
        calls = (each for each in needed if isinstance(each, Call))
        for entry in self.listing.statements:
            if isinstance(entry, BlockCall):
                lines += self._call(entry, next(calls).instance)
            else:
                lines += statement(entry, self._notation, 1)
        own = [place for place in program.state_arguments if place not in self._owned]
        results = self.listing.results
        lines += self._stores("outputs", program.outputs, results[len(program.state) :])
        lines += self._stores(
            "state", [program.state[place] for place in own], [results[place] for place in own]
        )
        return lines

    def _call(self, entry: BlockCall, instance: str) -> list[str]:
        """Call an instance; its outputs are members of a variable that is called like it."""
        block, name = entry.program, block_name(self._name, entry.program)
        lines = []
        arguments = [f"&state->{instance}"] if block.state else []
        arguments += map(self._converted, entry.arguments, block.inputs)
        if block.outputs:
            lines += declare(f"{name}_outputs", entry.instance, 1)
            arguments.append(f"&{entry.instance}")
        return [*lines, *call(f"{name}_step", arguments, 1)]

    def _stores(
        self, where: str, entries: Sequence[Entry], results: Sequence[Expression]
    ) -> list[str]:
        title = "next state" if where == "state" else where
        lines = ["", f"  /* {title} */"] if entries else []
        for entry, result in zip(entries, results, strict=True):
            signal = signal_of(entry)
            member = f"{where}->{signal.identifier}"
            text = self._converted(result, signal)
            if is_ring(entry):
                lines += assign(f"{member}[{member}_position]", text, 1)
                lines += advance(member, entry.length, 1)
            else:
                lines += assign(member, text, 1)
        return lines

    def _converted(self, result: Expression, signal: Signal) -> str:
        """Write a result in the type of its signal; that it fits has been proved."""
        if signal.kind != "real" and result.code == "constant":
            return literal(result.number, signal.kind, self._notation)
        if signal.kind == "boolean":
            truth = Expression("truth", (result,))
            return render(result.operands[0] if result.code == "number" else truth, self._notation)
        text = render(result, self._notation)
        if signal.kind == "integer":
            if result.text in self._whole:
                return self._whole[result.text]
            return f"(int32_t){text}" if result.code == "variable" else f"(int32_t)({text})"
        return text


class BlockFunction(StepFunction):
    """The step function of a block: inputs come by their values, state and outputs by pointers.

    Parameters
    ----------
    As those of `StepFunction`.

    Examples
    --------
    >>> from clepsydra.deploy.c99.notation import notation_of
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> block = Program("twice", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print("\\n".join(BlockFunction(block, "law", notation_of("double"), []).text()[5:]))
    /* One sample of twice. */
    static void law_twice_step(
        double x, /* [1] */
        law_twice_outputs *outputs)
    {
      /* outputs */
      outputs->y = x + x;
    }
    <BLANKLINE>
    """

    def __init__(
        self, program: Program, name: str, notation: Notation, taken: Iterable[str]
    ) -> None:
        #: The names of the inputs, and what is written to read them.
        self._inputs: list[tuple[str, str]] = []
        super().__init__(program, name, notation, taken)

    def _argument(self, value: int) -> Expression:
        if value not in self._program.input_arguments:
            return super()._argument(value)
        signal = self._program.inputs[value - self._program.input_arguments.start]
        local = self._names.new(signal.identifier)
        read = self._read(signal, local)
        self._inputs.append((local, (read.operands[0] if read.operands else read).text))
        return read

    def text(self) -> list[str]:
        """Return the structure of the outputs, and the function."""
        program, name = self._program, block_name(self._name, self._program)
        about = f"Outputs of {program.name}."
        structures = Structures(self._name, self._real)
        lines = structures.plain(program.outputs, name, "outputs", about) if program.outputs else []
        taken = [(f"{name}_state *state", "")] if program.state else []
        for signal, (local, _) in zip(program.inputs, self._inputs, strict=True):
            taken.append((f"{TYPES.get(signal.kind, self._real)} {local}", comment(signal)))
        taken += [(f"{name}_outputs *outputs", "")] if program.outputs else []
        told = harmless(" ".join([f"One sample of {program.name}.", *program.description]))
        first, *rest = textwrap.wrap(told, WIDTH - 6)
        lines += [f"/* {first}", *(f"   {row}" for row in rest)]
        lines[-1] += " */"
        lines.append(f"static void {name}_step(")
        for place, (declared, about) in enumerate(taken, 1):
            declared += "," if place < len(taken) else ")"
            rows = commented(declared, about, "/*", "*/", WIDTH - 4) if about else [declared]
            lines += [f"    {row}" for row in rows]
        body = [f"  (void){local};" for local, text in self._inputs if text not in self._reads]
        body += self._body()
        return [*lines, "{", *body[body[0] == "" :], "}", ""]
