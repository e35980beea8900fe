"""The wiring of a plant: whether its elements fit together, and in which order flows follow."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from graphlib import CycleError, TopologicalSorter

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.process.element import Connection, Element

_WANTED = {
    "receiver": "tank, reservoir, splitter or delay",
    "source": "tank or reservoir",
    "flow": "pump, valve, outlet or other element that causes a flow",
}

#: Returns file, line and path of a key of an element, for a message.
Place = Callable[..., str]


def check_wiring(elements: Sequence[Element], place: Place, read: Sequence[Element] = ()) -> None:
    """See that every connection ends where it may, and that every element is connected.

    Parameters
    ----------
    place : callable
        Takes a table and keys below it, returns where they stand.
    read : sequence of Element, optional
        All of the file, with those that no flow touches: one of them may be meant.

    Examples
    --------
    >>> from clepsydra.process.elements.orifice import Orifice
    >>> from clepsydra.process.elements.tank import Tank
    >>> from clepsydra.process.vessels.prism import Prism
    >>> tank = Tank("tank", vessel=Prism(0.3, area=0.01))
    >>> elements = [tank, Orifice("outlet", "tank", "basn", 1e-4)]
    >>> try:
    ...     check_wiring(elements, lambda *keys: ".".join(keys))
    ... except InputError as error:
    ...     print(error.place, "|", error.expected)
    orifices.outlet.destination | the name of a tank, reservoir, splitter or delay
    """
    by_name: dict[str, Element] = {}
    for element in elements:
        twin = by_name.get(element.name.lower())
        if twin is not None or element.name.lower() == "gravity":
            raise InputError(
                place(element.table, element.name),
                element.name,
                "a name that nothing else has, in large or small letters",
                "rename it, since it is also the name of "
                + (f"a {twin.kind}" if twin else "the acceleration of gravity"),
            )
        by_name[element.name.lower()] = element
    named = {element.name: element for element in elements}
    meant = {element.name: element for element in read or elements}
    for element in elements:
        _check_connections(element, named, meant, place)
    _check_touched(elements, place)
    _check_identifiers(elements, place)
    try:
        flow_order(elements)
    except CycleError as error:
        circle = error.args[1]
        first = next(element for element in elements if element.name == circle[0])
        where = place(first.table, first.name)
        expected = "flows that reach a tank or reservoir"
        remedy = "let one of them end in a tank or reservoir"
        raise InputError(where, " → ".join(reversed(circle)), expected, remedy) from None
    _check_delays(elements, named, place)


def flow_order(elements: Sequence[Element]) -> tuple[Element, ...]:
    """Return the elements so that each that passes flows on comes after those that feed it.

    Raises
    ------
    graphlib.CycleError
        Elements that pass flows on feed each other in a circle.

    Examples
    --------
    >>> from clepsydra.process.elements.flow_splitter import FlowSplitter
    >>> from clepsydra.process.elements.reservoir import Reservoir
    >>> valve = FlowSplitter("valve", {"basin": 1.0})
    >>> [element.name for element in flow_order([valve, Reservoir("basin")])]
    ['valve', 'basin']
    """
    passing = {element.name for element in elements if element.passes_on}
    feeders: dict[str, set[str]] = {element.name: set() for element in elements}
    for element in elements:
        for connection in element.connections():
            if connection.name in passing and connection.carries_flow:
                feeders[connection.name].add(element.name)
    by_name = {element.name: element for element in elements}
    return tuple(by_name[name] for name in TopologicalSorter(feeders).static_order())


def _check_delays(elements: Sequence[Element], named: dict[str, Element], place: Place) -> None:
    """Refuse a delay that feeds what may refuse: what is on its way cannot be held back."""

    def fed(element: Element) -> Iterator[Element]:
        for connection in element.connections():
            if connection.carries_flow:
                other = named[connection.name]
                yield from fed(other) if other.passes_on else (other,)

    for delay in (element for element in elements if element.delays()):
        for closed in (element for element in fed(delay) if element.may_refuse):
            raise InputError(
                place(closed.table, closed.name),
                f"{closed.name}, whose inflow stops when it is full",
                f"a vessel that always takes in, since {delay.name} feeds it, and what is on its "
                "way there cannot be held back",
                'write when_full = "run ends", or give it a weir',
            )


def _check_connections(
    element: Element, by_name: dict[str, Element], meant: dict[str, Element], place: Place
) -> None:
    connections = element.connections()
    for connection in connections:
        named = by_name.get(connection.name)
        if named is None or not _fits(named, connection):
            fitting = [name for name, other in meant.items() if _fits(other, connection)]
            wanted = _WANTED.get(connection.wanted, connection.wanted)
            raise InputError(
                place(element.table, element.name, *connection.key),
                connection.name[:60],
                f"the name of a {wanted}",
                suggestion(
                    connection.name,
                    fitting,
                    f"choose from {', '.join(fitting)}" if fitting else "add one to the file",
                ),
            )
        around = [c.name for c in connections if c.carries_flow and c.name == connection.name]
        if (len(around) > 1 and connection.carries_flow) or connection.name == element.name:
            where = place(element.table, element.name, *connection.key)
            remedy = "let it begin or end somewhere else"
            raise InputError(where, connection.name, "a flow from one element to another", remedy)


def _fits(other: Element, connection: Connection) -> bool:
    if connection.wanted == "receiver":
        return other.receives
    if connection.wanted == "flow":
        return type(other).flows is not Element.flows and not other.gives
    if connection.wanted == "tank":
        return other.holds_liquid
    return other.gives if connection.wanted == "source" else other.kind == connection.wanted


def _check_touched(elements: Sequence[Element], place: Place) -> None:
    """Refuse a tank, splitter or reservoir that no flow enters or leaves."""
    touched = {
        connection.name
        for element in elements
        for connection in element.connections()
        if connection.carries_flow
    }
    for element in elements:
        if element.receives and element.name not in touched:
            expected = f"a {element.kind} that some flow enters or leaves"
            remedy = "connect it, or remove it"
            raise InputError(place(element.table, element.name), element.name, expected, remedy)


def _check_identifiers(elements: Sequence[Element], place: Place) -> None:
    """Refuse names such as tank "a" (level a.level) beside a pump "a_level".

    Within one element, two signals of one name can be a component named like a quantity.
    """
    owners: dict[str, Element] = {}
    for element in elements:
        own: set[str] = set()
        for signal in element.signals():
            name = signal.identifier.lower()
            owner = owners.setdefault(name, element)
            if owner is not element:
                expected = f"a name that does not read like {signal.identifier} of {owner.name}"
                remedy = "rename one of the two"
                raise InputError(place(element.table, element.name), element.name, expected, remedy)
            if name in own:
                expected = f"one signal of that name in {element.name}"
                remedy = "rename the component, or whatever else has that name"
                raise InputError(place(element.table, element.name), signal.name, expected, remedy)
            own.add(name)
