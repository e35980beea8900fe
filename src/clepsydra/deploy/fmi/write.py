"""An FMU written to a file: description, binary, sources and documentation in one archive."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Literal, get_args

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.fmi.binary import build_binary, platform_folder
from clepsydra.deploy.fmi.description_2 import model_description_2
from clepsydra.deploy.fmi.description_3 import build_description_3, model_description_3
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.page import documentation_page
from clepsydra.deploy.fmi.sources import compiled_files, source_files

#: Versions of the Functional Mock-up Interface.
FmiVersion = Literal["3.0", "2.0"]
#: The earliest date that an archive can hold, so that the same model gives the same file.
_DATE = (1980, 1, 1, 0, 0, 0)


def write_fmu(
    path: Path,
    model: FmuModel,
    compiler: Compiler | None,
    *,
    version: FmiVersion = "3.0",
    sources_only: bool = False,
) -> None:
    """Write a model as an FMU, whole or not at all.

    Parameters
    ----------
    path : Path
        Usually ends in ".fmu".
    model : FmuModel
        See `controller_model`, `process_model` and `exchange_model`.
    compiler : Compiler or None
        What builds the binary for this machine.
    version : {"3.0", "2.0"}
        Of the Functional Mock-up Interface.
    sources_only : bool
        Write no binary; the importer compiles the sources.

    Raises
    ------
    InputError
        There is no compiler though a binary is wanted, this version of the standard has no name
        for this kind of machine, the version is unknown, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.deploy.fmi.controller import controller_model
    >>> from clepsydra.deploy.printing.origin import Origin
    >>> from clepsydra.program.program import Block, Operation, Program
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> model = controller_model(program, Origin("doubler", "a test", "", 1.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_fmu(Path(folder, "double_it.fmu"), model, None, sources_only=True)
    ...     zipfile.ZipFile(Path(folder, "double_it.fmu")).namelist()[:2]
    ['modelDescription.xml', 'documentation/index.html']
    """
    if version not in get_args(FmiVersion):
        raise InputError("FMU, version", version, "3.0 or 2.0", "choose one of them")
    if compiler is None and not sources_only:
        raise InputError(
            f"FMU of {model.name}", "no C compiler", "a C compiler to build the binary with",
            "install gcc, or pip install 'clepsydra[zig]', or give sources_only=True",
        )  # fmt: skip
    contents = fmu_contents(model, version)
    if compiler is not None and not sources_only:
        folder = f"binaries/{platform_folder(version)}"
        name, library = build_binary(model.name, source_files(model, version), compiler)
        contents[f"{folder}/{name}"] = library
    with whole_file(path) as part, zipfile.ZipFile(part, "w") as archive:
        for name, content in contents.items():
            entry = zipfile.ZipInfo(name, _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            # Of a fixed system and with fixed rights, so that the file is the same everywhere.
            entry.create_system = 3
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, content)


def fmu_contents(model: FmuModel, version: FmiVersion) -> dict[str, bytes]:
    """Return what an FMU holds apart from its binary, by path in the archive.

    Examples
    --------
    See `write_fmu`.
    """
    files = source_files(model, version)
    compiled = compiled_files(files)
    described = (
        model_description_3(model) if version == "3.0" else model_description_2(model, compiled)
    )
    texts = {
        "modelDescription.xml": described,
        "documentation/index.html": documentation_page(model),
        **{f"sources/{name}": text for name, text in files.items()},
    }
    if version == "3.0":
        texts["sources/buildDescription.xml"] = build_description_3(model, compiled)
    return {name: text.encode() for name, text in texts.items()}
