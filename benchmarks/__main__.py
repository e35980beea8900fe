"""``python -m benchmarks``: measure, print the tables, and with ``--write`` document them."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from benchmarks import fuzzy, machine, page, tuning
from benchmarks.cplusplus import CompilerMissing
from benchmarks.draws import page as draws_page
from benchmarks.draws import times as draw_times
from benchmarks.experiments import FULL, QUICK, Disagreement, Experiments, Size
from benchmarks.exported import page as exported_page
from benchmarks.exported import times as exported
from benchmarks.exported import web_page
from benchmarks.exported.loops import measure_loops
from benchmarks.exported.web import measure_controllers
from benchmarks.live import drags
from benchmarks.live import page as live_page
from benchmarks.programs import page as programs_page
from benchmarks.programs import times as program_times
from benchmarks.rig import lateness
from benchmarks.rig import page as rig_page
from benchmarks.scale import Scale
from benchmarks.studies import page as studies_page
from benchmarks.studies import trees
from benchmarks.studies.installation import InstallationTimes
from benchmarks.studies.times import StudyTimes

T = TypeVar("T")
Facts = list[tuple[str, str]]
#: For so long a rig is measured, times the slow rounds [s].
_RIG_SECONDS = 36.0


@dataclass(frozen=True)
class Order:
    """What is measured of a section, and where.

    Parameters
    ----------
    size : Size
    folder : Path
        For what is built; empty at the start.
    facts : list of pairs
        What a reader must know of this machine.
    since : str or None
        Commit that is measured beside the present tree.
    installation : bool
        Whether installations are measured too.
    """

    size: Size
    folder: Path
    facts: Facts
    since: str | None
    installation: bool


@dataclass(frozen=True)
class Document:
    """Tables as they are printed, and how they come onto their pages."""

    text: str
    write: Callable[[], None]


@dataclass(frozen=True)
class Section:
    """A part of the documentation that is measured by itself."""

    facts: Callable[[], Facts]
    measure: Callable[[Order], Document]


def _tell(what: str) -> None:
    print(f"measuring: {what} …", file=sys.stderr, flush=True)


def _progress(what: str, measure: Callable[[], T]) -> T:
    _tell(what)
    return measure()


def _engine(order: Order) -> Document:
    size = order.size
    experiments = Experiments(size, order.folder)
    scale = Scale(size.slow_rounds, size.operations, order.folder)
    text = page.render(
        page.Results(
            machine=order.facts,
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
    )
    return Document(text, lambda: page.write(text))


def _draws(order: Order) -> Document:
    _tell("draws of a robustness run")
    found = draw_times.measure(order.size, order.folder)
    text = draws_page.render(found, order.facts, order.size.slow_rounds)
    return Document(text, lambda: draws_page.write_page(text))


def _exported(order: Order) -> Document:
    rounds = order.size.rounds
    found = exported.measure(rounds, order.folder, lambda name: _tell(f"exported code, {name}"))
    return Document(
        exported_page.times(found, order.facts, rounds),
        lambda: exported_page.write_pages(found, order.facts, rounds),
    )


def _web(order: Order) -> Document:
    rounds = order.size.rounds
    controllers, loops = measure_controllers(rounds, _tell), measure_loops(rounds, _tell)
    text = web_page.render(controllers, loops, order.facts, rounds)
    return Document(text, lambda: web_page.write_page(text))


def _studies(order: Order) -> Document:
    size, folder = order.size, order.folder
    after = trees.present(folder / "present")
    before = trees.earlier(order.since, folder / "earlier") if order.since else None
    studies = StudyTimes(after, before, folder / "studies", _tell)
    rows, notes = studies.rows(size.slow_rounds, size.long_rounds), studies.notes
    rounds = f"rounds: {size.slow_rounds}, of surge drum and vessel {size.long_rounds}"
    if order.installation:
        installation = InstallationTimes(after, before, folder / "installation", _tell)
        rows = [*rows, *installation.rows(size.long_rounds)]
        notes = [*notes, *installation.notes]
        rounds += f", of README line 1 {size.long_rounds}, of line 2 one"
    text = studies_page.render(rows, order.facts, after, before, rounds, notes)
    return Document(text, lambda: studies_page.write_page(text))


def _live(order: Order) -> Document:
    rounds = order.size.rounds
    found = drags.measure(rounds, order.folder, _tell)
    text = live_page.render(found, order.facts, rounds)
    return Document(text, lambda: live_page.write_page(text))


def _programs(order: Order) -> Document:
    rounds = order.size.rounds
    text = programs_page.render(program_times.measure(rounds, _tell), order.facts, rounds)
    return Document(text, lambda: programs_page.write_page(text))


def _rig(order: Order) -> Document:
    seconds = _RIG_SECONDS * order.size.slow_rounds
    found = lateness.measure(seconds, order.folder, _tell)
    text = rig_page.render(found, order.facts, seconds)
    return Document(text, lambda: rig_page.write_page(text))


SECTIONS = {
    "engine": Section(machine.description, _engine),
    "draws": Section(draws_page.facts, _draws),
    "exported": Section(exported_page.facts, _exported),
    "live": Section(live_page.facts, _live),
    "programs": Section(programs_page.facts, _programs),
    "rig": Section(rig_page.facts, _rig),
    "web": Section(web_page.facts, _web),
    "studies": Section(studies_page.facts, _studies),
}


def options(arguments: list[str] | None = None) -> argparse.Namespace:
    """Return what the command line says; of the program itself where it is left out."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few rounds, to see that it works")
    parser.add_argument("--write", action="store_true", help="update the pages of docs")
    parser.add_argument("--only", choices=SECTIONS, help="measure and write this section alone")
    parser.add_argument(
        "--since", metavar="COMMIT", help="studies: measure this commit too, in the same rounds"
    )
    parser.add_argument(
        "--installation",
        action="store_true",
        help="studies: the README's two lines too, which takes tens of minutes a commit",
    )
    read = parser.parse_args(arguments)
    if read.only not in (None, "studies") and (read.since or read.installation):
        parser.error(f"--since and --installation are about studies, not about {read.only}")
    return read


def main() -> int:
    """Run everything and return the exit status."""
    read = options()
    chosen = [read.only] if read.only else list(SECTIONS)
    try:
        if read.since:
            trees.short_name(read.since)
        facts = {name: SECTIONS[name].facts() for name in chosen}
        for name in chosen:
            with tempfile.TemporaryDirectory() as folder:
                order = Order(
                    QUICK if read.quick else FULL, Path(folder), facts[name], read.since,
                    read.installation,
                )  # fmt: skip
                document = SECTIONS[name].measure(order)
            print(document.text)
            if read.write:
                document.write()
                print(f"written: {name}", file=sys.stderr)
    except (CompilerMissing, Disagreement, RuntimeError) as error:
        print(f"benchmarks: {error}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        print(
            f"benchmarks: {error.name} is not installed; pip install '.[bench]' brings it",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
