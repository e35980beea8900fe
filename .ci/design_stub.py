"""Write src/clepsydra/interface/design.pyi: the designs with the types that a caller may give.

The designs inside take numbers; those of the interface take text with a unit as well, which no type
checker can derive. The tests compare the file with what this would write.
"""

import ast
import inspect
import re
import sys
from collections.abc import Callable
from pathlib import Path

from clepsydra.interface import design

TARGET = Path(design.__file__).with_suffix(".pyi")
HEAD = "# Written by .ci/design_stub.py from the designs themselves.\n\n"
_NAME = re.compile(r"[A-Za-z_]\w*")


def stub() -> str:
    """Return the text of the stub."""
    imports: set[tuple[str, str]] = {
        ("clepsydra.interface.controller", "Controller"),
        ("clepsydra.interface.subject", "Subject"),
    }
    functions = []
    for name in dir(design):
        function: Callable[..., object] = getattr(design, name)
        declared = getattr(function, "declared", {})
        inner = inspect.unwrap(function)
        known = _imported(inner)
        parameters, starred = [], False
        for parameter in inspect.signature(function).parameters.values():
            if parameter.kind is parameter.KEYWORD_ONLY and not starred:
                parameters.append("*")
                starred = True
            given = declared[parameter.name].given if parameter.name in declared else ""
            kind = _widened(given, str(parameter.annotation).strip("'\""))
            optional = parameter.default is not parameter.empty
            parameters.append(f"{parameter.name}: {kind}" + (" = ..." if optional else ""))
            for word in _NAME.findall(kind):
                if word in known:
                    imports.add((known[word], word))
        summary = (inspect.getdoc(function) or "").partition("\n")[0]
        lines = "".join(f"    {each},\n" for each in parameters)
        functions.append(f'def {name}(\n{lines}) -> Controller:\n    """{summary}"""\n')
    return f"{HEAD}{_import_lines(imports)}\n" + "\n".join(functions)


def _import_lines(imports: set[tuple[str, str]]) -> str:
    """Return the imports, those of Python's own library first."""
    words: dict[str, list[str]] = {}
    for module, word in sorted(imports):
        words.setdefault(module, []).append(word)
    lines = [f"from {module} import {', '.join(names)}\n" for module, names in words.items()]
    own = [line for line in lines if line.startswith("from clepsydra.")]
    return "".join([*(line for line in lines if line not in own), "\n", *own])


def _widened(given: str, kind: str) -> str:
    """Return the type of an argument with the text, or the mapping, that it may be as well."""
    if given in ("quantity", "of signals"):
        return kind.replace("float", "Quantity")
    return f"Mapping[str, Mapping[str, float]] | {kind}" if given == "table" else kind


def _imported(function: Callable[..., object]) -> dict[str, str]:
    """Return the names that the module of a function has, each with the module it is from."""
    module = inspect.getmodule(function)
    assert module is not None
    found = {
        "Mapping": "collections.abc",
        "Quantity": "clepsydra.interface.quantities",
    }
    body = ast.parse(inspect.getsource(module)).body
    body += [node for each in body if isinstance(each, ast.If) for node in each.body]  # for types
    for node in body:
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {alias.asname or alias.name: node.module for alias in node.names}
        elif isinstance(node, ast.Assign | ast.ClassDef):
            targets = node.targets if isinstance(node, ast.Assign) else [ast.Name(node.name)]
            found |= {each.id: module.__name__ for each in targets if isinstance(each, ast.Name)}
    return {word: place for word, place in found.items() if word not in ("Controller", "Subject")}


def main() -> None:
    """Write it, or with --check say whether it is up to date."""
    text = stub()
    if "--check" in sys.argv:
        sys.exit(None if TARGET.read_text("utf-8") == text else f"{TARGET}: run .ci/design_stub.py")
    TARGET.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
