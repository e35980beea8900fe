"""What flows where: the elements of a process as a graph for the drawing."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from clepsydra.process.element import Element
from clepsydra.process.process import Process

#: The tag of an instrument: what it measures, what it does, its loop.
_TAG = re.compile(r"([A-Z])[A-Z]*_?(\d\w*)")
#: Symbols of elements through which liquid falls or presses by its own weight.
_BY_WEIGHT = ("orifice", "valve")


@dataclass(frozen=True)
class Link:
    """An element that makes liquid flow from one place to another, or passes on what it receives.

    Parameters
    ----------
    name, symbol : str
    sources, targets : tuple of str
        The elements that it names; none on a side that lies outside the plant. A junction, such as
        a splitter or a delay, names no sources.
    submerged : bool
        It joins tanks below their surfaces.
    by_weight : bool
        What leaves its tank falls, so that it stands below the tank.
    shares : tuple of float or None
        Of what a junction receives, for each target.
    """

    name: str
    symbol: str
    sources: tuple[str, ...]
    targets: tuple[str, ...]
    submerged: bool = False
    by_weight: bool = False
    shares: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class Instrument:
    """A sensor, the first letter of what it measures after ISA-5.1, and where it sits."""

    name: str
    letter: str
    seat: str
    number: str


@dataclass(frozen=True)
class FlowGraph:
    """The parts of a plant in the order of the file.

    Parameters
    ----------
    vessels : tuple of str
    links, junctions : tuple of Link
    instruments : tuple of Instrument
    loose : tuple of str
        Elements that nothing flows through.
    owners : dict
        Measurement or manipulated variable to the element that has it.

    Examples
    --------
    >>> upper = Link("a", "orifice", ("upper",), ("lower",), by_weight=True)
    >>> FlowGraph(("upper", "lower"), (upper,), (), ()).layers()
    {'upper': 1, 'lower': 0}
    """

    vessels: tuple[str, ...]
    links: tuple[Link, ...]
    junctions: tuple[Link, ...]
    instruments: tuple[Instrument, ...]
    loose: tuple[str, ...] = ()
    owners: Mapping[str, str] = field(default_factory=dict)

    def junction(self, name: str) -> Link | None:
        """Return the junction of a name, if there is one."""
        return next((entry for entry in self.junctions if entry.name == name), None)

    def owner(self, signal: str) -> str:
        """Return the element that a signal belongs to; what is no signal has its own name."""
        return self.owners.get(signal, signal)

    def feeding(self, junction: Link) -> list[Link]:
        """Return the links and junctions that lead into a junction, once for each pipe."""
        every = (*self.links, *self.junctions)
        return [link for link in every for name in link.targets if name == junction.name]

    def ends(self, link: Link) -> list[str]:
        """Return the tanks and reservoirs that a link feeds, junctions passed over."""
        found: list[str] = []
        for target in link.targets:
            junction = self.junction(target)
            found += self.ends(junction) if junction else [target]
        return found

    def pairs(self, links: Iterable[Link]) -> list[tuple[str, str]]:
        """Return each pair of a tank and one that some links lead to from there."""
        return [
            (source, end)
            for link in links
            for source in link.sources
            for end in self.ends(link)
            if source in self.vessels and end in self.vessels
        ]

    def falls(self) -> list[tuple[str, str]]:
        """Return each pair of an upper tank and one that it drains into."""
        return self.pairs(link for link in self.links if link.by_weight and not link.submerged)

    def neighbours(self) -> list[tuple[str, str]]:
        """Return the pairs of tanks that are joined below their surfaces."""
        return self.pairs(link for link in self.links if link.submerged)

    def layers(self) -> dict[str, int]:
        """Return how many tanks lie below each tank on its longest way down.

        Tanks that are joined below their surfaces stand at one height. A fall that would close
        a circle is left out.
        """
        from scipy.sparse.csgraph import NegativeCycleError, bellman_ford, csgraph_from_dense

        place = {tank: number for number, tank in enumerate(self.vessels)}
        steps = np.full((len(place), len(place)), np.inf)
        for one, other in self.neighbours():
            steps[place[one], place[other]] = steps[place[other], place[one]] = 0.0
        found = np.zeros_like(steps)
        for upper, lower in self.falls():
            at, before = (place[upper], place[lower]), steps[place[upper], place[lower]]
            steps[at] = -1.0
            try:
                found = bellman_ford(csgraph_from_dense(steps, null_value=np.inf))
            except NegativeCycleError:
                steps[at] = before
        return {tank: int(-found[number].min()) for tank, number in place.items()}


def flow_graph(process: Process) -> FlowGraph:
    """Read the flows of a process from what its elements say of themselves.

    Nothing is asked that a new kind of element would not answer: what it is connected to,
    whether it holds, passes on or measures, and by which `symbol` it wants to be drawn.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> flow_graph(load_process("quadruple-tank")).layers()
    {'tank_1': 0, 'tank_2': 0, 'tank_3': 1, 'tank_4': 1}
    """
    vessels: list[str] = []
    links: list[Link] = []
    junctions: list[Link] = []
    instruments: list[Instrument] = []
    loose: list[str] = []
    held = {e.name for e in process.elements if e.receives and not e.endless and not e.passes_on}
    for element in (each for each in process.elements if not each.endless):
        flowing = [c for c in element.connections() if c.carries_flow]
        if element.name in held:
            vessels.append(element.name)
        elif element.passes_on:
            junctions.append(_link(element, held))
        elif element.measurements():
            seat = next((c.name for c in element.connections()), "")
            number = str(101 + len(instruments))
            shown = process.measured_state.get(element.name, "")
            dissolved = {component.name for component in process.components}
            concentration = shown.rpartition(".")[2] in dissolved
            concentration = concentration or getattr(element, "measured", "") in dissolved
            letter = ("A" if concentration else "L") if seat in held else "F" if seat else "X"
            tag = _TAG.fullmatch(process.tags.get(element.measurements()[0].name, ""))
            named = _TAG.fullmatch(element.name)
            if tag is None and named and named[1] == letter:  # a level that is called LT301
                tag = named
            letter, number = tag.groups() if tag else (letter, number)
            instruments.append(Instrument(element.name, letter, seat, number))
        elif flowing or element.symbol in ("flow", "pump"):
            links.append(_link(element, held))
        else:
            loose.append(element.name)
    owners = {
        signal.name: element.name
        for element in process.elements
        for signal in (*element.measurements(), *element.inputs(), *element.disturbances())
    }
    return FlowGraph(
        tuple(vessels), tuple(links), tuple(junctions), tuple(instruments),
        tuple(loose), owners,
    )  # fmt: skip


def _link(element: Element, held: set[str]) -> Link:
    flowing = [
        (connection.name, connection.wanted == "source" or connection.key[0].startswith("source"))
        for connection in element.connections()
        if connection.carries_flow
    ]
    sources = tuple(name for name, drawn in flowing if drawn)
    targets = tuple(name for name, drawn in flowing if not drawn)
    joins = len(sources) == len(targets) == 1 and {*sources, *targets} <= held
    plain = element.symbol not in ("pump", "flow") and not element.inputs()
    falls = element.symbol in _BY_WEIGHT or plain
    return Link(
        element.name,
        element.symbol,
        sources,
        targets,
        submerged=joins and bool(getattr(element, "submerged", False)),
        by_weight=falls and len(sources) == 1 and sources[0] in held,
        shares=tuple(map(getattr(element, "destinations", {}).get, targets)),
    )
