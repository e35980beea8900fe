"""What goes to the terminal: one JSON document, or something for a person."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.files import make_folder, require_writable, whole_file
from clepsydra.base.standing import Standing, standing_at


def results_folder(folder: Path | None, *, as_json: bool = False) -> Path | None:
    """Return where files go: here if no folder is given, with JSON then nowhere.

    The folder is made where it is missing, and tried, before any work is done.
    """
    if folder is None and as_json:
        return None
    place = folder or Path()
    make_folder(place, "--output")
    require_writable(place, "--output")
    return place


def written_files(place: Path | None, stem: str, **endings: str) -> dict[str, Path]:
    """Return what is written to its path, `place/stem.ending`; nothing where there is no place."""
    if place is None:
        return {}
    return {what: output_file(place / f"{stem}.{ending}") for what, ending in endings.items()}


def output_file(path: Path) -> Path:
    """Return the path of a file to be written, its folder made; refuse that of a folder."""
    make_folder(path.parent, "--output")
    expected = "the name of a file"
    if standing_at(path, "--output", expected, "choose another") is Standing.FOLDER:
        raise InputError("--output", str(path), expected, "move that folder away")
    return path


def check_ending(path: Path, *endings: str) -> None:
    """Refuse the path of a file to be written that ends otherwise, or that of a folder."""
    expected, remedy = f"the name of a file that ends in {endings[0]}", "rename it"
    standing = standing_at(path, "--output", expected, "choose another")
    if path.suffix.lower() not in endings or standing is Standing.FOLDER:
        raise InputError("--output", str(path), expected, remedy)


@contextmanager
def named_options(*arguments: str, **others: str) -> Iterator[None]:
    """Give an error of an argument of the interface the name of its option, in its words too.

    Parameters
    ----------
    *arguments : str
        Whose option is called like the argument.
    **others : str
        Argument to its option, where it is called otherwise.
    """
    options = {each: f"--{each.replace('_', '-')}" for each in arguments} | others
    try:
        yield
    except InputError as error:
        place = error.place
        for argument in sorted(options, key=len):  # the longest that fits counts
            if f"{error.place}, ".startswith(f"{argument}, "):
                rest = error.place[len(argument) :].removeprefix(", ")
                place = f"{options[argument]} {rest}".rstrip()
        words = [error.expected, error.remedy]
        for argument, option in options.items():
            words = [re.sub(rf'\b{argument}="([^" ]*)",?', rf"{option} \1", each) for each in words]
            words = [
                re.sub(rf'\b{argument}="([^"]*)",?', rf"{option} '\1'", each) for each in words
            ]
        raise InputError(place, error.value, *words) from None


def show(result: object) -> None:
    """Print a result as it shows itself, as wide as the terminal; in 100 columns to a file."""
    from rich.console import Console

    console = Console()
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console = Console(width=100)
    console.print(getattr(result, "on_command_line", result), crop=False)  # a path stays whole


def tell(result: Any, files: dict[str, Path], *, as_json: bool, **how: bool) -> None:
    """Print a result with the files that were written: one JSON document, or for a person."""
    if as_json:
        print_json({**result.as_dict(), **files})
        return
    show(result.shown(**how))
    for what, where in files.items():
        print(f"{what.capitalize()}: {where}")


def print_json(document: dict[str, Any] | list[Any]) -> None:
    """Print one JSON document; numbers that JSON has no form for become null."""
    print(_json_text(document))


def write_json(document: dict[str, Any], path: Path) -> None:
    """Write the same to a file; an existing one is replaced only by a whole one."""
    with whole_file(path) as part:
        part.write_text(f"{_json_text(document)}\n", encoding="utf-8", newline="\n")


def _json_text(document: dict[str, Any] | list[Any]) -> str:
    from clepsydra.base.json_values import json_values

    return json.dumps(json_values(document), indent=2, allow_nan=False)
