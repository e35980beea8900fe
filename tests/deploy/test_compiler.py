"""The C compiler: found, missing, and what it says of a wrong source."""

import ctypes
import importlib.util
import shutil

import pytest
from refusals import refused
from tools import need, need_compiler

from clepsydra.deploy.compiler import CompilationError, find_compiler, library_name

ANSWER = "int answer(void);\nint answer(void) { return 42; }\n"


def test_a_library_is_built_and_called(tmp_path):
    need_compiler()
    source = tmp_path / "answer.c"
    source.write_text(ANSWER)
    target = find_compiler("test").build([source], tmp_path / library_name("answer"))
    assert ctypes.CDLL(str(target)).answer() == 42


def test_what_the_compiler_says_is_in_the_message(tmp_path):
    need_compiler()
    source = tmp_path / "answer.c"
    source.write_text(ANSWER.replace("42", "4.2"))  # an error under the strict warnings only
    with pytest.raises(CompilationError, match=r"answer\.c:2:.*conver"):
        find_compiler("test").build([source], tmp_path / library_name("answer"))
    assert not (tmp_path / library_name("answer")).exists()


def test_a_missing_compiler_is_told_with_the_remedy(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with refused(remedy="install gcc, or pip install 'clepsydra[zig]'"):
        find_compiler("proof")


def test_the_package_ziglang_serves_where_no_compiler_is(monkeypatch, tmp_path):
    need("ziglang")
    monkeypatch.setattr(shutil, "which", lambda name: None)
    compiler = find_compiler("proof")
    assert compiler.version.startswith("zig cc, clang version")
    source = tmp_path / "answer.c"
    source.write_text(ANSWER)
    target = compiler.build([source], tmp_path / library_name("answer"))
    assert ctypes.CDLL(str(target)).answer() == 42


def test_a_compiler_that_does_not_run_is_told(monkeypatch, tmp_path):
    broken = tmp_path / "gcc"
    broken.write_text("#!/bin/sh\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setattr(shutil, "which", lambda name: str(broken))
    with refused(expected="a C compiler that runs"):
        find_compiler("proof")
