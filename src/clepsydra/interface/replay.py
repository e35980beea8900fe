"""`cl.replay`: a session of a laboratory run again, with the same bits."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController
from clepsydra.interface.lab import rig_of
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
    plant: Subject,
    controllers: AnyController | Sequence[AnyController],
) -> Replayed:
    """Run a session again that was saved in a laboratory.

    Parameters
    ----------
    session : str or Path
        The file.
    plant : Plant, str or Path
    controllers : Controller, or sequence of Controller
        Those with which the page was written.

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
    rig = rig_of(plant, controllers)
    return lifted(Replayed, inner.replayed(rig, read_session(session), str(session)))
