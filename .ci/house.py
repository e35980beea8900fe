"""House rules that no linter knows.

No file of src or page has more than 400 lines, no other more than 600, no test reads a clock, and
what something is called decides nothing.
"""

import sys
from pathlib import Path

from clocks import read_in
from labels import decided_in

LONGEST = 600
LONGEST_OF_SOURCE = 400
SUFFIXES = {".py", ".ts", ".cpp", ".toml", ".md", ".jinja", ".css"}
FOLDERS = ("src", "page/sources", "tests", "benchmarks", "docs", "tools", ".ci")


def longest(path: Path) -> int:
    """Return how many lines a file may have."""
    return LONGEST_OF_SOURCE if path.parts[0] in ("src", "page") else LONGEST


def main() -> None:
    """Exit with 1 and a list of what is too long, what reads a clock, and what a label decides."""
    files = [
        path
        for folder in FOLDERS
        for path in Path(folder).rglob("*")
        if path.suffix in SUFFIXES and path.is_file()
    ]
    files += [path for path in Path().glob("*") if path.suffix in SUFFIXES]
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    found = [
        f"{path}: {n} lines, at most {longest(path)}"
        for path, n in lengths.items()
        if n > longest(path)
    ]
    found += read_in(Path("tests"))
    found += decided_in(Path("src/clepsydra"))
    print(
        "\n".join(found)
        or f"{len(files)} files, none too long; no test reads a clock, no label decides"
    )
    sys.exit(1 if found or not files else 0)


if __name__ == "__main__":
    main()
