"""The C sources of an FMU."""

from __future__ import annotations

from importlib import resources

from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.model_header import model_header

_SHARED = ("instance.h", "phases.h", "records.h", "exchange.h", "stepping.h")
_OF_VERSION = {
    "2.0": ("fmi2.c", "fmi2_types.h"),
    "3.0": ("fmi3.c", "fmi3_types.h", "fmi3_absent.h"),
}


def source_files(model: FmuModel, version: str) -> dict[str, str]:
    """Return the sources by file name: the printed programs, model.h, and the interface.

    Examples
    --------
    >>> from clepsydra.deploy.fmi.controller import controller_model
    >>> from clepsydra.deploy.printing.origin import Origin
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation, Program
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> model = controller_model(program, Origin("doubler", "a test", "", 1.0))
    >>> sorted(source_files(model, "3.0"))[:4]
    ['double_it.c', 'double_it.h', 'exchange.h', 'fmi3.c']
    """
    files = {}
    for program in model.programs:
        printed = print_c(program, origin=model.origin)
        files[printed.header_name] = printed.header
        files[printed.source_name] = printed.source
    files["model.h"] = model_header(model, version)
    wrapper = resources.files("clepsydra.deploy.fmi") / "wrapper"
    for name in (*_SHARED, *_OF_VERSION[version]):
        files[name] = (wrapper / name).read_text(encoding="utf-8")
    return files


def compiled_files(files: dict[str, str]) -> list[str]:
    """Return the names of those sources that are compiled, not included.

    >>> compiled_files({"law.c": "", "law.h": ""})
    ['law.c']
    """
    return [name for name in files if name.endswith(".c")]
