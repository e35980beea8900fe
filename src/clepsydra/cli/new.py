"""``clepsydra new``: a commented process, study or lesson file to begin with."""

from __future__ import annotations

import typer

from clepsydra.base.errors import Finding
from clepsydra.cli.verb import verb


@verb(60)
def new(
    name: str | None = typer.Argument(
        None, metavar="NAME", help="Of process, study or lesson; the file is NAME.toml."
    ),
    copied: str | None = typer.Option(
        None,
        "--from",
        metavar="PROCESS[:VARIANT]",
        help="A process of the catalogue to copy instead; a variant is written into the copy.",
    ),
    study: bool = typer.Option(False, "--study", help="Write a study file and not a process file."),
    lesson: bool = typer.Option(
        False, "--lesson", help="Write a lesson file, a laboratory with tasks."
    ),
    process: str | None = typer.Option(
        None,
        "--process",
        metavar="PROCESS",
        help="What is studied: a process of the catalogue or a process file; quadruple-tank if "
        "left out. Only with --study.",
    ),
    schema: bool = typer.Option(
        False,
        "--schema",
        help="Print the JSON Schema of such files, for editors, and write no file.",
    ),
) -> None:
    """Write a commented process file, or with --study a study file, --lesson a lesson: NAME.toml.

    A study file names controllers, scenario and ranking for a --process.

    The file is written in the current folder, over none that is there.
    """
    kind = "lesson" if lesson else "study" if study else "process"
    if schema:
        from clepsydra.cli.output import print_json
        from clepsydra.interface import catalogue

        made = {
            "lesson": catalogue.schema_of_lessons,
            "study": catalogue.schema_of_studies,
            "process": catalogue.schema_of_processes,
        }
        print_json(made[kind]())
        return
    from clepsydra.base.errors import InputError
    from clepsydra.cli.output import named_options
    from clepsydra.interface.new import STUDIED, new_lesson, new_process, new_study

    if name is None:
        raise InputError("NAME", Finding("no name"), "the name of the file to write", "add one")
    if lesson and study:
        raise InputError("--study", Finding("--lesson beside it"), "one of both", "leave one out")
    if kind != "process" and copied is not None:
        remedy = "write --process instead" if study else "name its process in the file"
        raise InputError("--from", copied[:60], f"no copy beside --{kind}", remedy)
    if process is not None and not study:
        raise InputError(
            "--process", process[:60], "--study beside it", "add --study, or write --from to copy"
        )
    with named_options("process", name="NAME", copy_of="--from"):
        if lesson:
            path = new_lesson(name)
        elif study:
            path = new_study(name, process or STUDIED)
        else:
            path = new_process(name, copy_of=copied)
    further = {
        "lesson": "Open it with: clepsydra lab --lesson",
        "study": "Run it with: clepsydra study",
        "process": "Study it with: clepsydra study",
    }
    typer.echo(f"{kind.capitalize()} file: {path}\n{further[kind]} {path}")
