"""``python tools/mutants.py``: which single faults in src the tests of their package find.

A mutant is the source with one operator or one number changed, drawn by a fixed seed. Its package's
tests, those of its docstrings first, run on a copy of the tree until one fails; first in the fast
tier, then in the thorough one. A mutant that survives is listed, to be looked at: many change
nothing that a user could see. An interrupted run goes on with what was found.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).parents[1]
SOURCE = Path("src/clepsydra")
COPIED = ("src", "tests", "docs", "benchmarks", "tools", "pyproject.toml", ".ci")
#: One tier of one package; a mutant that makes it endless counts as found [s].
LONGEST = 900
OPERATORS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """A file with its text changed between two positions, counted in bytes."""

    file: str
    line: int
    start: int
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.old}  ->  {self.new}"


def changed(node: ast.AST) -> ast.expr | None:
    """Return an expression with one operator or number changed; None where there is none."""
    match node:
        case ast.Constant(value=bool(value)):
            return ast.Constant(not value)
        case ast.Constant(value=int(value)):
            return ast.Constant(value + 1)
        case ast.Constant(value=float(value)):
            return ast.Constant(1.5 * value or 1.0)
        case ast.Compare(ops=[operator]) if type(operator) in OPERATORS:
            return ast.Compare(node.left, [OPERATORS[type(operator)]()], node.comparators)
        case ast.BinOp(op=operator) if type(operator) in OPERATORS:
            return ast.BinOp(node.left, OPERATORS[type(operator)](), node.right)
        case ast.BoolOp(op=operator):
            return ast.BoolOp(OPERATORS[type(operator)](), node.values)
        case ast.UnaryOp(op=ast.Not() | ast.USub()):
            return node.operand
    return None


def expressions(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what runs: neither types nor formatted text, whose positions are not exact."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns") or isinstance(node, ast.JoinedStr):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from expressions(child)


def mutants(path: Path) -> Iterator[Mutant]:
    """Yield every mutant of a file."""
    text = path.read_bytes()
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node in expressions(ast.parse(text)):
        other = changed(node)
        if other is not None:
            start = starts[node.lineno - 1] + node.col_offset
            end = starts[node.end_lineno - 1] + node.end_col_offset
            old, new = text[start:end].decode(), f"({ast.unparse(other)})"
            yield Mutant(str(path), node.lineno, start, end, old, new)


def drawn(count: int, seed: int) -> list[Mutant]:
    """Draw mutants from all of the source, every place as likely as any other."""
    every = [each for path in sorted(SOURCE.rglob("*.py")) for each in mutants(path)]
    return random.Random(seed).sample(every, count)


def found_by(mutant: Mutant, folder: Path) -> str:
    """Return the first test of its package that fails; nothing where it survives."""
    path = folder / mutant.file
    sound = path.read_bytes()
    path.write_bytes(sound[: mutant.start] + mutant.new.encode() + sound[mutant.end :])
    package = Path(mutant.file).relative_to(SOURCE).parts[0]
    tests = [mutant.file, *(f for f in (f"tests/{package}", str(SOURCE / package))
                            if (folder / f).is_dir())]  # fmt: skip
    try:
        for tier in ("not thorough", "thorough"):
            finding = _first_failure(tests, tier, folder)
            if finding:
                return finding
    finally:
        path.write_bytes(sound)
    return ""


def _first_failure(tests: list[str], tier: str, folder: Path) -> str:
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-rfE",
        "-n",
        "0",
        "-m",
        tier,
        "-p",
        "no:cacheprovider",
    ]
    environment = {**os.environ, "PYTHONPATH": str(folder / "src"), "OPENBLAS_NUM_THREADS": "1"}
    try:
        run = subprocess.run([*command, *tests], cwd=folder, env=environment, text=True,
                             capture_output=True, timeout=LONGEST)  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"{tier}: no end within {LONGEST} s"
    if run.returncode in (0, 5):  # 5: no test in this tier
        return ""
    failed = [line for line in run.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return f"{tier}: {failed[0][:160] if failed else 'its tests cannot be collected'}"


def main() -> None:
    """Draw, try and list."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument(
        "--kept",
        type=Path,
        default=Path("mutants.json"),
        help="what was found, to go on with; remove it when tests have changed",
    )
    arguments = parser.parse_args()
    kept = arguments.kept.resolve()
    os.chdir(ROOT)
    text = json.loads(kept.read_text()) if kept.exists() else []
    found = {Mutant(**each["mutant"]): each["found"] for each in text}
    wanted = drawn(arguments.count, arguments.seed)
    with tempfile.TemporaryDirectory() as work, ThreadPoolExecutor(arguments.jobs) as pool:
        folders: SimpleQueue[Path] = SimpleQueue()
        for job in range(arguments.jobs):
            folders.put(_copy(Path(work, str(job))))

        def tried(mutant: Mutant) -> None:
            folder = folders.get()
            found[mutant] = found_by(mutant, folder)
            folders.put(folder)
            both = [{"mutant": asdict(each), "found": one} for each, one in found.items()]
            kept.write_text(json.dumps(both, indent=1))
            print(f"{found[mutant] or 'SURVIVES':60.60}  {mutant}", flush=True)

        list(pool.map(tried, [mutant for mutant in wanted if mutant not in found]))
    alive = [mutant for mutant in wanted if not found[mutant]]
    print(f"{len(wanted) - len(alive)} of {len(wanted)} found; {len(alive)} survive:")
    print("\n".join(map(str, alive)))


def _copy(folder: Path) -> Path:
    folder.mkdir()
    for source in (*map(ROOT.joinpath, COPIED), *ROOT.glob("*.md")):
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, folder / source.name)
    return folder


if __name__ == "__main__":
    main()
