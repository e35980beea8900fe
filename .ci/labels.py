"""House rule that no linter knows: what something is called decides nothing.

A symbol, a title, the text of a family and a name are for a reader. What a thing is, it declares
where it stands: an element, a block, a design, a score. The drawing reads symbols, since they say
how an element is drawn.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

_LABELS = frozenset({"symbol", "family", "title", "name"})
#: Methods of text that look at a part of it.
_PARTS = frozenset({"startswith", "endswith", "removeprefix", "removesuffix", "find", "count"})
#: Where labels may decide: what is drawn, and documents that are each about one plant.
FREE = ("report/drawing", "papers")
#: Names that are no label of the user's: of files, and of signals and parameters that the same
#: package wrote under this name, for itself.
OWN_NAMES = frozenset(
    {
        "process/catalogue_names.py",
        "process/declared.py",
        "controllers/blocks/final_element.py",
        "controllers/own_signals.py",
        "controllers/polynomial_controller.py",
        "deploy/fmi/process.py",
        "deploy/printing/body.py",
        "deploy/proof/scans.py",
        "deploy/structured_text/project.py",
        "identification/fitted_model.py",
        "identification/transfer_model.py",
        "loop/loop_state.py",
        "report/recording.py",
        "studies/file/start_stop_table.py",
        "studies/tuning/weight_space.py",
    }
)


def labels(text: str) -> list[tuple[int, str]]:
    """Return the lines of a file of Python in which a label decides, and which label."""
    return sorted({(node.lineno, label) for node, label in _deciding(ast.parse(text))})


def _deciding(tree: ast.AST) -> Iterator[tuple[ast.expr, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            if any(map(_is_text, sides)):
                yield from ((node, label) for side in sides if (label := _label(side)))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr in _PARTS and (label := _label(node.func.value)):
                yield node, label
        elif isinstance(node, ast.Match) and (label := _label(node.subject)):
            yield node.subject, label
        elif isinstance(node, ast.Subscript) and isinstance(node.value, ast.Dict):
            yield from ((node, label) for label in [_label(node.slice)] if label)


def _label(node: ast.expr) -> str:
    """Return the label that an expression reads; nothing if it reads none."""
    return node.attr if isinstance(node, ast.Attribute) and node.attr in _LABELS else ""


def _is_text(node: ast.expr) -> bool:
    """Whether an expression is a text, several, or a constant that would hold some."""
    if isinstance(node, ast.Tuple | ast.List | ast.Set):
        return bool(node.elts) and all(map(_is_text, node.elts))
    if isinstance(node, ast.Name | ast.Attribute):
        return (node.id if isinstance(node, ast.Name) else node.attr).lstrip("_").isupper()
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def decided_in(folder: Path) -> list[str]:
    """Return what a label decides in the source below a folder, a line each."""
    found = []
    for path in sorted(folder.rglob("*.py")):
        inside = path.relative_to(folder).as_posix()
        if not inside.startswith(FREE):
            found += [
                f"{path}:{line}: a {label} decides; declare it on the element, block, design or "
                "score, and ask that"
                for line, label in labels(path.read_text(encoding="utf-8"))
                if label != "name" or inside not in OWN_NAMES
            ]
    return found
