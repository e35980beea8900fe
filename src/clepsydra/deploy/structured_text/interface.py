"""The interface of a printed function block: names, and declared variables with comments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.heading import comment
from clepsydra.deploy.printing.identifiers import check_distinct, check_identifier
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.pou import Section, Variable
from clepsydra.deploy.structured_text.wording import Wording
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import own_state
from clepsydra.program.program import Program

_ABBREVIATIONS = frozenset({"lq", "pd", "pi", "pid"})
_LANGUAGE = "Structured Text"


def check_names(program: Program, dialect: Dialect) -> None:
    """Refuse names that a dialect does not accept or cannot tell apart.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.program.program import Block
    >>> program = Program("law", (), (Signal("tank_1.level"),), (), (), Block(1, (), ()))
    >>> check_names(program, dialect_of("scl"))
    """
    place = f"program {program.name}"
    _check_name(program.name, place, dialect)
    entries = [(program.name, place)]
    for call in program.calls:
        _check_name(block_type(call.program), f"block {call.program.name}", dialect)
        _check_name(call.identifier, f"{place}, {call.identifier}", dialect)
        entries.append((call.identifier, f"{place}, {call.identifier}"))
    for entry in (*program.inputs, *program.parameters, *program.outputs, *own_state(program)):
        name = signal_of(entry).identifier
        _check_name(name, f"{place}, {entry.name}", dialect)
        entries.append((name, f"{place}, {entry.name}"))
        if is_ring(entry):
            entries.append((f"{name}_position", f"{place}, position in {entry.name}"))
    check_distinct(entries, _LANGUAGE, ignore_case=True)


def _check_name(name: str, place: str, dialect: Dialect) -> None:
    check_identifier(name, place, _LANGUAGE, dialect.all_words, ignore_case=True)
    if 0 < dialect.longest_name < len(name):
        raise InputError(
            place, name, f"at most {dialect.longest_name} characters for {dialect.systems}",
            "give it a shorter name",
        )  # fmt: skip


def block_type(block: Program) -> str:
    """Return what a block that is called is named as a function block.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> block_type(Program("signal_check", (), (), (), (), Block(0, (), ())))
    'FB_SignalCheck'
    """
    words = block.name.split("_")
    return "FB_" + "".join(w.upper() if w in _ABBREVIATIONS else w.capitalize() for w in words)


class Interface:
    """Declares the signals of a program.

    Parameters
    ----------
    wording : Wording
    origin : Origin or None
        Where the numbers of states and parameters come from.

    Examples
    --------
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> mode = Signal("mode", kind="integer", initial=1.0, low=0.0, high=2.0)
    >>> declared = Interface(wording, None).variable(mode)
    >>> declared.name, declared.type, declared.initial, declared.comment
    ('mode', 'DINT', ('1',), '[1] 0 to 2')
    """

    def __init__(self, wording: Wording, origin: Origin | None) -> None:
        self._wording = wording
        self._origin = origin

    def sections(self, program: Program) -> list[Section]:
        """Return inputs, parameters, outputs and state of a program."""
        parameters = [self._with_source(entry) for entry in program.parameters]
        loops = program.rings
        state = [
            variable
            for entry in own_state(program)
            for variable in self._held(entry, "turn" if entry in loops else "sample")
        ]
        instances = [
            Variable(call.identifier, block_type(call.program), is_block=True)
            for call in program.calls
        ]
        return [
            Section(
                "VAR_INPUT",
                "",
                (
                    ("inputs of one sample", self._variables(program.inputs)),
                    ("parameters", tuple(parameters)),
                ),
            ),
            Section("VAR_OUTPUT", "", (("outputs", self._variables(program.outputs)),)),
            Section(
                "VAR",
                "",
                (("blocks", tuple(sorted(instances, key=lambda instance: instance.type))),),
            ),
            Section("VAR", "RETAIN", (("state", tuple(state)),)),
        ]

    def variable(self, entry: Entry) -> Variable:
        """Declare a signal with its initial value."""
        signal = signal_of(entry)
        return Variable(
            signal.identifier,
            self._wording.types[signal.kind],
            (self.initial(signal),),
            comment=comment(entry),
        )

    def initial(self, signal: Signal) -> str:
        """Write the initial value of a signal in its type."""
        if signal.kind == "integer":
            return str(int(signal.initial))
        if signal.kind == "boolean":
            return "TRUE" if signal.initial else "FALSE"
        return self._wording.number(signal.initial, f"initial value of {signal.name}")

    def _variables(self, signals: Sequence[Signal]) -> tuple[Variable, ...]:
        return tuple(map(self.variable, signals))

    def _with_source(self, entry: Entry, counted: str = "sample") -> Variable:
        source = self._origin.source_of(entry) if self._origin else ""
        return replace(self.variable(entry), comment=comment(entry, source=source, counted=counted))

    def _held(self, entry: Entry, counted: str) -> list[Variable]:
        declared = self._with_source(entry, counted)
        if not is_ring(entry):
            return [declared]
        name, length = declared.name, entry.length
        values = declared.initial * length
        return [
            Variable(name, declared.type, values, length, declared.comment),
            Variable(f"{name}_position", "DINT", ("0",), comment="[1] place of the oldest value"),
        ]
