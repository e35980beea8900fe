"""``clepsydra simulate``: a process on its own, under inputs that are given in words or a file."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clepsydra.cli.options import JsonOption, ProcessArgument

if TYPE_CHECKING:
    from clepsydra.loop.open_loop import Simulation
    from clepsydra.loop.open_loop_plan import Plan
    from clepsydra.loop.profile import Change
    from clepsydra.process.process import Process


class Start(StrEnum):
    """Where a simulation begins."""

    rest = "rest"
    empty = "empty"


class Solver(StrEnum):
    """What integrates."""

    kernel = "kernel"
    reference = "reference"


class Format(StrEnum):
    """How trajectories are written."""

    parquet = "parquet"
    csv = "csv"


def simulate(
    process: ProcessArgument,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input",
            metavar="NAME=VALUE[@TIME[..TIME]]",
            help="What an input or a disturbance does: pump_1=3.2V from the start, "
            "pump_1=3.5V@60s as a step, pump_1=4V@60s..120s as a ramp; several in order of time. "
            "Without one, the process stays at rest.",
        ),
    ] = None,
    profile: Annotated[
        Path | None,
        typer.Option(
            "--profile",
            metavar="FILE.csv",
            help="Values over time, with a head such as time \\[s],pump_1 \\[V]; each is held "
            "until the next row.",
        ),
    ] = None,
    duration: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="As in '20 min'; if left out, six times the slowest time constant after the last "
            "change, longer for tanks in series and dead times.",
        ),
    ] = None,
    start: Annotated[Start, typer.Option(help="At rest, or with empty tanks.")] = Start.rest,
    state: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE", help="A state that starts elsewhere, as in tank_1.level=5cm."
        ),
    ] = None,
    solver: Annotated[
        Solver, typer.Option(help="The compiled kernel, or CVODES to compare with.")
    ] = Solver.kernel,
    data_format: Annotated[
        Format, typer.Option("--format", help="Of the trajectories.")
    ] = Format.parquet,
    as_json: JsonOption = False,
    folder: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="FOLDER", help="Where report and data are written."),
    ] = Path(),
) -> None:
    """Simulate a process without a controller; write report and trajectories."""
    from clepsydra.cli.output import make_folder, output_file, print_json
    from clepsydra.loop.open_loop_plan import plan_simulation
    from clepsydra.loop.trajectory_file import write_trajectories
    from clepsydra.process.reader import load_process
    from clepsydra.report.simulation_page import write_simulation_page

    make_folder(folder)
    plant = load_process(process)
    name = f"{plant.file_stem}-simulation"
    report, data = (output_file(folder / f"{name}.{end}") for end in ("html", data_format.value))
    plan = plan_simulation(
        plant,
        _changes(plant, inputs or [], profile),
        duration=duration,
        start=start.value,
        state=_states(plant, state or []),
    )
    run = plan.run(solver.value)
    write_simulation_page(plan, run, report)
    write_trajectories(run, data)
    written = {"report": str(report), "trajectories": str(data)}
    if as_json:
        print_json({**_document(plan, run), **written})
        return
    from rich.console import Console

    from clepsydra.report.simulation_screen import simulation_screen

    Console(width=100).print(simulation_screen(plan, run))
    for what, where in written.items():
        typer.echo(f"{what.capitalize()}: {where}")


def _changes(process: Process, inputs: list[str], profile: Path | None) -> list[Change]:
    from clepsydra.base.errors import InputError
    from clepsydra.loop.profile import read_assignment
    from clepsydra.loop.profile_csv import read_profile_csv

    changes = [read_assignment(text, process, f"--input {text[:60]}") for text in inputs]
    if profile is None:
        return changes
    of_file = read_profile_csv(profile, process)
    for change in changes:
        if any(change.signal == other.signal for other in of_file):
            raise InputError(
                change.place, change.signal, f"a signal that {profile} does not give as well",
                "leave out the option or the column",
            )  # fmt: skip
    return [*changes, *of_file]


def _states(process: Process, texts: list[str]) -> dict[str, float]:
    from clepsydra.base.errors import InputError
    from clepsydra.loop.open_loop_plan import read_state

    states: dict[str, float] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.strip()
        if not equals or name in states:
            raise InputError(
                f"--state {text[:60]}", text[:60],
                "each state once" if equals else "a state, '=' and its value",
                "write as in --state tank_1.level=5cm",
            )  # fmt: skip
        states[name] = read_state(name, value, process, "--state")
    return states


def _document(plan: Plan, run: Simulation) -> dict[str, Any]:
    """Return plan and result as values for JSON, in SI."""
    import numpy as np

    process = plan.process
    extremes = {}
    for signal in run.signals:
        values = run.values[signal.name]
        low, high = int(np.argmin(values)), int(np.argmax(values))
        extremes[signal.name] = {
            "unit": signal.unit,
            "start": float(values[0]),
            "end": float(values[-1]),
            "smallest": {"value": float(values[low]), "time": float(run.time[low])},
            "largest": {"value": float(values[high]), "time": float(run.time[high])},
        }
    return {
        "process": process.name,
        "start": plan.begins,
        "duration": plan.duration,
        "sampling_period": process.sampling_period,
        "samples": plan.samples,
        "changes": [
            {
                "signal": change.signal,
                "value": change.value,
                "unit": process.signal(change.signal).unit,
                "start": change.start,
                "stop": change.stop,
            }
            for change in plan.changes
        ],
        "signals": extremes,
        "events": [
            {"time": e.time, "event": e.event, "words": e.words, "times": e.times}
            for e in run.happenings
        ],
        "balances": [
            {
                "name": b.name,
                "unit": b.unit,
                "entered": b.entered,
                "left": b.left,
                "gained": b.gained,
                "error": b.error,
            }
            for b in run.balances
        ],
        "ended": run.end and {"time": run.end.time, "event": run.end.event},
        "substeps": run.substeps,
        "error_estimate": run.error_estimate,
        "warnings": list(plan.point.warnings),
    }
