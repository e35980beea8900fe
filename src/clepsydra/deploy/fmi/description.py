"""What the model descriptions of both versions have in common: texts, numbers, attributes."""

from __future__ import annotations

import math
from xml.etree import ElementTree

from clepsydra import __version__
from clepsydra.base.signal import Signal
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable
from clepsydra.deploy.fmi.unit_definitions import QUANTITIES, UnitDefinition

#: Shown to the importer as the end of an experiment, in model steps.
_STEPS_SHOWN = 600
#: Of an importer's integrator where the user gives none.
_TOLERANCE = 1e-8


def number(value: float) -> str:
    """Write a number as XML reads it back exactly.

    Examples
    --------
    >>> number(0.1), number(float("inf")), number(2.0)
    ('0.1', 'INF', '2.0')
    """
    if math.isnan(value):
        return "NaN"
    return repr(float(value)) if math.isfinite(value) else "INF" if value > 0 else "-INF"


def plain(text: str) -> str:
    """Return a text on one line, without what XML cannot hold.

    Examples
    --------
    >>> plain("level of\\n tank\\x00 1")
    'level of tank 1'
    """
    return " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())


def root_attributes(model: FmuModel, fmi_version: str) -> dict[str, str]:
    """Return the attributes of the model description but the token.

    Examples
    --------
    See `clepsydra.deploy.fmi.description_3`.
    """
    return {
        "fmiVersion": fmi_version,
        "modelName": model.name,
        "description": plain(". ".join([model.title, *model.origin.lines()[1:]])),
        "version": model.digest,
        "generationTool": f"Clepsydra {__version__}",
        "variableNamingConvention": "structured",
    }


def experiment(model: FmuModel) -> dict[str, str]:
    """Return the attributes of the default experiment.

    Examples
    --------
    See `clepsydra.deploy.fmi.description_3`.
    """
    step = model.origin.sampling_period
    found = {"startTime": "0.0", "stopTime": number(_STEPS_SHOWN * step)}
    if model.exchange:
        found["tolerance"] = number(_TOLERANCE)
    return {**found, "stepSize": number(model.step or step)}


def add_units(parent: ElementTree.Element, units: list[UnitDefinition]) -> None:
    """Append the unit definitions.

    Examples
    --------
    >>> parent = ElementTree.Element("description")
    >>> add_units(parent, [UnitDefinition("s", {"s": 1}, 1.0, (("min", 1 / 60),))])
    >>> [child.tag for child in parent.iter()][1:]
    ['UnitDefinitions', 'Unit', 'BaseUnit', 'DisplayUnit']
    """
    if not units:
        return
    group = ElementTree.SubElement(parent, "UnitDefinitions")
    for unit in units:
        element = ElementTree.SubElement(group, "Unit", name=unit.name)
        if unit.exponents is not None:
            powers = {base: str(power) for base, power in unit.exponents.items()}
            if unit.factor != 1.0:
                powers["factor"] = number(unit.factor)
            ElementTree.SubElement(element, "BaseUnit", powers)
        for name, factor in unit.shown:
            ElementTree.SubElement(element, "DisplayUnit", name=name, factor=number(factor))


def general_attributes(variable: FmuVariable, reference: int) -> dict[str, str]:
    """Return name, reference, description, causality, variability and how it starts.

    Examples
    --------
    >>> level = FmuVariable(Signal("level_1", "V"), "inputs.level_1", "input", "discrete")
    >>> general_attributes(level, 3)["valueReference"]
    '3'
    """
    found = {"name": variable.name, "valueReference": str(reference)}
    if variable.signal.description:
        found["description"] = plain(variable.signal.description)
    found |= {"causality": variable.causality, "variability": variable.variability}
    if variable.causality in ("output", "local"):
        found["initial"] = "exact" if variable.settable else "calculated"
    return found


def value_attributes(variable: FmuVariable) -> dict[str, str]:
    """Return unit, range and start value; a limit that the start value breaks is left out.

    Examples
    --------
    >>> level = Signal("level_1", "m", low=0.0, high=0.2, initial=0.1)
    >>> value_attributes(FmuVariable(level, "inputs.level_1", "input", "discrete"))["max"]
    '0.2'
    """
    signal, found = variable.signal, {}
    if signal.kind == "boolean":
        return {"start": str(bool(signal.initial)).lower()} if variable.settable else {}
    if signal.kind == "real":
        found = _unit_attributes(signal)
    text = (lambda value: str(int(value))) if signal.kind == "integer" else number
    start = signal.initial if variable.settable else None
    if math.isfinite(signal.low) and (start is None or start >= signal.low):
        found["min"] = text(signal.low)
    if math.isfinite(signal.high) and (start is None or start <= signal.high):
        found["max"] = text(signal.high)
    return found if start is None else {**found, "start": text(start)}


def _unit_attributes(signal: Signal) -> dict[str, str]:
    found = {"unit": signal.unit}
    if signal.unit in QUANTITIES:
        found = {"quantity": QUANTITIES[signal.unit], **found}
    if signal.shown_unit != signal.unit:
        found["displayUnit"] = signal.shown_unit
    return found


def xml_text(root: ElementTree.Element) -> str:
    """Return a document with its declaration, indented.

    Examples
    --------
    >>> print(xml_text(ElementTree.Element("empty")), end="")
    <?xml version="1.0" encoding="UTF-8"?>
    <empty />
    """
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{body}\n'
