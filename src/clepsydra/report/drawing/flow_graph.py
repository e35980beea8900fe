"""What flows where: the elements of a process as a graph for the drawing."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from clepsydra.process.element import Element
from clepsydra.process.process import Process

#: The tag of an instrument: what it measures, what it does, its loop.
_TAG = re.compile(r"([A-Z])[A-Z]*_?(\d\w*)")
#: Symbols of elements through which liquid falls or presses by its own weight.
_BY_WEIGHT = ("orifice", "valve")


@dataclass(frozen=True)
class Link:
    """An element that makes liquid flow from one place to another.

    Parameters
    ----------
    name, symbol : str
    sources, targets : tuple of str
        The elements that it names; none on a side that lies outside the plant.
    submerged : bool
        It joins tanks below their surfaces.
    by_weight : bool
        What leaves its tank falls, so that it stands below the tank.
    """

    name: str
    symbol: str
    sources: tuple[str, ...]
    targets: tuple[str, ...]
    submerged: bool = False
    by_weight: bool = False


@dataclass(frozen=True)
class Junction:
    """An element that passes on what it receives: a splitter, a delay.

    Parameters
    ----------
    name, symbol : str
    branches : tuple of (share or None, element)
    """

    name: str
    symbol: str
    branches: tuple[tuple[float | None, str], ...]


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
    vessels, reservoirs : tuple of str
    links : tuple of Link
    junctions : tuple of Junction
    instruments : tuple of Instrument
    loose : tuple of str
        Elements that nothing flows through.
    owners : dict
        Measurement or manipulated variable to the element that has it.

    Examples
    --------
    >>> upper = Link("a", "orifice", ("upper",), ("lower",), by_weight=True)
    >>> FlowGraph(("upper", "lower"), ("basin",), (upper,), (), ()).layers()
    {'upper': 1, 'lower': 0}
    """

    vessels: tuple[str, ...]
    reservoirs: tuple[str, ...]
    links: tuple[Link, ...]
    junctions: tuple[Junction, ...]
    instruments: tuple[Instrument, ...]
    loose: tuple[str, ...] = ()
    owners: Mapping[str, str] = field(default_factory=dict)

    def junction(self, name: str) -> Junction | None:
        """Return the junction of a name, if there is one."""
        return next((entry for entry in self.junctions if entry.name == name), None)

    def owner(self, signal: str) -> str:
        """Return the element that a signal belongs to; what is no signal has its own name."""
        return self.owners.get(signal, signal)

    def feeding(self, junction: Junction) -> list[Link]:
        """Return the links that lead into a junction."""
        return [link for link in self.links if junction.name in link.targets]

    def feeds(self, junction: Junction) -> int:
        """Return how many pipes lead into a junction."""
        branches = [name for other in self.junctions for _, name in other.branches]
        return len(self.feeding(junction)) + branches.count(junction.name)

    def leaves(self, name: str) -> list[str]:
        """Return the tanks and reservoirs that liquid reaches from here, junctions passed over."""
        junction = self.junction(name)
        if junction is None:
            return [name]
        return [leaf for _, branch in junction.branches for leaf in self.leaves(branch)]

    def ends(self, link: Link) -> list[str]:
        """Return the tanks and reservoirs that a link feeds."""
        return [leaf for target in link.targets for leaf in self.leaves(target)]

    def falls(self) -> list[tuple[str, str]]:
        """Return each pair of an upper tank and one that it drains into."""
        return [
            (source, end)
            for link in self.links
            if link.by_weight and not link.submerged
            for source in link.sources
            for end in self.ends(link)
            if source in self.vessels and end in self.vessels
        ]

    def neighbours(self) -> list[tuple[str, str]]:
        """Return the pairs of tanks that are joined below their surfaces."""
        return [
            (link.sources[0], link.targets[0])
            for link in self.links
            if link.submerged and link.sources and link.targets
        ]

    def layers(self) -> dict[str, int]:
        """Return how many tanks lie below each tank on its longest way down.

        Tanks that are joined below their surfaces stand at one height. A fall that would close
        a circle is left out.
        """
        group = {tank: tank for tank in self.vessels}
        for one, other in self.neighbours():
            old, new = group[one], group[other]
            group = {tank: new if name == old else name for tank, name in group.items()}
        lower: dict[str, list[str]] = {}
        for upper, below in self.falls():
            if group[upper] != group[below]:
                lower.setdefault(group[upper], []).append(group[below])
        found: dict[str, int] = {}

        def height(name: str, above: tuple[str, ...]) -> int:
            if name not in found:
                on_the_way = (*above, name)
                found[name] = max(
                    (1 + height(n, on_the_way) for n in lower.get(name, []) if n not in on_the_way),
                    default=0,
                )
            return found[name]

        return {tank: height(group[tank], ()) for tank in self.vessels}


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
    reservoirs: list[str] = []
    links: list[Link] = []
    junctions: list[Junction] = []
    instruments: list[Instrument] = []
    loose: list[str] = []
    held = {e.name for e in process.elements if e.receives and not e.endless and not e.passes_on}
    for element in process.elements:
        flowing = [c for c in element.connections() if c.carries_flow]
        if element.name in held:
            vessels.append(element.name)
        elif element.endless:
            reservoirs.append(element.name)
        elif element.passes_on:
            junctions.append(_junction(element))
        elif element.measurements():
            seat = next((c.name for c in element.connections()), "")
            number = str(101 + len(instruments))
            shown = process.measured_state.get(element.name, "")
            dissolved = {component.name for component in process.components}
            concentration = shown.rpartition(".")[2] in dissolved
            concentration = concentration or getattr(element, "measured", "") in dissolved
            letter = ("A" if concentration else "L") if seat in held else "F" if seat else "X"
            tag = _TAG.fullmatch(process.tags.get(element.measurements()[0].name, ""))
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
        tuple(vessels), tuple(reservoirs), tuple(links), tuple(junctions), tuple(instruments),
        tuple(loose), owners,
    )  # fmt: skip


def _junction(element: Element) -> Junction:
    shares = getattr(element, "destinations", {})
    names = [c.name for c in element.connections() if c.carries_flow]
    return Junction(element.name, element.symbol, tuple((shares.get(name), name) for name in names))


def _link(element: Element, held: set[str]) -> Link:
    sources: list[str] = []
    targets: list[str] = []
    for connection in element.connections():
        if connection.carries_flow:
            drawn = connection.wanted == "source" or connection.key[0].startswith("source")
            (sources if drawn else targets).append(connection.name)
    submerged = bool(getattr(element, "submerged", False))
    submerged = submerged and len(sources) == len(targets) == 1
    plain = element.symbol not in ("pump", "flow") and not element.inputs()
    falls = element.symbol in _BY_WEIGHT or plain
    return Link(
        element.name,
        element.symbol,
        tuple(sources),
        tuple(targets),
        submerged=submerged and sources[0] in held and targets[0] in held,
        by_weight=falls and len(sources) == 1 and sources[0] in held,
    )
