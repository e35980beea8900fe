"""``python -m benchmarks``: measure, print the tables, and with ``--write`` document them."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from benchmarks import fuzzy, machine, page, tuning
from benchmarks.cplusplus import CompilerMissing
from benchmarks.experiments import FULL, QUICK, Disagreement, Experiments
from benchmarks.exported import page as exported_page
from benchmarks.exported import times as exported
from benchmarks.scale import Scale

T = TypeVar("T")


def _tell(what: str) -> None:
    print(f"measuring: {what} …", file=sys.stderr, flush=True)


def _progress(what: str, measure: Callable[[], T]) -> T:
    _tell(what)
    return measure()


def main() -> int:
    """Run everything and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few rounds, to see that it works")
    parser.add_argument("--write", action="store_true", help=f"update {page.PAGE.name}")
    arguments = parser.parse_args()
    size = QUICK if arguments.quick else FULL
    try:
        facts, exported_facts = machine.description(), exported_page.facts()
        with tempfile.TemporaryDirectory() as folder:
            experiments = Experiments(size, Path(folder))
            scale = Scale(size.slow_rounds, size.operations, Path(folder))
            results = page.Results(
                machine=facts,
                rounds=f"{size.rounds} rounds ({size.slow_rounds} on two cores, "
                "for first calls, the command line, chains, the catalogue and tuning, "
                "SciPy's once)",
                batch=_progress("batch on one core", experiments.batch),
                one_run=_progress("one run", experiments.one_run),
                two_cores=_progress("large batch on two cores", experiments.two_cores),
                first_call=_progress("first calls", experiments.first_call),
                command_line=_progress("command line", experiments.command_line),
                chains=_progress("chains of tanks", scale.chains),
                catalogue=_progress("processes of the catalogue", scale.catalogue),
                tuning=_progress("tuning", lambda: tuning.measure(size.slow_rounds)),
                fuzzy=_progress("fuzzy control", lambda: fuzzy.measure(size.slow_rounds)),
            )
            code = exported.measure(
                size.rounds, Path(folder) / "exported", lambda name: _tell(f"exported code, {name}")
            )
    except (CompilerMissing, Disagreement, RuntimeError) as error:
        print(f"benchmarks: {error}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        print(
            f"benchmarks: {error.name} is not installed; pip install '.[bench]' brings it",
            file=sys.stderr,
        )
        return 1
    text = page.render(results)
    print(text)
    print(exported_page.times(code, exported_facts, size.rounds))
    if arguments.write:
        page.write(text)
        exported_page.write_pages(code, exported_facts, size.rounds)
        print(f"written: {page.PAGE} and {exported_page.SIZES_PAGE}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
