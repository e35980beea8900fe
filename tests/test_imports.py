"""Tests come in through the front door: what they take from the inside of other packages is few.

A test of a package may know its inside. Whatever else a test needs it takes from `clepsydra`
itself, as a user does, so that the inside can change while the tests stay.
"""

import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
SOURCE = TESTS.parent / "src"
FILES = {
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): path
    for path in SOURCE.rglob("*.py")
}
_IMPORT = re.compile(r"^ *import (clepsydra[\w.]+)", re.MULTILINE)
_FROM = re.compile(r"^ *from (clepsydra[\w.]*) import (\([^)]*\)|.+)$", re.MULTILINE)
_NAME = re.compile(r"(\w+)(?: as \w+)?")
#: A further one is a reason to look for the public name, or for the folder where the test belongs.
LIMIT = 77


def modules_of(text: str) -> set[str]:
    """Return the modules of clepsydra that a file imports, or takes a name from."""
    found = set(_IMPORT.findall(text))
    for module, listed in _FROM.findall(text):
        names = {f"{module}.{name}": module for name in _NAME.findall(listed)}
        found |= {name if name in FILES else module for name, module in names.items()}
    return {name for name in found if name.startswith("clepsydra.")}


def foreign(file: Path) -> set[str]:
    """Return the modules of those that belong neither to the file's own package nor to the door."""
    own, *inside = file.relative_to(TESTS).parts
    return {
        name
        for name in modules_of(file.read_text(encoding="utf-8"))
        if name != "clepsydra.interface" and (not inside or name.split(".")[1] != own)
    }


def test_modules_are_told_from_the_names_in_them():
    text = "import numpy\nimport clepsydra as cl\nfrom clepsydra import InputError, interface\n"
    text += "from clepsydra.base import units\ndef f():\n    import clepsydra.loop.run\n"
    text += "    from clepsydra.base.errors import InputError\n"
    found = {"interface", "base.units", "base.errors", "loop.run"}
    assert modules_of(text) == {f"clepsydra.{name}" for name in found}


def test_tests_import_few_modules_from_outside_their_own_package():
    users: dict[str, list[str]] = {}
    for file in sorted(TESTS.rglob("*.py")):
        for name in foreign(file):
            users.setdefault(name, []).append(file.relative_to(TESTS).as_posix())
    assert len(users) <= LIMIT, "\n".join(f"{name}: {users[name]}" for name in sorted(users))


def test_no_files_of_the_source_import_each_other():
    """When they load, when a function runs, or for types alone: none needs what needs it."""
    imported = {name: modules_of(file.read_text(encoding="utf-8")) for name, file in FILES.items()}
    try:
        TopologicalSorter(imported).prepare()
    except CycleError as circle:
        pytest.fail(" imports ".join(reversed(circle.args[1])))
