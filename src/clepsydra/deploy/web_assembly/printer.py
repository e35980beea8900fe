"""A program for a browser: a WebAssembly module, and a script that runs it by names."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.heading import heading
from clepsydra.deploy.printing.origin import Origin
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.engine.web_assembly import web_assembly
from clepsydra.program.entries import signal_of
from clepsydra.program.inlined import inlined
from clepsydra.program.program import Program

_SCRIPT = "instance.mjs"
#: The line of the script in whose place the signals of a program stand.
_DESCRIBED = "const DESCRIPTION = null;\n"
_NOTES = (
    "The module beside it computes what the simulation computes, bit for bit; only the bits of a",
    "NaN may differ. It imports its memory and nothing else.",
)


@dataclass(frozen=True)
class WebModule:
    """What is printed of a program.

    Parameters
    ----------
    name : str
    module : bytes
    script : str
    """

    name: str
    module: bytes
    script: str

    @property
    def module_name(self) -> str:
        """The file of the module."""
        return f"{self.name}.wasm"

    @property
    def script_name(self) -> str:
        """The file of the script."""
        return f"{self.name}.mjs"


def print_web_assembly(program: Program, *, origin: Origin | None = None) -> WebModule:
    """Print a program as a WebAssembly module and a script.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> print_web_assembly(program).script_name
    'double_it.mjs'
    """
    head = heading(program, "WebAssembly", _NOTES, origin)
    script = files(__package__).joinpath(_SCRIPT).read_text(encoding="utf-8")
    assert script.count(_DESCRIBED) == 1
    script = script.replace(_DESCRIBED, _described(inlined(program)))
    comment = "\n".join(["/*", *(f" * {line}".rstrip() for line in head), " */", ""])
    return WebModule(program.name, web_assembly(program), comment + script)


def _described(program: Program) -> str:
    """Return the signals of a program as a line of the script each, and its delay rings."""
    groups = {
        "inputs": map(_signal, program.inputs),
        "parameters": map(_signal, program.parameters),
        "state": map(_signal, map(signal_of, program.state)),
        "outputs": map(_signal, program.outputs),
        "rings": (
            {"length": ring.length, "turns": turns, "initial": ring.signal.initial}
            for ring, turns in rings_and_turns(program)
        ),
    }
    lines = ["const DESCRIPTION = {"]
    for name, entries in groups.items():
        listed = [f"    {json.dumps(entry, ensure_ascii=False)}," for entry in entries]
        lines += [f"  {name}: [", *listed, "  ],"]
    return "\n".join([*lines, "};", ""])


def _signal(signal: Signal) -> dict[str, Any]:
    return {
        "name": signal.identifier,
        "unit": signal.unit,
        "kind": signal.kind,
        "initial": signal.initial,
        "words": signal.description,
    }
