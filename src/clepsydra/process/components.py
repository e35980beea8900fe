"""The components of a process file: what is dissolved, and whether it enters anywhere."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.units import convertible
from clepsydra.process.component import Component
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.table_reader import TableReader, checked_name
from clepsydra.process.wiring import Place

_UNITS = ("kg/m^3", "mol/m^3")
#: What elements and balances call the liquid and its quantities.
_TAKEN = ("liquid", "level", "volume", "flow")


def read_components(document: Document, general: TableReader) -> tuple[Component, ...]:
    """Return the components of a file, [components.salt] with the range of its concentrations."""
    if not general.has("components"):
        return ()
    components = []
    for name in TableReader(document, ("components",), None).present:
        path = ("components", name)
        checked_name(name, document.place(*path))
        if name.lower() in _TAKEN:
            expected = "the name of something that is dissolved"
            remedy = f"choose another name than {', '.join(_TAKEN)}"
            raise InputError(document.place(*path), name, expected, remedy)
        table = TableReader(document, path, ("range",))
        shown = table.display_units("range").get("range", "")
        unit = next((u for u in _UNITS if shown and convertible(shown, u)), _UNITS[0])
        low, high = table.range("range", unit, at_least=0.0)
        components.append(Component(name, unit, shown, low, high))
    return tuple(components)


def check_components(
    components: Sequence[Component], elements: Sequence[Element], place: Place
) -> None:
    """Refuse a component that enters the plant nowhere."""
    for component in components:
        if not any(component.name in element.brings() for element in elements):
            raise InputError(
                place("components", component.name),
                component.name,
                "a component that some flow or reservoir brings",
                f"add concentration = {{ {component.name} = … }} to a flow from outside or a "
                "reservoir, or remove it",
            )
