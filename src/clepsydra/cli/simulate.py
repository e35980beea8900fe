"""``clepsydra simulate``: a process on its own, under inputs that are given in words or a file."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clepsydra.cli.options import (
    JsonOption,
    OutputOption,
    ProcessArgument,
    all_option,
    named_values,
)
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.events import Change
    from clepsydra.interface.plant import Plant


#: Where a simulation begins, what integrates, and how trajectories are written.
Start = StrEnum("Start", {"rest": "rest", "empty": "empty"})
Solver = StrEnum("Solver", {"kernel": "kernel", "reference": "reference"})
Format = StrEnum("Format", ["parquet", "csv"])


@verb(20)
def simulate(
    process: ProcessArgument,
    inputs: list[str] | None = typer.Option(
        None,
        "--input",
        metavar="NAME=VALUE[@TIME[..TIME]]",
        help="What an input or a disturbance does: pump_1=3.2V from the start, "
        "pump_1=3.5V@60s as a step, pump_1=4V@60s..120s as a ramp; several in order of time. "
        "Without one, the process stays at rest.",
    ),
    profile: Path | None = typer.Option(
        None,
        "--profile",
        metavar="FILE.csv",
        help="Values over time, with a head such as time \\[s],pump_1 \\[V]; each is held "
        "until the next row.",
    ),
    duration: str | None = typer.Option(
        None,
        metavar="TIME",
        help="As in '20 min'; if left out, six times the slowest time constant after the last "
        "change, longer for tanks in series and dead times.",
    ),
    start: Start = typer.Option(Start.rest, help="At rest, or with empty tanks."),
    state: list[str] | None = typer.Option(
        None, metavar="NAME=VALUE", help="A state that starts elsewhere, as in tank_1.level=5cm."
    ),
    solver: Solver = typer.Option(
        Solver.kernel, help="The compiled kernel, or CVODES to compare with."
    ),
    data_format: Format = typer.Option(Format.parquet, "--format", help="Of the trajectories."),
    every: bool = all_option("Show every signal and balance, with times."),
    as_json: JsonOption = False,
    folder: OutputOption = None,
) -> None:
    """Simulate a process without a controller; write report and trajectories."""
    from clepsydra.cli.output import named_options, results_folder, tell, written_files
    from clepsydra.interface.plant import load
    from clepsydra.interface.simulate import simulate as simulated

    place = results_folder(folder, as_json=as_json)
    plant = load(process)
    stem, named = f"{plant.file_stem}-simulation", {"report": "html", "trajectories": data_format}
    files = written_files(place, stem, **named)
    changes = _changes(plant, inputs or [], profile)
    remedy = "write as in --state tank_1.level=5cm"
    begins = named_values(state, "state", "--state {}", remedy)
    with named_options("state", "duration"):
        run = simulated(
            plant,
            None,
            changes,
            duration=duration,
            start=start.value,
            state=begins,
            solver=solver.value,
        )
    if files:
        run.report(files["report"])
        run.save(files["trajectories"])
    tell(run, files, as_json=as_json, every=every)


def _changes(plant: Plant, inputs: list[str], profile: Path | None) -> list[Change]:
    from clepsydra.base.errors import InputError
    from clepsydra.interface.events import change_in_words
    from clepsydra.interface.events import profile as changes_of_file

    changes = [change_in_words(text, plant, f"--input {text[:60]}") for text in inputs]
    if profile is None:
        return changes
    of_file = changes_of_file(profile, plant)
    for change in changes:
        if any(change.signal == other.signal for other in of_file):
            raise InputError(
                change.place, change.signal, f"a signal that {profile} does not give as well",
                "leave out the option or the column",
            )  # fmt: skip
    return [*changes, *of_file]
