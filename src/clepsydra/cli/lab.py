"""``clepsydra lab``: a process moved by hand, in a page that opens without a network."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clepsydra.cli.options import SubjectArgument
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.plant import Plant
    from clepsydra.interface.study import Candidate
    from clepsydra.interface.subject import StudyRequest


@verb(45)
def lab(
    subject: SubjectArgument,
    controller: list[str] | None = typer.Option(
        None,
        metavar="NAME",
        help="Whose loops it has, as the study calls it, in quotation marks; again for another. "
        "If left out, the recommended controller of the study and its first two.",
    ),
    file: Path | None = typer.Option(
        None, "--output", "-o", metavar="FILE.html", help="NAME-lab.html if left out."
    ),
    show: bool = typer.Option(True, "--open/--no-open", help="Open it in the browser."),
) -> None:
    """Write a page in which a process lives, moved by hand and by its controllers."""
    import webbrowser

    from clepsydra.cli.output import check_ending, output_file
    from clepsydra.interface.lab import lab as page_of
    from clepsydra.interface.subject import plant_of, read_subject

    if file is not None:
        check_ending(file, ".html")
    request = read_subject(subject)
    plant = plant_of(request)
    target = output_file(Path(f"{plant.file_stem}-lab.html") if file is None else file)
    page_of(plant, made_of(request, controller or [], target.parent), target)
    typer.echo(f"Laboratory: {target}")
    if show:
        webbrowser.open(target.resolve().as_uri())


def made_of(
    request: Plant | StudyRequest, names: list[str], folder: Path | None
) -> list[Candidate]:
    """Return the controllers of these names, or those that a study puts first."""
    from clepsydra.cli.subject import name_of, study_of

    if not names:
        found = study_of(request, None, None, folder, quiet=False)
        first = [found.recommended, *found.ranking[:2]]
        return list({each.controller.name: each for each in first}.values())
    known = [str(name_of(each)) for each in names]
    return [study_of(request, each, None, folder, quiet=False)[each] for each in known]
