"""``clepsydra new``: a commented process or study file to begin with."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path
from typing import Annotated

import typer

#: The process of a study for which none is named.
_PROCESS = "quadruple-tank"


def new(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Of process or study; the file is NAME.toml.")
    ],
    copied: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="PROCESS[:VARIANT]",
            help="A process of the catalogue to copy instead; a variant is written into the copy.",
        ),
    ] = None,
    study: Annotated[
        bool, typer.Option("--study", help="Write a study file and not a process file.")
    ] = False,
    process: Annotated[
        str | None,
        typer.Option(
            "--process",
            metavar="PROCESS",
            help=f"What is studied: a process of the catalogue or a process file; {_PROCESS} if "
            "left out. Only with --study.",
        ),
    ] = None,
) -> None:
    """Write a commented process file, or with --study a study file, to begin with: NAME.toml.

    A study file names the controllers, the scenario and the ranking for a process; --process says
    which. The file is written in the current folder, over none that is there.
    """
    from clepsydra.base.errors import InputError
    from clepsydra.process.process_name import check_process_name

    if study:
        name = name.removesuffix(".toml")
    check_process_name(name, "NAME")
    if study and copied is not None:
        raise InputError("--from", copied[:60], "no copy beside --study", "write --process instead")
    if process is not None and not study:
        raise InputError(
            "--process", process[:60], "--study beside it", "add --study, or write --from to copy"
        )
    path = Path(f"{name}.toml")
    if study:
        _check_free(path, name)  # before the process is analysed
        text = _study(process or _PROCESS)
    else:
        text = _renamed(_template("new_process") if copied is None else _catalogue(copied), name)
    _write(path, name, text)
    kind = "Study" if study else "Process"
    typer.echo(
        f"{kind} file: {path}\n{'Run' if study else 'Study'} it with: clepsydra study {path}"
    )


def _check_free(path: Path, name: str) -> None:
    from clepsydra.base.errors import InputError

    if path.exists():
        raise InputError(
            "NAME", name, f"a name for which there is no {path} yet", "choose another name"
        )


def _write(path: Path, name: str, text: str) -> None:
    from clepsydra.base.errors import InputError

    try:
        # Opened only if it does not exist, so that nothing is ever written over.
        with path.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        _check_free(path, name)
        raise
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            "NAME", str(path), "a file that can be written", f"change the folder ({reason})"
        ) from None


def _template(name: str) -> str:
    return (resources.files("clepsydra.cli") / f"{name}.toml").read_text(encoding="utf-8")


def _study(named: str) -> str:
    from clepsydra.process.reader import load_process
    from clepsydra.studies.file.new_study import new_study

    return new_study(load_process(named), named, _template("new_study"))


def _catalogue(named: str) -> str:
    from clepsydra.base.errors import InputError
    from clepsydra.base.suggestion import suggestion
    from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
    from clepsydra.process.flat_variant import flat_text
    from clepsydra.process.variants import split_variants

    name, variants = split_variants(named)
    names = catalogue_names()
    if name not in names:
        raise InputError(
            "--from",
            name[:60],
            f"a process of the catalogue ({', '.join(names)})",
            suggestion(name, names, "choose one of them"),
        )
    text = catalogue_file(name).read_text(encoding="utf-8")
    return text if variants is None else flat_text(text, name, variants)


def _renamed(text: str, name: str) -> str:
    """Return a process file with another name; its comments and its order stay."""
    return re.sub(r'^name = ".*"$', f'name = "{name}"', text, count=1, flags=re.MULTILINE)
