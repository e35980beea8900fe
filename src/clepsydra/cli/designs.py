"""``clepsydra designs``: the design methods, and which of them apply to a process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from clepsydra.cli.options import JsonOption, all_option
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from collections.abc import Callable

    from clepsydra.base.section import Section
    from clepsydra.interface.plant import Plant

#: Of the designs, so that they and the lines around them fit a screen.
_SHOWN = 21


@verb(55)
def designs(
    process: str | None = typer.Argument(
        None,
        metavar="[PROCESS]",
        help="Say which apply to it, and why others do not: a process of the catalogue, or the "
        "path of a process file.",
    ),
    every: bool = all_option("Show arguments and source of each, and whole reasons."),
    as_json: JsonOption = False,
) -> None:
    """List the design methods with their arguments and sources, and which apply to a process."""
    from clepsydra.cli.output import print_json, show
    from clepsydra.interface import design
    from clepsydra.interface.plant import load
    from clepsydra.interface.shown import screen

    plant = None if process is None else load(process)
    methods = {name: getattr(design, name) for name in dir(design) if name not in _OF_FILES}
    found = [_entry(name.rstrip("_"), method, plant) for name, method in methods.items()]
    if as_json:
        print_json({"designs": found})
        return
    show(screen(_whole(found, process) if every else _glance(found, process)))


def _glance(found: list[dict[str, Any]], process: str | None) -> Section:
    """Return the names of designs with what they are, or with which apply to a process."""
    from clepsydra.base.section import Line, Mark, Section, Table, marked
    from clepsydra.interface.design_words import design_words

    if process is None:
        table = Table("", ("design", "what it makes"), design_words()[:_SHOWN], names=2)
        more = Line(f"{len(found) - _SHOWN} more, and arguments and sources: --all")
        return Section("", (table, more, Line("Next: clepsydra designs PROCESS says which apply.")))
    names = [each["name"] for each in found if each["applies"]]
    own = [f"{each['name']} ({', '.join(each['needs'])})" for each in found if each["needs"]]
    refused = (each["reason"].partition(";")[0] for each in found if each["applies"] is False)
    parts = (
        Line(f"{len(names)} of {len(found)} designs apply to {process}:", Mark.ANSWER),
        Line(", ".join(names)),
        Line(""),
        Line(f"Those that need numbers of yours: {', '.join(own)}"),
        *marked(Mark.REFUSED, refused),
        Line(""),
        Line("Next: name one in a study file: clepsydra new --study; --all has the sources."),
    )
    return Section("", parts)


def _whole(found: list[dict[str, Any]], process: str | None) -> Section:
    """Return each design with its arguments and source, and whether it applies to a process."""
    from clepsydra.base.section import Line, Section

    parts = []
    for each in found:
        lines = [each["words"]]
        lines += [
            f"{what}: {', '.join(each[what])}" for what in ("arguments", "needs") if each[what]
        ]
        lines += [f"source: {each['source']}"] if each["source"] else []
        if process is not None:
            unknown = f"depends on its {' and '.join(each['needs'])}"
            said = {True: "applies", False: f"does not apply: {each['reason']}", None: unknown}
            lines.append(f"{process}: {said[each['applies']]}")
        parts.append(Section(each["name"], (*map(Line, lines), Line(""))))
    following = (
        "Name one in a study file, as clepsydra new --study writes it, or call it in Python: "
    )
    return Section("", (*parts, Line(f"{following}cl.design.simc(plant)")))


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
