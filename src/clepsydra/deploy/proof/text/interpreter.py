"""Runs function blocks and programs of Structured Text, independent of the printer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from clepsydra.deploy.proof.text.declarations import Declared, Unit, units_of
from clepsydra.deploy.proof.text.statements import compiled
from clepsydra.deploy.proof.text.tree import StructuredTextError, parse
from clepsydra.deploy.proof.text.values import admitted

_Run = Callable[..., Any]


class StructuredText:
    """A text of function blocks and programs, ready to run; a configuration is passed over.

    The text is parsed by the public grammar tree-sitter-iec61131-3-st; an error anywhere in the
    tree is refused. Types are as strict as the standard's: no implicit conversion, DINT in 32
    bits, a variable is declared before it is used, an index stays inside its array. LREAL is the
    IEEE 754 double and REAL the single-precision number; every operation is rounded to its type.
    Reading a temporary variable before it was written is an error too. The statements are
    translated to Python once, so that ten thousand scans take about a second.

    Parameters
    ----------
    text : str
    one_turn : bool
        Whether every system that the text is for takes the only turn of a FOR whose ends are
        equal; where not, to come to one is an error.

    Raises
    ------
    InputError
        The grammar is not installed.
    StructuredTextError
        The text is wrong; the message names the line.

    Examples
    --------
    >>> text = StructuredText('''
    ... FUNCTION_BLOCK half
    ... VAR_INPUT u : REAL; END_VAR
    ... VAR_OUTPUT y : REAL; END_VAR
    ... y := 0.5 * u;
    ... END_FUNCTION_BLOCK
    ... PROGRAM quarter
    ... VAR first : half; second : half; y : REAL; END_VAR
    ... first(u := 3.0);
    ... second(u := first.y);
    ... y := second.y;
    ... END_PROGRAM
    ... ''')
    >>> quarter = text.instance("quarter")
    >>> quarter.run()
    >>> quarter.state["y"]
    0.75
    """

    def __init__(self, text: str, *, one_turn: bool = True) -> None:
        self.units: dict[str, Unit] = units_of(parse(text))
        self._runs: dict[str, _Run] = {}
        for name, unit in self.units.items():
            self._runs[name] = compiled(unit, self.units, self._runs, one_turn=one_turn)

    def instance(self, name: str) -> FunctionBlock:
        """Return a new instance of a function block or program, all it holds at its start.

        Raises
        ------
        StructuredTextError
            The text has no such unit.
        """
        unit = self.units.get(name.lower())
        if unit is None or unit.kind == "FUNCTION":
            raise StructuredTextError(f"the text has no {name}")
        return FunctionBlock(unit, self._runs[name.lower()], self)


class FunctionBlock:
    """One instance of a function block or program: `state` holds all that lives between calls."""

    def __init__(self, unit: Unit, run: _Run, text: StructuredText) -> None:
        self.name, self.declared, self._run = unit.name, unit.declared, run
        self.state: dict[str, Any] = {
            name: _start(declared, text)
            for name, declared in unit.declared.items()
            if declared.section != "VAR_TEMP"
        }
        self._inputs = {n: d.type for n, d in unit.declared.items() if d.section == "VAR_INPUT"}
        self._spelt: dict[str, tuple[str, str]] = {}
        self._outputs = [n for n, d in unit.declared.items() if d.section == "VAR_OUTPUT"]

    def __call__(self, **inputs: Any) -> dict[str, Any]:
        """Write inputs, run once, and return the outputs by name in lower case.

        Raises
        ------
        StructuredTextError
            A name is no input, a value is none of its type, or the text does what is undefined.
        """
        for name, value in inputs.items():
            key, kind = self._spelt.get(name) or self._input(name)
            self.state[key] = admitted(kind, value)
        self.run()
        return {name: self.state[name] for name in self._outputs}

    def _input(self, name: str) -> tuple[str, str]:
        """Return key and type of an input, however its name is spelt."""
        key = name.lower()
        if key not in self._inputs:
            raise StructuredTextError(f"{name} is no input")
        self._spelt[name] = key, self._inputs[key]
        return self._spelt[name]

    def run(self) -> None:
        """Run once with the inputs as they stand."""
        try:
            self._run(self.state)
        except UnboundLocalError as error:
            name = str(error).partition("'v_")[2].partition("'")[0]
            raise StructuredTextError(f"{name} is read before it was written") from None


def _start(declared: Declared, text: StructuredText) -> Any:
    if declared.is_instance:
        return text.instance(declared.type)
    return list(declared.initial) if declared.length else declared.initial


def function_block(text: str, *, one_turn: bool = True) -> FunctionBlock:
    """Return an instance of the last function block that a text holds; it may call the others.

    Raises
    ------
    InputError, StructuredTextError
        As `StructuredText`; or the text holds none, or something else at its end.

    Examples
    --------
    >>> count = function_block("FUNCTION_BLOCK count VAR_OUTPUT n : DINT; END_VAR n := n + 1; "
    ...                        "END_FUNCTION_BLOCK")
    >>> count(), count()
    ({'n': 1}, {'n': 2})
    """
    whole = StructuredText(text, one_turn=one_turn)
    kinds = [unit.kind for unit in whole.units.values()]
    if kinds[-1:] != ["FUNCTION_BLOCK"] or "PROGRAM" in kinds:
        raise StructuredTextError("expected function blocks and nothing else")
    return whole.instance(next(reversed(whole.units)))
