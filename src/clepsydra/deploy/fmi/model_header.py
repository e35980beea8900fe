"""The header that describes a model to the C of the interface: memory, variables, functions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from clepsydra.deploy.c99.statements import C99
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable
from clepsydra.deploy.printing.decimal_text import decimal
from clepsydra.deploy.printing.lines import indented
from clepsydra.program.program import Program

_ROLES = {
    "input": "ROLE_INPUT", "parameter": "ROLE_PARAMETER", "local": "ROLE_START",
    "output": "ROLE_START",
}  # fmt: skip
#: Functions of which some models have no use, and what they are given beside the memory.
_MOVING = {
    "model_advance": "",
    "model_complete": "",
    "model_part": "double first, double last",
    "model_switch": "",
    "model_update": "",
}
_KINDS = {"real": "KIND_REAL", "integer": "KIND_INTEGER", "boolean": "KIND_BOOLEAN"}


def model_header(model: FmuModel, version: str) -> str:
    """Return the text of model.h."""
    name = model.name
    lines = [
        f"/* {name}: its memory, its variables by value reference, and how it starts and moves. */",
        "#ifndef MODEL_H",
        "#define MODEL_H",
        "",
        *(f'#include "{program.name}.h"' for program in model.programs),
        "",
        f'#define MODEL_TOKEN "{model.token(version)}"',
        f"#define MODEL_EXCHANGE {int(model.exchange)}",
        f"#define MODEL_SCANS {int(model.scans)}",
        f"#define MODEL_STEP {decimal(model.step)} /* [s] */",
        "",
        "typedef struct {",
        *(f"  {name}_{part} {part};" for part in ("parameters", "inputs", "state", "outputs")),
        *(f"  double {kept};" for kept in model.kept),
        "} model_memory;",
        "",
        "static const model_variable model_variables[] = {",
        "  {ROLE_RESULT, KIND_REAL, 0}, /* 0: time */",
        *(_row(number, variable) for number, variable in enumerate(model.variables, 1)),
        "};",
        f"static const size_t model_variable_count = {len(model.variables) + 1};",
        "",
        *_references(model),
        _start(model),
        model.functions,
        *(
            _unused(name, given)
            for name, given in _MOVING.items()
            if f"{name}(" not in model.functions
        ),
        "#endif",
        "",
    ]
    return "\n".join(lines)


def _row(number: int, variable: FmuVariable) -> str:
    role = _ROLES[variable.causality] if variable.settable else "ROLE_RESULT"
    place = f"offsetof(model_memory, {variable.member})"
    return f"  {{{role}, {_KINDS[variable.signal.kind]}, {place}}}, /* {number} */"


def _references(model: FmuModel) -> list[str]:
    """Write the value references of states, derivatives, indicators, memories, and nominal values.

    An array of C has at least one element.
    """

    def count(name: str, values: Sequence[str]) -> str:
        return f"static const size_t model_{name}_count = {len(values)};"

    def array(kind: str, name: str, values: Sequence[str]) -> str:
        return f"static const {kind} model_{name}[] = {{{', '.join(values or ['0'])}}};"

    def references(names: Iterable[str]) -> list[str]:
        return [str(model.reference(name)) for name in names]

    derivatives, states = model.derivatives, references(v.derivative_of for v in model.derivatives)
    indicators, memories = references(model.indicators), references(model.followed)
    return [
        count("state", states),
        array("uint32_t", "states", states),
        array("uint32_t", "derivatives", references(v.signal.name for v in derivatives)),
        array("double", "nominals", [decimal(state.nominal) for state in model.states]),
        count("indicator", indicators),
        array("uint32_t", "indicators", indicators),
        count("memory", memories),
        array("uint32_t", "memories", memories),
        "",
    ]


def _start(model: FmuModel) -> str:
    name, in_c = model.name, C99(model.name, "double")
    body = [
        f"{name}_default_parameters(&memory->parameters);",
        f"{name}_initialise(&memory->state);",
    ]
    for variable in model.variables:
        if variable.settable and variable.member.startswith("inputs."):
            body.append(f"memory->{variable.member} = {in_c.initial(variable.signal)};")
    return function_text("model_start", body)


def _unused(name: str, given: str) -> str:
    names = [each.split()[-1] for each in given.split(", ") if each]
    return function_text(name, [f"(void){each};" for each in ("memory", *names)], given=given)


def function_text(name: str, body: Sequence[str], comment: str = "", *, given: str = "") -> str:
    """Return a C function over the memory of a model and what else it is given.

    >>> print(function_text("model_rest", ["(void)memory;"], "Nothing moves."))
    /* Nothing moves. */
    static void model_rest(model_memory *memory)
    {
      (void)memory;
    }
    <BLANKLINE>
    """
    above = [f"/* {comment} */"] if comment else []
    arguments = ", ".join(filter(None, ("model_memory *memory", given)))
    head = [*above, f"static void {name}({arguments})", "{"]
    return "\n".join([*head, *indented(body), "}", ""])


def call_step(function: str, comment: str, program: Program, *, keeps_state: bool = False) -> str:
    """Return a C function that runs the step of the model, on a copy of its state if that stays."""
    name, state = program.name, "&state" if keeps_state else "&memory->state"
    body = [f"{name}_state state = memory->state;"] if keeps_state else []
    body.append(f"{name}_step(&memory->parameters, {state}, &memory->inputs, &memory->outputs);")
    return function_text(function, body, comment)


def call_beside(
    function: str,
    comment: str,
    program: Program,
    members: Mapping[str, str],
    *,
    given: str = "",
    before: Sequence[str] = (),
) -> str:
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
    given : str
        What else the function is given, as C declares it.
    before : sequence of str
        Statements that come first.
    """
    name = program.name
    body = [f"{name}_{part} {part};" for part in ("parameters", "inputs", "state", "outputs")]
    body += [*before, f"{name}_default_parameters(&parameters);", f"{name}_initialise(&state);"]
    for part, signals in (("parameters", program.parameters), ("inputs", program.inputs)):
        for signal in signals:
            body.append(f"{part}.{signal.identifier} = memory->{members[signal.name]};")
    body.append(f"{name}_step(&parameters, &state, &inputs, &outputs);")
    for signal in program.outputs:
        body.append(f"memory->{members[signal.name]} = outputs.{signal.identifier};")
    return function_text(function, body, comment, given=given)
