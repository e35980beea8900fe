"""``clepsydra lab``: a process moved by hand, in a page that opens without a network."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clepsydra.base.errors import Finding, InputError
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.controller import AnyController
    from clepsydra.interface.plant import Plant
    from clepsydra.interface.subject import StudyRequest


@verb(45)
def lab(
    subject: str | None = typer.Argument(
        None,
        metavar="[PROCESS|STUDY.toml]",
        help="A process of the catalogue, a process file, or a study file; a lesson has its own.",
    ),
    controller: list[str] | None = typer.Option(
        None,
        metavar="NAME|FILE.mat",
        help="Whose loops it has, as the study calls it, in quotation marks; again for another. "
        "If left out, the recommended controller of the study and its first two. Of a file with "
        "matrices A, B, C and D the page asks for units and sign.",
    ),
    every: bool = typer.Option(
        False, "--all", help="Every design that applies as a controller, without tuning."
    ),
    variant: int = typer.Option(
        0,
        metavar="N",
        help="Draw every hole, split and gain within 10 % from this number; 0 as in the file.",
    ),
    lesson: str | None = typer.Option(
        None, metavar="NAME|FILE.toml", help="A lesson: tasks at a rig, and a report that prints."
    ),
    answers: bool = typer.Option(
        False, "--answers", help="The lecturer's page of a lesson, with answers and solutions."
    ),
    file: Path | None = typer.Option(
        None, "--output", "-o", metavar="FILE.html", help="NAME-lab.html if left out."
    ),
    show: bool = typer.Option(True, "--open/--no-open", help="Open it in the browser."),
) -> None:
    """Write a page in which a process lives, moved by hand and by its controllers."""
    import webbrowser

    from clepsydra.cli.output import check_ending, output_file
    from clepsydra.cli.subject import is_regulator
    from clepsydra.interface.lab import lab as page_of
    from clepsydra.interface.lesson import lesson as page_of_lesson
    from clepsydra.interface.lesson import page_path
    from clepsydra.interface.subject import numbered, plant_of, read_subject

    if file is not None:
        check_ending(file, ".html")
    if lesson is not None:
        _check_alone(subject, controller or (), every)
        address = numbered(lesson, variant)
        target = output_file(file or page_path(address, answers=answers))
        page_of_lesson(address, target, answers=answers)
    else:
        if subject is None or answers:
            what = "--answers" if answers else "PROCESS"
            given = Finding("no lesson" if answers else "no process")
            raise InputError(what, given, "a lesson", "name one, as in --lesson wind-up")
        request = read_subject(numbered(subject, variant))
        plant = plant_of(request)
        target = output_file(file or Path(f"{plant.file_stem}-lab.html"))
        names = [each for each in controller or [] if not is_regulator(each)]
        files = [each for each in controller or [] if is_regulator(each)]
        page_of(
            plant,
            _chosen(request, names, target.parent, every=every),
            target,
            regulators=files,
        )
    typer.echo(f"Laboratory: {target}")
    if show:
        webbrowser.open(target.resolve().as_uri())


def made_of(
    request: Plant | StudyRequest, names: list[str], folder: Path | None
) -> list[AnyController]:
    """Return the controllers of these names, or those that a study puts first."""
    from clepsydra.cli.subject import controller_of, name_of, study_of

    if not names:
        found = study_of(request, None, None, folder, quiet=False)
        first = [found.recommended, *found.ranking[:2]]
        return list({each.controller.name: each for each in first}.values())
    known = [str(name_of(each)) for each in names]
    return [controller_of(request, each, folder, quiet=False) for each in known]


def _chosen(
    request: Plant | StudyRequest, names: list[str], folder: Path, *, every: bool
) -> list[AnyController]:
    """Return the controllers that are asked for; with `every`, tell those that a page has not."""
    from clepsydra.interface.every_design import every_design

    if not every:
        return made_of(request, names, folder)
    if names:
        remedy = "give one of the two"
        raise InputError("--all", "--controller beside it", "all designs, or some", remedy)
    found, left_out = every_design(request)
    for name, reason in left_out:
        typer.echo(f"Without {name}: {reason}.")
    return [*found]


def _check_alone(subject: str | None, controllers: object, every: bool) -> None:
    """Refuse what a lesson brings itself."""
    given = {"PROCESS": subject, "--controller": controllers, "--all": every}
    for name, value in given.items():
        if value:
            remedy = "leave it out; the lesson has its process and its controllers"
            raise InputError(name, Finding("a lesson beside it"), "one of the two", remedy)
