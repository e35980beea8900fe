"""House rule that no linter knows: a test reads no clock, since machines are busy.

How long something takes is a ratio in `benchmarks/`. A test may wait, for longer than the slowest
machine needs, by `wait_until` of the one file that reads a clock.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

#: Where a test waits.
WAITING = "waiting.py"
#: All that a module has is a clock; none of these has anything else that a test needs.
_MODULES = frozenset({"timeit", "cProfile", "profile"})
#: Attributes that tell the time, by what they are attributes of.
_CLOCKS = {
    "time": frozenset(
        f"{name}{ending}"
        for name in ("time", "monotonic", "perf_counter", "process_time", "thread_time")
        for ending in ("", "_ns")
    )
    | {"clock_gettime", "clock_gettime_ns"},
    "os": frozenset({"times"}),
    "resource": frozenset({"getrusage"}),
    "datetime": frozenset({"now", "utcnow", "today"}),
    "date": frozenset({"today"}),
}


def clocks(text: str) -> list[int]:
    """Return the lines of a file of Python in which a clock is read, or imported to be read."""
    nodes = list(ast.walk(ast.parse(text)))
    aliases = {}
    found = []
    for node in nodes:
        for module, name, known_as in _imported(node):
            aliases[known_as] = (name or module).rpartition(".")[2]
            if module in _MODULES or name in _CLOCKS.get(module, ()):
                found.append(node.lineno)
    for node in nodes:
        if isinstance(node, ast.Attribute):
            owner = node.value
            called = owner.id if isinstance(owner, ast.Name) else getattr(owner, "attr", "")
            if node.attr in _CLOCKS.get(aliases.get(called, called), ()):
                found.append(node.lineno)
    return sorted(set(found))


def _imported(node: ast.AST) -> Iterator[tuple[str, str, str]]:
    """Yield module, name taken from it (or nothing), and what it is known as."""
    if isinstance(node, ast.Import):
        yield from ((each.name, "", each.asname or each.name) for each in node.names)
    elif isinstance(node, ast.ImportFrom) and node.module:
        yield from ((node.module, each.name, each.asname or each.name) for each in node.names)


def read_in(folder: Path) -> list[str]:
    """Return what is wrong in the tests of a folder, a line each."""
    return [
        f"{path}:{line}: a test reads a clock; compare in benchmarks/, or wait by wait_until"
        for path in sorted(folder.rglob("*.py"))
        if path != folder / WAITING
        for line in clocks(path.read_text(encoding="utf-8"))
    ]
