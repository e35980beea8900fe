"""``clepsydra simulate``: a process on its own, under inputs that are given in words or a file."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from clepsydra.cli.options import (
    JsonOption,
    OutputOption,
    SubjectArgument,
    all_option,
    named_values,
)
from clepsydra.cli.subject import name_of
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.controller import AnyController
    from clepsydra.interface.events import Change, Event
    from clepsydra.interface.plant import Plant


#: What integrates, and how trajectories are written.
Solver = StrEnum("Solver", {"kernel": "kernel", "reference": "reference"})
Format = StrEnum("Format", ["parquet", "csv"])


@verb(20)
def simulate(
    process: SubjectArgument,
    inputs: list[str] | None = typer.Option(
        None,
        "--input",
        metavar="NAME=VALUE[@TIME[..TIME|+TIME]]",
        help="What an input or a disturbance does: pump_1=3.2V from the start, "
        "pump_1=3.5V@60s as a step, pump_1=4V@60s..120s as a ramp, pump_1=4V@60s+5s for 5 s; "
        "several in order of time. Without one, the process stays at rest.",
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
    controller: str | None = typer.Option(
        None,
        metavar="NAME|FILE.mat",
        callback=name_of,
        help="Under a controller, as the study calls it, in quotation marks, or the regulator of "
        "a file with matrices A, B, C and D, from errors to outputs in the units that are shown: "
        "then --input moves setpoints, as in level_1=60%@60s, and loads; without any it is the "
        "default scenario, away from rest the way to the setpoints.",
    ),
    start: str = typer.Option("rest", metavar="[rest|empty]", help="At rest, or with empty tanks."),
    state: list[str] | None = typer.Option(
        None,
        metavar="NAME=VALUE",
        help="A state that starts elsewhere, as in tank_1.level=5cm; under a controller what an "
        "input stands at, pump_1=2V, and controller.level_1.integral=0V.",
    ),
    controller_start: str | None = typer.Option(
        None,
        metavar="[bumpless|cold]",
        help="How the controller starts away from rest: as after a time in manual, if left out, or "
        "with integrals at zero; a regulator of a file then as in a simulation program, u = C x + "
        "D e from zero state and without anti-windup.",
    ),
    noise: bool = typer.Option(
        False,
        "--noise",
        help="Under a controller, with the noise that the process file gives of sensors, pumps "
        "and flows.",
    ),
    seed: int = typer.Option(1, min=0, help="Seed of the noise."),
    solver: Solver = typer.Option(
        Solver.kernel, help="The compiled kernel, or CVODES to compare with."
    ),
    data_format: Format = typer.Option(Format.parquet, "--format", help="Of the trajectories."),
    every: bool = all_option("Show every signal and balance, with times."),
    as_json: JsonOption = False,
    folder: OutputOption = None,
) -> None:
    """Simulate a process, on its own or under a controller; write report and trajectories."""
    from clepsydra.cli.output import named_options, results_folder, tell, written_files
    from clepsydra.cli.subject import is_regulator, regulator_of, study_of
    from clepsydra.interface.simulate import simulate as simulated
    from clepsydra.interface.subject import plant_of, read_subject

    place = results_folder(folder, as_json=as_json)
    request = read_subject(process)
    plant = plant_of(request)
    kinds = (
        {"trajectories": data_format}
        if controller
        else {"report": "html", "trajectories": data_format}
    )
    stem = f"{request.file_stem}-simulation"
    files = written_files(place, stem, **kinds)
    remedy = "write as in --state tank_1.level=5cm"
    begins = named_values(state, "state", "--state {}", remedy)
    how: dict[str, Any] = {
        "duration": duration,
        "start": start,
        "state": begins,
        "controller_start": controller_start,
        "noise": noise,
        "solver": solver.value,
    }
    with named_options("state", "start", "duration", "controller_start", "noise"):
        if controller is None:
            changes = _changes(plant, inputs or [], profile)
            run: Any = simulated(plant, None, changes, **how)
        else:
            events = _events(plant, inputs or [], profile)
            made: AnyController
            if is_regulator(controller, request):
                made = regulator_of(plant, controller, cold=controller_start == "cold")
            else:
                found = study_of(request, controller, None, place, quiet=as_json)
                made = found[controller].controller
            run = simulated(plant, made, events, seed=seed, **how)
    if "report" in files:
        run.report(files["report"])
    if files:
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


def _events(plant: Plant, inputs: list[str], profile: Path | None) -> list[Event] | None:
    from clepsydra.base.errors import InputError
    from clepsydra.interface.events import event_in_words

    if profile is not None:
        raise InputError(
            "--profile", str(profile), "no profile of inputs, which the controller moves",
            "move setpoints and loads by --input, or leave out --controller",
        )  # fmt: skip
    events = [event_in_words(text, f"--input {text[:60]}") for text in inputs]
    return events or None
