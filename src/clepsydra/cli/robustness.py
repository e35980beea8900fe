"""``clepsydra robustness``: a controller on many plants that are not quite the one on paper."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from clepsydra.cli.options import (
    JsonOption,
    OutputOption,
    SubjectArgument,
    all_option,
    controller_option,
)
from clepsydra.cli.verb import verb


@verb(37)
def robustness(
    subject: SubjectArgument,
    controller: str | None = controller_option(
        "As the study calls it, in quotation marks; the one that it recommends if left out."
    ),
    draws: int = typer.Option(1000, min=1, help="How many plants."),
    seed: int | None = typer.Option(
        None, min=0, help="Of the draws; 1, or that of the study file."
    ),
    sensitivity: bool = typer.Option(
        True,
        "--sensitivity/--no-sensitivity",
        help="Whether it is found which parameters the scatter comes from.",
    ),
    resume: bool = typer.Option(
        False, "--resume", help="Go on where the same command was interrupted."
    ),
    workers: int | None = typer.Option(
        None, min=1, help="Draw in so many processes of this machine, instead of in threads."
    ),
    cluster: str | None = typer.Option(
        None,
        metavar="ADDRESS",
        help="Draw on the workers of a scheduler of dask.distributed, as in tcp://10.0.0.1:8786.",
    ),
    every: bool = all_option("Show every score, cause and reason."),
    as_json: JsonOption = False,
    folder: OutputOption = None,
) -> None:
    """Put a controller on many plants; tell how much worse it gets, and why."""
    from clepsydra.base.errors import InputError
    from clepsydra.base.standing import Standing, standing_at
    from clepsydra.cli.output import named_options, results_folder, tell, write_json, written_files
    from clepsydra.cli.progress import shown_progress
    from clepsydra.cli.subject import study_of
    from clepsydra.interface.export import identifier_of
    from clepsydra.interface.robustness import robustness as robustness_of
    from clepsydra.interface.subject import read_subject

    place = results_folder(folder, as_json=as_json)
    request = read_subject(subject, seed)
    study = study_of(request, controller, seed, place, quiet=as_json)
    chosen = study.recommended if controller is None else study[controller]
    stem = f"{request.file_stem}-{identifier_of(chosen.controller.name).replace('_', '-')}"
    files = written_files(place, f"{stem}-robustness", report="html", data="json")
    state = (place or Path()) / f"{stem}-draws.json"
    left = standing_at(state, "--output", "draws of an interrupted command") is not Standing.NOTHING
    if left and not resume:
        raise InputError(
            "--resume", str(state), "no draws of an interrupted command, or --resume",
            "add --resume to go on with them, or delete the file to begin again",
        )  # fmt: skip
    options = {"robustness, workers": "--workers"}
    try:
        with (
            named_options("workers", "cluster", **options),
            _with_sockets(),
            shown_progress(quiet=as_json) as say,
        ):
            found = robustness_of(
                chosen.controller,
                request,
                draws=draws,
                seed=study.scenario.seed,
                sensitivity=sensitivity,
                workers=workers,
                cluster=cluster,
                state_file=None if place is None else state,
                progress=say,
            )
    except KeyboardInterrupt:
        if place is not None:
            typer.echo("The same command with --resume goes on from here.", err=True)
        raise
    if files:
        found.report(files["report"])
        write_json(found.as_dict(), files["data"])
    state.unlink(missing_ok=True)
    tell(found, files, as_json=as_json, every=every)


@contextmanager
def _with_sockets() -> Iterator[None]:
    """Let a connection that closes be an error of its own, and what is routine about it unsaid.

    The command ends in silence where its output is read no further; that signal comes from a
    worker's connection as well.
    """
    os.environ.setdefault("DASK_LOGGING__DISTRIBUTED", "warning")  # read when it is loaded
    pipe = getattr(signal, "SIGPIPE", None)
    if pipe is None:
        yield
        return
    before = signal.signal(pipe, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(pipe, before)
