"""Whether a file is a study or a process, before what reads studies is imported."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.input_file import read_input
from clepsydra.process.document import kind_of, parse
from clepsydra.process.drawn import split_number


def is_study_file(text: str) -> bool:
    """Return whether a text that a user gave names a study file, rather than a process.

    A file that cannot be read or parsed is none: whoever reads it as a process says what is wrong.
    """
    try:
        name, _ = split_number(text)
        return name.lower().endswith(".toml") and (
            kind_of(parse(study_text(Path(name)), name, "study")) == "study"
        )
    except InputError:
        return False


def study_text(path: Path) -> bytes:
    """Return what a study file holds.

    Raises
    ------
    InputError
        It cannot be read.
    """
    return read_input(path, "a study file", inside="the .toml file")
