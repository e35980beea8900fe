"""What a verb works on: a process or a study file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.studies.file.request import StudyRequest
    from clepsydra.studies.result import StudyResult

SubjectArgument = Annotated[
    str,
    typer.Argument(
        metavar="PROCESS|STUDY.toml",
        help="A process of the catalogue, a process file, or a study file.",
    ),
]


def read_subject(subject: str, seed: int | None = None) -> Process | StudyRequest:
    """Read a study file, or a process of the catalogue or of a file."""
    from clepsydra.process.reader import load_process
    from clepsydra.studies.file.reader import is_study_file, read_study

    return read_study(subject, seed=seed) if is_study_file(subject) else load_process(subject)


def name_of(controller: str | None) -> str | None:
    """Return the name that a controller is chosen by, of that name or the title of a table."""
    from clepsydra.controllers.controller import plain_name

    return None if controller is None else plain_name(controller)


def study_of_one(
    request: Process | StudyRequest, name: str, seed: int | None, folder: Path, *, quiet: bool
) -> StudyResult:
    """Make one controller of a study; refuse one that does not apply, with its reason."""
    from clepsydra.base.errors import InputError
    from clepsydra.cli.progress import shown_progress
    from clepsydra.studies.study import run_study

    with shown_progress(quiet=quiet) as tell:
        study = run_study(
            request,
            seed=1 if seed is None else seed,
            progress=tell,
            tuning_folder=folder,
            only=name,
        )
    reasons = dict(study.not_applicable)
    if name in reasons:
        raise InputError(
            "--controller", name, f"a controller that applies; this one does not: {reasons[name]}",
            "choose another; clepsydra study ranks those that apply",
        )  # fmt: skip
    return study
