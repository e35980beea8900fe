"""`cl.replay`: a session of a laboratory run again, with the same bits."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController
from clepsydra.interface.lab import rig_of
from clepsydra.interface.lesson import is_lesson, rig_of_lesson
from clepsydra.interface.shown import Answered, lifted
from clepsydra.interface.subject import Subject
from clepsydra.laboratory import replay as inner
from clepsydra.laboratory.session import read_session as read_session

if TYPE_CHECKING:
    from clepsydra.base.section import Section


class Replayed(Answered, inner.Replayed):
    """What a session of a laboratory did: `values`, `levels` and `scores`."""

    def answer(self) -> Section:
        """Return where it ended, and its scores."""
        from clepsydra.laboratory.answer import session_answer

        return session_answer(self)


@keywords_checked()
def replay(
    session: str | Path,
    plant: Subject | None = None,
    controllers: AnyController | Sequence[AnyController] | None = None,
    page: str | Path | None = None,
) -> Replayed:
    """Run a session again that was saved in a laboratory.

    Parameters
    ----------
    session : str or Path
        The file.
    plant : Plant, str or Path, optional
        What the page was written for; the lesson or the process that the session names if left
        out. The name or path of a lesson brings its controllers.
    controllers : Controller, or sequence of Controller, optional
        Those with which the page was written, unless they are those of a lesson.
    page : str or Path, optional
        The page itself: its numbers count then. A controller that was tuned may differ in its last
        digits where it is tuned again on another machine, and its session would be refused.

    Returns
    -------
    Replayed
        What it recorded by name [SI], where it ended, and its scores.

    Raises
    ------
    InputError
        The file is no session, of another version, process or controllers, or damaged; the
        message says where.
    """
    found = read_session(session)
    wanted = found.process if plant is None else plant
    if isinstance(wanted, (str, Path)) and is_lesson(wanted):
        rig = rig_of_lesson(wanted, page)
    elif controllers is None:
        raise InputError(
            "replay, controllers", None, f"{', '.join(found.controllers)}, as the session has them",
            "give the controllers with which the page was written",
        )  # fmt: skip
    else:
        rig = rig_of(wanted, controllers, page)
    return lifted(Replayed, inner.replayed(rig, found, str(session)))
