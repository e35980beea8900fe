"""``clepsydra new``: a commented process or study file to begin with."""

from __future__ import annotations

import typer

from clepsydra.base.errors import Finding
from clepsydra.cli.verb import verb


@verb(60)
def new(
    name: str | None = typer.Argument(
        None, metavar="NAME", help="Of process or study; the file is NAME.toml."
    ),
    copied: str | None = typer.Option(
        None,
        "--from",
        metavar="PROCESS[:VARIANT]",
        help="A process of the catalogue to copy instead; a variant is written into the copy.",
    ),
    study: bool = typer.Option(False, "--study", help="Write a study file and not a process file."),
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
    """Write a commented process file, or with --study a study file, to begin with: NAME.toml.

    A study file names controllers, scenario and ranking for a --process.

    The file is written in the current folder, over none that is there.
    """
    if schema:
        from clepsydra.cli.output import print_json
        from clepsydra.interface.catalogue import schema_of_processes, schema_of_studies

        print_json(schema_of_studies() if study else schema_of_processes())
        return
    from clepsydra.base.errors import InputError
    from clepsydra.cli.output import named_options
    from clepsydra.interface.new import STUDIED, new_process, new_study

    if name is None:
        raise InputError("NAME", Finding("no name"), "the name of the file to write", "add one")
    if study and copied is not None:
        raise InputError("--from", copied[:60], "no copy beside --study", "write --process instead")
    if process is not None and not study:
        raise InputError(
            "--process", process[:60], "--study beside it", "add --study, or write --from to copy"
        )
    with named_options("process", name="NAME", copy_of="--from"):
        path = new_study(name, process or STUDIED) if study else new_process(name, copy_of=copied)
    kind = "Study" if study else "Process"
    typer.echo(
        f"{kind} file: {path}\n{'Run' if study else 'Study'} it with: clepsydra study {path}"
    )
