"""``clepsydra new``: a commented process file to begin with."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path
from typing import Annotated

import typer


def new(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Of the process; the file is NAME.toml.")
    ],
    copied: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="PROCESS", help="A process of the catalogue to copy instead."
        ),
    ] = None,
) -> None:
    """Write a commented process file to begin with, NAME.toml, in the current folder."""
    from clepsydra.base.errors import InputError
    from clepsydra.process.process_name import check_process_name

    check_process_name(name, "NAME")
    text = _renamed(_template() if copied is None else _of_the_catalogue(copied), name)
    path = Path(f"{name}.toml")
    try:
        # Opened only if it does not exist, so that nothing is ever written over.
        with path.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(
            "NAME", name, f"a name for which there is no {path} yet", "choose another name"
        ) from None
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            "NAME", str(path), "a file that can be written", f"change the folder ({reason})"
        ) from None
    typer.echo(f"Process file: {path}\nStudy it with: clepsydra study {path}")


def _template() -> str:
    return (resources.files("clepsydra.cli") / "new_process.toml").read_text(encoding="utf-8")


def _of_the_catalogue(name: str) -> str:
    from clepsydra.base.errors import InputError
    from clepsydra.base.suggestion import suggestion
    from clepsydra.process.catalogue_names import catalogue_file, catalogue_names

    names = catalogue_names()
    if name not in names:
        raise InputError(
            "--from",
            name[:60],
            f"a process of the catalogue ({', '.join(names)})",
            suggestion(name, names, "choose one of them"),
        )
    return catalogue_file(name).read_text(encoding="utf-8")


def _renamed(text: str, name: str) -> str:
    """Return a process file with another name; its comments and its order stay."""
    return re.sub(r'^name = ".*"$', f'name = "{name}"', text, count=1, flags=re.MULTILINE)
