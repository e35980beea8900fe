"""An FMU written to a file: description, binary, sources and documentation in one archive."""

from __future__ import annotations

import platform
import sys
import tempfile
import zipfile
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Literal, get_args

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.compiler import Compiler, library_name
from clepsydra.deploy.fmi.description import build_description, model_description
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.model_header import model_header
from clepsydra.deploy.fmi.page import documentation_page

#: Versions of the Functional Mock-up Interface.
FmiVersion = Literal["3.0", "2.0"]
#: The earliest date that an archive can hold, so that the same model gives the same file.
_DATE = (1980, 1, 1, 0, 0, 0)
#: Where the sources lie in the archive.
_SOURCES = "sources/"
#: Files of `wrapper/`, in every FMU and in that of a version.
_SHARED = ("instance.h", "phases.h", "records.h", "exchange.h", "stepping.h")
_OF_VERSION = {
    "2.0": ("fmi2.c", "fmi2_types.h"),
    "3.0": ("fmi3.c", "fmi3_types.h", "fmi3_absent.h"),
}
_SYSTEMS = {"linux": "linux", "darwin": "darwin", "win32": "windows"}
_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_VERSION_2 = {"linux": "linux", "darwin": "darwin", "windows": "win"}


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
        name, library = _built(model.name, contents, compiler)
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
    """Return what an FMU holds apart from its binary, by path in the archive."""
    files = _source_files(model, version)
    compiled = [name for name in files if name.endswith(".c")]
    texts = {
        "modelDescription.xml": model_description(model, version, compiled),
        "documentation/index.html": documentation_page(model),
        **{f"{_SOURCES}{name}": text for name, text in files.items()},
    }
    if version == "3.0":
        texts[f"{_SOURCES}buildDescription.xml"] = build_description(model, compiled)
    return {name: text.encode() for name, text in texts.items()}


def _source_files(model: FmuModel, version: FmiVersion) -> dict[str, str]:
    """Return the sources by file name: the printed programs, model.h, and the interface."""
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


def platform_folder(version: str) -> str:
    """Return the name that the standard gives to this kind of machine.

    Raises
    ------
    InputError
        This version of the standard has no name for it.

    Examples
    --------
    >>> platform_folder("3.0").count("-")
    1
    """
    system = _SYSTEMS.get(sys.platform)
    machine = _MACHINES.get(platform.machine().lower())
    here = f"{platform.machine()} {sys.platform}"
    if system is None or machine is None:
        raise InputError(
            "FMU, platform", here, "x86_64 or aarch64 under Linux, macOS or Windows",
            "write it on such a machine, or in Python by write_fmu(..., sources_only=True)",
        )  # fmt: skip
    if version == "2.0" and machine != "x86_64":
        raise InputError(
            "FMU, platform", here, "x86_64: FMI 2.0 has a name for no other machine of 64 bits",
            "write it as FMI 3.0",
        )  # fmt: skip
    return f"{machine}-{system}" if version == "3.0" else f"{_VERSION_2[system]}64"


def _built(name: str, contents: dict[str, bytes], compiler: Compiler) -> tuple[str, bytes]:
    """Compile the sources of an FMU; return file name and content of the library."""
    # The printed functions stay inside: two FMUs in one importer may have the same.
    hiding = () if sys.platform == "win32" else ("-fvisibility=hidden",)
    hidden = replace(compiler, flags=(*compiler.flags, *hiding))
    with tempfile.TemporaryDirectory(prefix="clepsydra-fmu-") as folder:
        sources = []
        for file, content in contents.items():
            if file.startswith(_SOURCES):
                path = Path(folder, file.removeprefix(_SOURCES))
                path.write_bytes(content)
                sources += [path] if path.suffix == ".c" else []
        target = Path(folder, library_name(name))
        hidden.build(sources, target)
        return target.name, target.read_bytes()
