"""House rule that no linter knows: no file above 600 lines."""

import sys
from pathlib import Path

LONGEST = 600
SUFFIXES = {".py", ".cpp", ".toml", ".md", ".jinja", ".css"}
FOLDERS = ("src", "tests", "benchmarks", "docs", "tools", ".ci")


def main() -> None:
    """Exit with 1 and a list of what is too long."""
    files = [
        path
        for folder in FOLDERS
        for path in Path(folder).rglob("*")
        if path.suffix in SUFFIXES and path.is_file()
    ]
    files += [path for path in Path().glob("*") if path.suffix in SUFFIXES]
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    found = [f"{path}: {n} lines, at most {LONGEST}" for path, n in lengths.items() if n > LONGEST]
    print("\n".join(found) or f"{len(files)} files, none above {LONGEST} lines")
    sys.exit(1 if found or not files else 0)


if __name__ == "__main__":
    main()
