"""The shared library of an FMU, built for the machine that writes it."""

from __future__ import annotations

import platform
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.deploy.compiler import Compiler, library_name
from clepsydra.deploy.fmi.sources import compiled_files

_SYSTEMS = {"linux": "linux", "darwin": "darwin", "win32": "windows"}
_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_VERSION_2 = {"linux": "linux", "darwin": "darwin", "windows": "win"}


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


def build_binary(name: str, files: dict[str, str], compiler: Compiler) -> tuple[str, bytes]:
    """Compile the sources of an FMU; return file name and content of the library.

    Parameters
    ----------
    name : str
        The model identifier.
    files : dict
        File name to text.
    compiler : Compiler

    Raises
    ------
    CompilationError
        The compiler does not accept a source.

    Examples
    --------
    >>> from clepsydra.deploy.compiler import find_compiler
    >>> sources = {"answer.c": "int answer(void); int answer(void) { return 42; }"}
    >>> build_binary("answer", sources, find_compiler("example"))[0].partition(".")[0]
    'answer'
    """
    hidden = replace(compiler, flags=(*compiler.flags, *_hiding()))
    with tempfile.TemporaryDirectory(prefix="clepsydra-fmu-") as folder:
        for file, text in files.items():
            Path(folder, file).write_text(text, encoding="utf-8")
        target = Path(folder, library_name(name))
        hidden.build([Path(folder, file) for file in compiled_files(files)], target)
        return target.name, target.read_bytes()


def _hiding() -> tuple[str, ...]:
    """Keep the printed functions inside: two FMUs in one importer may have the same."""
    return () if sys.platform == "win32" else ("-fvisibility=hidden",)
