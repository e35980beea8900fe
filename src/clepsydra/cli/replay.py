"""``clepsydra replay``: a session of a laboratory run again, with the same bits."""

from __future__ import annotations

from pathlib import Path

import typer

from clepsydra.cli.options import JsonOption
from clepsydra.cli.verb import verb


@verb(47)
def replay(
    session: Path = typer.Argument(
        ..., metavar="SESSION.json", help="What a laboratory saved, see clepsydra lab."
    ),
    rig: str | None = typer.Argument(
        None,
        metavar="[PROCESS|STUDY.toml|LESSON.toml]",
        help="What the page was written for; what the session names if left out.",
    ),
    page: Path | None = typer.Option(
        None,
        "--page",
        metavar="FILE.html",
        help="The page in which it was saved: its numbers count then, where a controller was "
        "tuned on another machine.",
    ),
    as_json: JsonOption = False,
) -> None:
    """Run a session of a laboratory again; print where it ends, and its scores."""
    from clepsydra.cli.lab import made_of
    from clepsydra.cli.output import tell
    from clepsydra.interface.lesson import is_lesson
    from clepsydra.interface.replay import read_session
    from clepsydra.interface.replay import replay as replayed
    from clepsydra.interface.subject import plant_of, read_subject

    found = read_session(session)
    wanted = found.process if rig is None else rig
    if is_lesson(wanted):
        tell(replayed(session, wanted), {}, as_json=as_json)
        return
    request = read_subject(wanted)
    made = made_of(request, list(found.controllers), None)
    tell(replayed(session, plant_of(request), made, page), {}, as_json=as_json)
