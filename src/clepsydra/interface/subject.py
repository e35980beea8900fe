"""What is studied, exported or verified: a plant, or what a study file asks for."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.arguments import require_type
from clepsydra.interface.plant import Plant, load
from clepsydra.process.drawn import numbered as numbered
from clepsydra.studies.file.kind import is_study_file
from clepsydra.studies.file.request import StudyRequest as StudyRequest

#: What every call takes for its plant: one that is loaded, the name of a process, the path of its
#: file or of a study file, or what was read of the latter.
Subject = Plant | StudyRequest | str | Path


def read_subject(subject: str | Path, seed: int | None = None) -> Plant | StudyRequest:
    """Read a study file, or load a plant of the catalogue or of a file.

    Parameters
    ----------
    subject : str or Path
    seed : int, optional
        In the place of that of the study file.

    Raises
    ------
    InputError
        It is neither, or the file is wrong.

    Examples
    --------
    >>> read_subject("quadruple-tank").file_stem
    'quadruple-tank'
    """
    if not is_study_file(str(subject)):
        return load(subject)
    from clepsydra.studies.file.reader import read_study

    return read_study(subject, seed=seed)


def plant_of(subject: Subject) -> Plant:
    """Return the plant that it is about.

    Raises
    ------
    InputError
        It is none, or there is no such process or file.

    Examples
    --------
    >>> plant_of("three-tanks").name
    'three-tanks'
    """
    if isinstance(subject, (str, Path)):
        subject = read_subject(subject)
    require_type(
        subject, (Plant, StudyRequest), "plant", "a plant, or the name or path of a process",
        'give one, as from cl.load("quadruple-tank")',
    )  # fmt: skip
    return subject if isinstance(subject, Plant) else Plant(subject.process)
