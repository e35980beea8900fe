"""What is exported made into a controller image: Structured Text by matiec, C by a compiler."""

from __future__ import annotations

import hashlib
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.printer import CSource, print_c
from clepsydra.deploy.compiler import find_compiler, library_name
from clepsydra.deploy.exportable import Exportable
from clepsydra.deploy.matiec import Absent, find_matiec
from clepsydra.deploy.matiec_block import matiec_block
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.hil.controller_image import ControllerImage
from clepsydra.program.precision import Precision
from clepsydra.program.program import Program

_REAL = {"double": ("LREAL", "double"), "single": ("REAL", "float")}
_C = """#include "{name}.h"
typedef struct {{
  {name}_parameters parameters;
  {name}_state state;
  {name}_inputs inputs;
  {name}_outputs outputs;
}} block;
unsigned long block_size(void);
void block_power(block *now, const block *before);
void block_scan(block *now, const double *given, double *found);
unsigned long block_size(void) {{ return sizeof(block); }}
void block_power(block *now, const block *before)
{{
  {name}_default_parameters(&now->parameters);
  {name}_default_inputs(&now->inputs);
  {name}_initialise(&now->state);
  if (before) {{ now->state = before->state; }}
}}
void block_scan(block *now, const double *given, double *found)
{{
{writes}
  {name}_step(&now->parameters, &now->state, &now->inputs, &now->outputs);
{reads}
}}
"""


def structured_text_image(
    ready: Exportable, folder: Path, precision: Precision = "double", text: str = ""
) -> ControllerImage:
    """Return a controller as matiec and a C compiler make it of its Structured Text.

    Parameters
    ----------
    ready : Exportable
    folder : Path
        For what is built; made if it is not there.
    precision : {"double", "single"}
    text : str
        The file NAME.st of an export in the dialect "matiec"; printed as there if left out.

    Raises
    ------
    Absent
        matiec or a C compiler is not on this machine.
    CompilationError
        One of them refuses the text.
    InputError
        The controller cannot be printed.
    """
    matiec, program = find_matiec(), ready.program
    text = text or print_structured_text(
        program, origin=ready.origin, precision=precision, dialect="matiec"
    )
    source = matiec_block(program, program.inputs, precision)
    matiec.translate(text, folder)
    target = folder / library_name(f"{program.name}_{_digest(text, source)}")
    library = matiec.build(source, folder, target)
    title = f"Structured Text in {_REAL[precision][0]} by matiec"
    return _image(program, title, "ST", library, precision)


def c_image(
    ready: Exportable, folder: Path, precision: Precision = "double", printed: CSource | None = None
) -> ControllerImage:
    """Return a controller as a C compiler makes it of its exported C.

    Parameters
    ----------
    ready : Exportable
    folder : Path
        For what is built; made if it is not there.
    precision : {"double", "single"}
    printed : CSource, optional
        The two files of an export to C; printed as there if left out.

    Raises
    ------
    Absent
        There is no C compiler on this machine.
    CompilationError
        It refuses the source.
    InputError
        The controller cannot be printed.
    """
    try:
        compiler = find_compiler("hardware in the loop")
    except InputError as missing:
        raise Absent(str(missing)) from None
    program = ready.program
    printed = printed or print_c(program, origin=ready.origin, precision=precision)
    real = _REAL[precision][1]
    wrapper = _C.format(
        name=program.name,
        writes="\n".join(
            f"  now->inputs.{each.identifier} = {_cast(each, f'given[{place}]', real)};"
            for place, each in enumerate(program.inputs)
        ),
        reads="\n".join(
            f"  found[{place}] = (double)now->outputs.{each.identifier};"
            for place, each in enumerate(program.outputs)
        ),
    )
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        printed.header_name: printed.header,
        printed.source_name: printed.source,
        f"{program.name}_scan.c": wrapper,
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    target = folder / library_name(f"{program.name}_{_digest(*texts.values())}")
    sources = [folder / name for name in (printed.source_name, f"{program.name}_scan.c")]
    library = compiler.build(sources, target)
    return _image(program, f"C in {real} by {compiler.version}", "C", library, precision)


def _cast(signal: Signal, value: str, real: str) -> str:
    if signal.kind == "boolean":
        return f"{value} != 0.0"
    return f"({'int32_t' if signal.kind == 'integer' else real}){value}"


def _image(
    program: Program, title: str, label: str, library: Path, precision: Precision
) -> ControllerImage:
    inputs = {signal.name: signal.initial for signal in program.inputs}
    outputs = tuple(signal.name for signal in program.outputs)
    return ControllerImage(title, label, library.resolve(), inputs, outputs, precision)


def _digest(*texts: str) -> str:
    # A system that has loaded a library gives it again for the same path.
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()[:12]
