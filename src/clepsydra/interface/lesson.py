"""`cl.lesson`: a laboratory whose reader is asked to do something, as a page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.arguments import require_type
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.lab import Laboratory

if TYPE_CHECKING:
    from clepsydra.laboratory.rig import Rig

#: What pages are called behind their lesson, by whether they have answers.
_WHAT = {False: "lab", True: "answers"}


@keywords_checked()
def lesson(
    lesson: str | Path, path: str | Path | None = None, *, answers: bool = False
) -> Laboratory:
    """Write the page of a lesson: a laboratory with tasks, and a report that prints.

    Parameters
    ----------
    lesson : str or Path
        One of Clepsydra's, "wind-up", or the path of a lesson file. A number behind a sign,
        "wind-up#7", draws holes, splits and gains of its rig within 10 %.
    path : str or Path, optional
        NAME-lab.html if left out, NAME-answers.html with answers.
    answers : bool
        Whether it is the lecturer's page, with right numbers, hints and solutions.

    Returns
    -------
    Laboratory
        Its `path`; as the result of a cell it is the page itself.

    Raises
    ------
    InputError
        There is no such lesson, its file is wrong, or the script of the page was not built with
        this installation.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.report.page import lab_assets
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     if lab_assets():
    ...         page = lesson("wind-up#7", f"{folder}/wind-up.html")
    """
    from clepsydra.laboratory.lessons.lesson import read_lesson
    from clepsydra.laboratory.page import lab_text
    from clepsydra.report.page import write_page

    require_type(lesson, (str, Path), "lesson", "the name or path of a lesson", "give it as text")
    found = read_lesson(lesson)
    target = page_path(found.address, answers=answers) if path is None else Path(path)
    write_page(lab_text(found.rig(), found, answers=answers), target)
    return Laboratory(target, found.title)


def page_path(address: str, *, answers: bool) -> Path:
    """Return what the page of a lesson is called if nobody says.

    Examples
    --------
    >>> page_path("lessons/wind-up.toml#7", answers=True)
    PosixPath('wind-up-7-answers.html')
    """
    from clepsydra.laboratory.lessons.lesson import stem_of

    return Path(f"{stem_of(address)}-{_WHAT[answers]}.html")


def is_lesson(text: str | Path) -> bool:
    """Return whether a text names a lesson: one of Clepsydra's, or a lesson file."""
    from clepsydra.laboratory.lessons.lesson import names_lesson

    return names_lesson(str(text))


def rig_of_lesson(lesson: str | Path, page: str | Path | None = None) -> Rig:
    """Return the rig of a lesson, as its page and sessions of it have it.

    Parameters
    ----------
    page : str or Path, optional
        A page of it, of which its numbers are.
    """
    from clepsydra.laboratory.lessons.lesson import read_lesson
    from clepsydra.laboratory.page_file import numbers_of_page

    return read_lesson(lesson).rig({} if page is None else numbers_of_page(page))
