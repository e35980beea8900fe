"""The interface of printed Structured Text: names, and sections of commented declarations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.entries import Entry, is_ring, signal_of
from clepsydra.deploy.printing.expressions import Expression, render
from clepsydra.deploy.printing.heading import comment, commented
from clepsydra.deploy.printing.identifiers import (
    STRUCTURED_TEXT_WORDS,
    check_distinct,
    check_identifier,
)
from clepsydra.deploy.structured_text.statements import NOTATION
from clepsydra.program.program import Program

_TYPES = {"real": "LREAL", "integer": "DINT", "boolean": "BOOL"}
_WIDTH = 98


def check_names(program: Program) -> None:
    """Refuse names that Structured Text does not accept or cannot tell apart.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> check_names(Program("law", (), (Signal("tank_1.level"),), (), (), Block(1, (), ())))
    """
    language, words = NOTATION.language, STRUCTURED_TEXT_WORDS
    place = f"program {program.name}"
    check_identifier(program.name, place, language, words, ignore_case=True)
    entries = [(program.name, place)]
    for entry in (*program.inputs, *program.parameters, *program.outputs, *program.state):
        name = signal_of(entry).identifier
        check_identifier(name, f"{place}, {entry.name}", language, words, ignore_case=True)
        entries.append((name, f"{place}, {entry.name}"))
        if is_ring(entry):
            entries.append((f"{name}_position", f"{place}, position in {entry.name}"))
    check_distinct(entries, language, ignore_case=True)


def section(
    keyword: str, title: str, entries: Sequence[Entry], declare: Callable[[Entry], list[str]]
) -> list[str]:
    """Return the declarations of one kind of variable, or nothing where there are none.

    Examples
    --------
    >>> section("VAR_INPUT", "inputs", [Signal("level", "m", initial=0.1)], declaration)
    ['VAR_INPUT (* inputs *)', '  level : LREAL := 0.1; (* [m] *)', 'END_VAR']
    """
    if not entries:
        return []
    lines = [line for entry in entries for line in declare(entry)]
    return [f"{keyword} (* {title} *)", *(f"  {line}" for line in lines), "END_VAR"]


def declaration(entry: Entry) -> list[str]:
    """Declare an input or a parameter with its default.

    Examples
    --------
    >>> declaration(Signal("mode", kind="integer", initial=1.0, low=0.0, high=2.0))
    ['mode : DINT := 1; (* [1] 0 to 2 *)']
    """
    signal = signal_of(entry)
    return _commented(
        f"{signal.identifier} : {_TYPES[signal.kind]} := {_literal(signal)};", comment(entry)
    )


def output_declaration(entry: Entry) -> list[str]:
    """Declare an output; it gets its value in every call.

    Examples
    --------
    >>> output_declaration(Signal("manipulated_1", "V"))
    ['manipulated_1 : LREAL; (* [V] *)']
    """
    signal = signal_of(entry)
    return _commented(f"{signal.identifier} : {_TYPES[signal.kind]};", comment(entry))


def _commented(line: str, text: str) -> list[str]:
    return commented(line, text, "(*", "*)", _WIDTH)


def state_declaration(entry: Entry) -> list[str]:
    """Declare a state with its initial value; a delay ring is an array and a position.

    Examples
    --------
    >>> from clepsydra.program.delay_ring import DelayRing
    >>> state_declaration(DelayRing(Signal("flow", "m^3/s"), 3))[0]
    'flow : ARRAY[0..2] OF LREAL := [3(0.0)]; (* [m^3/s]; delayed by 3 samples *)'
    """
    if not is_ring(entry):
        return declaration(entry)
    name, length, kind = entry.signal.identifier, entry.length, _TYPES[entry.signal.kind]
    value = _literal(entry.signal)
    return [
        *_commented(
            f"{name} : ARRAY[0..{length - 1}] OF {kind} := [{length}({value})];", comment(entry)
        ),
        f"{name}_position : DINT := 0; (* [1] place of the oldest value *)",
    ]


def _literal(signal: Signal) -> str:
    """Write the initial value of a signal in its type."""
    if signal.kind == "integer":
        return str(int(signal.initial))
    if signal.kind == "boolean":
        return "TRUE" if signal.initial else "FALSE"
    return render(Expression("constant", number=signal.initial), NOTATION)
