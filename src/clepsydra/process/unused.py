"""What of a process file nothing in the plant uses: it is said and left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from clepsydra.base.remark import Remark
from clepsydra.process.component import Component
from clepsydra.process.document import Document, line_of
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor


class Used(NamedTuple):
    """Elements and components that something uses, and a sentence for each other one."""

    elements: tuple[Element, ...]
    components: tuple[Component, ...]
    warnings: tuple[Remark, ...]


def without_unused(
    document: Document, elements: Sequence[Element], components: Sequence[Component]
) -> Used:
    """Leave out reservoirs that no flow touches, and components that nothing brings or measures.

    A reservoir keeps no balance and a component that enters nowhere is nowhere, so that the plant
    is the same without them. A tank without any flow is not left out: it has a level.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.elements.reservoir import Reservoir
    >>> document = parse(b"[reservoirs.lake]", "plant.toml")
    >>> for warning in without_unused(document, [Reservoir("lake")], []).warnings:
    ...     print(warning)
    reservoirs.lake (line 1) of plant.toml has no effect: no flow enters or leaves it; connect it, \
or remove it.
    """
    touched = {connection.name for element in elements for connection in element.connections()}
    idle = {each.name for each in elements if each.name not in touched and _is_an_end(each)}
    kept = [each for each in elements if each.name not in idle]
    warnings = [
        _without_effect(
            document,
            (element.table, element.name),
            "no flow enters or leaves it",
            "connect it, or remove it",
        )
        for element in elements
        if element.name in idle
    ]
    brought = {name for element in kept for name in element.brings()}
    # A sensor of what is nowhere is a mistake, which is told where components are checked.
    measured = {element.measured for element in kept if isinstance(element, Sensor)}
    used = tuple(each for each in components if each.name in brought | measured)
    warnings += [
        _without_effect(
            document,
            ("components", each.name),
            "no flow or reservoir brings it",
            f"add concentration = {{ {each.name} = … }} to a flow from outside or a reservoir, or "
            "remove it",
        )
        for each in components
        if each not in used
    ]
    if len(used) < len(components):
        kept = [replace(element, components=used) for element in kept]
    return Used(tuple(kept), used, tuple(warnings))


def _is_an_end(element: Element) -> bool:
    """Return whether flows begin and end there, of which it keeps nothing and passes nothing on."""
    return element.receives and not element.passes_on and not element.states()


def _without_effect(document: Document, path: tuple[str, ...], means: str, remedy: str) -> Remark:
    path = document.origins.get(path, path)
    line = line_of(document.lines, path)
    seen = f"{'.'.join(path)} (line {line}) of {document.file} has no effect"
    return Remark(seen, means, remedy)
