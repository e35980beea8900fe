"""What a docstring calls a parameter is an argument of its function, or a field of its class."""

import ast
import inspect
import re
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[1] / "src"
_SECTION = re.compile(r"^Parameters\n-{4,}\n(.*?)(?=^\w[\w ]*\n-{4,}\n|\Z)", re.M | re.S)
_DEFINED = ast.FunctionDef | ast.ClassDef
_ENTRY = re.compile(r"^(\*{0,2}\w+(?:, *\*{0,2}\w+)*)(?: *:.*)?$", re.M)


def documented(text: str) -> list[str]:
    """Return the names of the section Parameters of a docstring of numpydoc."""
    found = _SECTION.search(inspect.cleandoc(text))
    entries = _ENTRY.findall(found[1]) if found else []
    return [name.strip(" *") for entry in entries for name in entry.split(",")]


def arguments(function: ast.FunctionDef) -> set[str]:
    """Return the names of all arguments of a function."""
    given = function.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return {each.arg for each in named if each is not None}


def defined(text: str) -> list[_DEFINED]:
    """Return the functions and classes of a file."""
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, _DEFINED)]


def classes_of(files: dict[str, list[_DEFINED]]) -> dict[str, list[ast.ClassDef]]:
    """Return the classes of these files by their names, of which there may be several."""
    found: dict[str, list[ast.ClassDef]] = {}
    for nodes in files.values():
        for node in nodes:
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(node)
    return found


def fields(node: ast.ClassDef, classes: dict[str, list[ast.ClassDef]]) -> set[str]:
    """Return the fields of a class and of those below it, and what it is made from."""
    found = set()
    for each in node.body:
        if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name):
            found.add(each.target.id)
        elif isinstance(each, ast.FunctionDef) and each.name in ("__init__", "__new__"):
            found |= arguments(each)
    for base in node.bases:
        name = base.id if isinstance(base, ast.Name) else getattr(base, "attr", "")
        for below in classes.get(name, []):
            if below is not node:
                found |= fields(below, classes)
    return found


def unknown(files: dict[str, list[_DEFINED]]) -> list[str]:
    """Return, a line each, what is documented as a parameter and is none."""
    classes, said = classes_of(files), []
    for file, nodes in files.items():
        for node in nodes:
            names = documented(ast.get_docstring(node) or "")
            known = arguments(node) if isinstance(node, ast.FunctionDef) else fields(node, classes)
            said += [
                f"{file}:{node.lineno}: {node.name} has no {name}; take it out of the docstring"
                for name in names
                if name not in known
            ]
    return said


def test_docstrings_of_the_source_name_parameters_that_there_are():
    files = {
        path.relative_to(SOURCE).as_posix(): defined(path.read_text("utf-8"))
        for path in sorted(SOURCE.rglob("*.py"))
    }
    count = sum(
        len(documented(ast.get_docstring(node) or "")) for nodes in files.values() for node in nodes
    )
    assert count > 1000
    assert unknown(files) == []


FUNCTION = '''
def area(radius, *, unit="m", **more):
    """Return it.

    Parameters
    ----------
    {} : float
        Not: of anything else.
    unit, more
        As above.

    Returns
    -------
    float
    """
'''
CLASSES = '''
class Shape:
    height: float

class Round(Shape):
    """It.

    Parameters
    ----------
    {}, height : float
    """

    radius: float
'''


@pytest.mark.parametrize("text", [FUNCTION, CLASSES])
def test_a_name_that_is_no_parameter_is_found(text):
    assert unknown({"a.py": defined(text.format("radius"))}) == []
    (line,) = unknown({"a.py": defined(text.format("diameter"))})
    assert "has no diameter" in line
