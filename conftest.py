"""Examples in docstrings that need a compiler or an optional package are skipped without one."""

import importlib.util
import os
import shutil
from pathlib import Path

import pytest

_NEEDED = {
    "no C compiler (cc, gcc or clang) is installed": any(map(shutil.which, ("cc", "gcc", "clang"))),
    "the packages of clepsydra[verify] are not installed": all(
        map(importlib.util.find_spec, ("fmpy", "tree_sitter_iec61131_3_st"))
    ),
}
_FOLDERS = tuple(Path("src/clepsydra/deploy") / name for name in ("proof", "fmi", "compiler.py"))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    missing = [reason for reason, found in _NEEDED.items() if not found]
    if not missing or os.environ.get("CLEPSYDRA_REQUIRE_TOOLS") == "1":
        return
    skip = pytest.mark.skip(reason=missing[0])
    for item in items:
        path = item.path.relative_to(config.rootpath)
        if isinstance(item, pytest.DoctestItem) and any(map(path.is_relative_to, _FOLDERS)):
            item.add_marker(skip)
