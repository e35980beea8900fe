"""``clepsydra designs``: the design methods, and which of them apply to a process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from clepsydra.cli.options import JsonOption
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from clepsydra.interface.plant import Plant


@verb(55)
def designs(
    process: Annotated[
        str | None,
        typer.Argument(
            metavar="[PROCESS]",
            help="Say which apply to it, and why others do not: a process of the catalogue, or the "
            "path of a process file.",
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """List the design methods with their arguments and sources, and which apply to a process."""
    from textwrap import fill as wrapped

    from clepsydra.cli.output import print_json
    from clepsydra.interface import design
    from clepsydra.interface.plant import load

    plant = None if process is None else load(process)
    methods = {name: getattr(design, name) for name in dir(design) if name not in _OF_FILES}
    found = [_entry(name.rstrip("_"), method, plant) for name, method in methods.items()]
    if as_json:
        print_json({"designs": found})
        return
    for entry in found:
        typer.echo(entry["name"])
        for line in _lines(entry, process):
            typer.echo(wrapped(line, 96, initial_indent="    ", subsequent_indent="        "))
        typer.echo()
    typer.echo(
        "Name one in a study file, whose keys docs/study-files.md lists, or call it in Python: "
        "cl.design.simc(plant)"
    )


def _lines(entry: dict[str, Any], process: str | None) -> Iterator[str]:
    yield entry["words"]
    for what in ("arguments", "needs"):
        if entry[what]:
            yield f"{what}: {', '.join(entry[what])}"
    if entry["source"]:
        yield f"source: {entry['source']}"
    if process is not None:
        unknown = f"depends on its {' and '.join(entry['needs'])}"
        said = {True: "applies", False: f"does not apply: {entry['reason']}", None: unknown}
        yield f"{process}: {said[entry['applies']]}"


#: What is made of a file and is no method.
_OF_FILES = ("own", "fuzzy")


def _entry(name: str, method: Callable[..., Any], plant: Plant | None) -> dict[str, Any]:
    import inspect

    _, *parameters = inspect.signature(method).parameters.values()
    needs = [each.name for each in parameters if each.default is each.empty]
    words = (inspect.getdoc(inspect.unwrap(method)) or "").split("\n\n", maxsplit=1)[0]
    applies, reason = (None, None) if needs or plant is None else _tried(method, plant)
    return {
        "name": name,
        "words": " ".join(words.split()),
        "arguments": [each.name for each in parameters if each.default is not each.empty],
        "needs": needs,
        "source": _source(inspect.unwrap(method)),
        "applies": applies,
        "reason": reason,
    }


def _tried(method: Callable[..., Any], plant: Plant) -> tuple[bool, str | None]:
    """Return whether a design makes a controller for a plant, and why not."""
    from clepsydra.base.errors import ClepsydraError

    # A plant that never rests is refused as a whole, and not by every design.
    assert plant.linear is not None
    try:
        method(plant)
    except ClepsydraError as error:
        return False, str(error)
    return True, None


def _source(function: Callable[..., Any]) -> str | None:
    """Return the references of a design, or of the settings that its own refer to."""
    import inspect
    import re

    text = inspect.getdoc(function) or ""
    _, found, rest = text.partition("References\n----------\n")
    said = " ".join(rest.split("\n\n", maxsplit=1)[0].split())
    other = re.match(r"As for `(\w+)`", said)
    if other:
        return _source(function.__globals__[other[1]])
    return said if found else None
