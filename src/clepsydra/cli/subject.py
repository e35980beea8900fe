"""What a verb works on: a process or a study file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.study.file.request import StudyRequest

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
    from clepsydra.study.file.reader import is_study_file, read_study

    return read_study(subject, seed=seed) if is_study_file(subject) else load_process(subject)
