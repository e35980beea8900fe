"""Set-ups: other numbers of the same rig, between which one changes while it runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.drawn import drawn
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process


@dataclass(frozen=True)
class Setup:
    """Numbers with which a rig is another one of the same build.

    Attributes
    ----------
    name : str
        What a user types to load a process with them.
    title : str
    words : str
        What it is, where the title does not say it.
    parameters : dict
        Parameter to its value, of those that differ in any of the set-ups [SI].
    """

    name: str
    title: str
    words: str
    parameters: dict[str, float]


def setups(process: Process) -> list[Setup]:
    """Return the set-ups of a process: its own, its variants, and those of the catalogue.

    Only what differs from it in parameters alone is one: the same signals in the same units, and
    elements joined in the same way.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> found = setups(load_process("quadruple-tank"))
    >>> [each.title for each in found][-1]
    'Quadruple tank, non-minimum phase'
    """
    # They are as much larger or smaller as the process itself, where that was drawn.
    others = {
        each.address: drawn(each, process.drawn)
        for each in _others(process)
        if is_alike(process, each)
    }
    every = [process, *others.values()]
    return setups_of([(each.address, *_told(each, process), each) for each in every])


def setups_of(every: Sequence[tuple[str, str, str, Process]]) -> list[Setup]:
    """Return set-ups of names, titles, words and processes that are alike, each numbers once."""
    values = [{p.name: p.initial for p in process.parameters} for *_, process in every]
    moved = [name for name in values[0] if any(each[name] != values[0][name] for each in values)]
    found: list[Setup] = []
    for (name, title, words, _), own in zip(every, values, strict=True):
        parameters = {each: own[each] for each in moved}
        if all(parameters != known.parameters for known in found):
            found.append(Setup(name, title, words, parameters))
    return found


def _others(process: Process) -> Iterator[Process]:
    where = process.path or process.name
    for variant in process.variants:
        if variant not in process.variant:
            # A variant that cannot stand beside those in force is another plant.
            with suppress(InputError):
                yield load_process(where, (*process.variant, variant))
    for name in catalogue_names():
        if name != process.name or process.path:
            other = load_process(name)
            kept = [each for each in process.variant if each in other.variants]
            yield load_process(name, kept) if kept else other


def is_alike(process: Process, other: Process) -> bool:
    """Return whether two processes differ in parameters alone."""
    # The alarms of a rig are those of its file, whatever its parameters are.
    if process.sampling_period != other.sampling_period or (
        other.alarms and other.alarms != process.alarms
    ):
        return False
    groups = ("state", "inputs", "disturbances", "measurements", "parameters")
    if any(_shown(getattr(process, each)) != _shown(getattr(other, each)) for each in groups):
        return False
    own, theirs = process.motion, other.motion
    functions = ("to_contents", "to_state", "rates", "guards", "resets", "updates")
    return all(
        getattr(own, name).serialize() == getattr(theirs, name).serialize() for name in functions
    ) and all(
        getattr(process, name).serialize() == getattr(other, name).serialize()
        for name in ("measure", "display")
    )


def _shown(signals: tuple[Signal, ...]) -> list[tuple[str, str, str]]:
    return [(each.name, each.unit, each.shown_unit) for each in signals]


def _told(each: Process, process: Process) -> tuple[str, str]:
    """Return the title of a set-up, and what it is where that is a variant of the process."""
    if each.name != process.name or each is process:
        return each.title, ""
    variant = next(name for name in each.variant if name not in process.variant)
    return f"{each.title} ({variant})", each.variants[variant]
