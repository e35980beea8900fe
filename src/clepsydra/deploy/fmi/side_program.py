"""A printed program that is called beside the main one, on the memory of the model."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.program.program import Program


def call_beside(function: str, comment: str, program: Program, members: Mapping[str, str]) -> str:
    """Return a C function that runs a program without state on members of the memory.

    Parameters
    ----------
    function : str
        Name of the function.
    comment : str
        What it does.
    program : Program
    members : mapping
        Name of an input, parameter or output to the member that it is, "inputs.pump_1".

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> text = call_beside("show", "Doubles x.", program, {"x": "inputs.x", "y": "outputs.y"})
    >>> "inputs.x = memory->inputs.x;" in text
    True
    """
    name = program.name
    lines = [f"/* {comment} */", f"static void {function}(model_memory *memory)", "{"]
    lines += [f"  {name}_{part} {part};" for part in ("parameters", "inputs", "state", "outputs")]
    lines += [f"  {name}_default_parameters(&parameters);", f"  {name}_initialise(&state);"]
    for part, signals in (("parameters", program.parameters), ("inputs", program.inputs)):
        for signal in signals:
            member = f"{part}.{signal.identifier}"
            lines.append(f"  {member} = memory->{members[signal.name]};")
    lines.append(f"  {name}_step(&parameters, &state, &inputs, &outputs);")
    for signal in program.outputs:
        lines.append(f"  memory->{members[signal.name]} = outputs.{signal.identifier};")
    return "\n".join([*lines, "}", ""])
