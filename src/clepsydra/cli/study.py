"""``clepsydra study``: controllers designed, tuned, simulated, scored and ranked."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

from clepsydra.cli.options import JsonOption, OutputOption, all_option
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.study import Study

#: Of the file of trajectories, unless every run is asked for [bytes].
LARGEST = 10_000_000


@verb(10)
def study(
    subject: str = typer.Argument(
        ...,
        metavar="PROCESS|STUDY.toml",
        help="A process of the catalogue or a process file: every design that applies. Or a "
        "study file, which names the controllers; write one with clepsydra new --study.",
    ),
    as_json: JsonOption = False,
    folder: OutputOption = None,
    every: bool = all_option("Show the whole ranking, not only its first five."),
    why: bool = typer.Option(
        False, "--why", help="Show the reason of every place, and all warnings."
    ),
    refused: bool = typer.Option(False, "--refused", help="Show what does not apply, and why not."),
    accept: float = typer.Option(
        1.5,
        min=1.0,
        metavar="TIMES",
        help="Good enough is an error of so many times that of the best; on a plant of one "
        "loop, that of the best PI or PID.",
    ),
    every_run: bool = typer.Option(
        False,
        "--every-run",
        help="Write the trajectories of every controller, not only of the first 10 MB: the "
        "recommended one, and then by rank.",
    ),
    limit: bool | None = typer.Option(
        None,
        "--limit/--no-limit",
        help="Find what the best possible controller could do, and compare with it: in a terminal "
        "after the ranking is shown, elsewhere on request.",
    ),
    draws: int = typer.Option(
        64,
        min=0,
        help="Plants, drawn about the parameters of the process, that the first five controllers "
        "have to settle on; 0 for none. More of them: clepsydra robustness.",
    ),
    seed: int | None = typer.Option(
        None, min=0, help="Seed of noise and tuning; 1, or that of the study file, if left out."
    ),
) -> None:
    """Design, tune, simulate, score and rank controllers; write report and data."""
    from clepsydra.cli.output import print_json, results_folder, show, written_files
    from clepsydra.cli.progress import shown_progress
    from clepsydra.interface.study import newest, so_far
    from clepsydra.interface.study import study as study_of
    from clepsydra.interface.subject import read_subject

    place = results_folder(folder, as_json=as_json)
    request = read_subject(subject, seed)
    named = {"report": "html", "trajectories": "parquet"}
    files = written_files(place, request.file_stem, **named)
    with shown_progress(so_far, newest, quiet=as_json) as tell:
        result = study_of(request, seed=seed, accept=accept, progress=tell, folder=place)
    if draws:
        result = _with_draws(result, draws, quiet=as_json)
    if not as_json:
        show(result.shown(every=every, why=why, refused=refused))
    if sys.stdout.isatty() if limit is None else limit:
        result = _with_limits(result, quiet=as_json)
    saved = 0
    if files:
        result.report(files["report"])
        if result.ranking:
            largest = None if every_run else LARGEST
            saved = result.save(files["trajectories"], largest=largest)
        else:
            del files["trajectories"]
    if as_json:
        print_json({**result.as_dict(), **files})
    else:
        typer.echo(f"Written: {files['report']}{' and .parquet' if saved else ''}")
        if saved < len(result.ranking):
            left = f"{saved} of {len(result.ranking)} controllers; all of them: --every-run"
            typer.echo(f"Trajectories of {left}")


def _with_draws(result: Study, draws: int, *, quiet: bool) -> Study:
    """Return a study whose first controllers met drawn plants; as it was where interrupted."""
    from clepsydra.cli.progress import shown_progress

    try:
        with shown_progress(quiet=quiet) as tell:
            return result.with_draws(draws, tell)
    except KeyboardInterrupt:
        typer.echo("Interrupted: the study is whole but for the drawn plants.", err=True)
        return result


def _with_limits(result: Study, *, quiet: bool) -> Study:
    """Return a study with its physical limit, shown; as it was where that was interrupted."""
    from clepsydra.cli.output import show
    from clepsydra.cli.progress import shown_progress

    try:
        with shown_progress(quiet=quiet) as tell:
            result = result.with_limits(tell)
    except KeyboardInterrupt:
        typer.echo("Interrupted: the study is whole but for the physical limit.", err=True)
        return result
    if not quiet:
        typer.echo()
        show(result.beside_limit())
    return result
