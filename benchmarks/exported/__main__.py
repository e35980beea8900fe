"""``python -m benchmarks.exported``: measure exported code, and with ``--write`` document it."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from benchmarks.cplusplus import CompilerMissing
from benchmarks.experiments import FULL, QUICK, Disagreement
from benchmarks.exported import page
from benchmarks.exported.times import measure


def main() -> int:
    """Measure, print the tables, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.exported", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few rounds, to see that it works")
    parser.add_argument("--write", action="store_true", help=f"update {page.SIZES_PAGE.name}")
    arguments = parser.parse_args()
    rounds = (QUICK if arguments.quick else FULL).rounds
    try:
        described = page.facts()
        with tempfile.TemporaryDirectory() as folder:
            found = measure(rounds, Path(folder), _tell)
    except (CompilerMissing, Disagreement, RuntimeError) as error:
        print(f"benchmarks: {error}", file=sys.stderr)
        return 1
    print(page.sizes(found, described, rounds))
    print(page.times(found, described, rounds))
    if arguments.write:
        page.write_pages(found, described, rounds)
        print(f"written: {page.SIZES_PAGE} and {page.PAGE}", file=sys.stderr)
    return 0


def _tell(name: str) -> None:
    print(f"measuring: {name} …", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
