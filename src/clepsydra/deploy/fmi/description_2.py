"""The model description of the Functional Mock-up Interface 2.0."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from clepsydra.deploy.fmi.description import (
    add_units,
    experiment,
    general_attributes,
    number,
    plain,
    root_attributes,
    value_attributes,
    xml_text,
)
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable
from clepsydra.deploy.fmi.unit_definitions import unit_definitions

_TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}


def model_description_2(model: FmuModel, sources: Sequence[str]) -> str:
    """Return the text of modelDescription.xml, FMI 2.0, which also names the sources.

    Examples
    --------
    See `clepsydra.deploy.fmi.write`.
    """
    attributes = root_attributes(model, "2.0")
    attributes["guid"] = model.token("2.0")
    if model.exchange:
        attributes["numberOfEventIndicators"] = str(len(model.indicators))
    root = ElementTree.Element("fmiModelDescription", attributes)
    _add_interface(root, model, sources)
    add_units(root, unit_definitions([v.signal for v in model.variables]))
    categories = ElementTree.SubElement(root, "LogCategories")
    ElementTree.SubElement(
        categories, "Category", name="logStatusError", description="What was refused"
    )
    ElementTree.SubElement(root, "DefaultExperiment", experiment(model))
    notes = ElementTree.SubElement(root, "VendorAnnotations")
    note = ElementTree.SubElement(notes, "Tool", name="Clepsydra")
    about = plain(" ".join(model.origin.lines()))
    ElementTree.SubElement(note, "Origin", text=about, digest=model.digest)
    _add_variables(root, model)
    _add_structure(root, model)
    return xml_text(root)


def _add_interface(root: ElementTree.Element, model: FmuModel, sources: Sequence[str]) -> None:
    attributes = {
        "modelIdentifier": model.name,
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }
    if model.exchange:
        attributes["completedIntegratorStepNotNeeded"] = str(not model.followed).lower()
    else:
        attributes["canHandleVariableCommunicationStepSize"] = "true"
    tag = "ModelExchange" if model.exchange else "CoSimulation"
    files = ElementTree.SubElement(ElementTree.SubElement(root, tag, attributes), "SourceFiles")
    for name in sources:
        ElementTree.SubElement(files, "File", name=name)


def _add_variables(root: ElementTree.Element, model: FmuModel) -> None:
    group, states = ElementTree.SubElement(root, "ModelVariables"), model.states
    for reference, variable in enumerate(model.variables, 1):
        element = ElementTree.SubElement(
            group, "ScalarVariable", general_attributes(variable, reference)
        )
        attributes = value_attributes(variable)
        if variable in states:
            attributes["nominal"] = number(variable.nominal)
        if variable.derivative_of:
            # Value references count from 1 as the places of the variables do.
            attributes["derivative"] = str(model.reference(variable.derivative_of))
        ElementTree.SubElement(element, _TYPES[variable.signal.kind], attributes)


def _add_structure(root: ElementTree.Element, model: FmuModel) -> None:
    structure = ElementTree.SubElement(root, "ModelStructure")

    def add(tag: str, entries: Sequence[tuple[FmuVariable, Sequence[str]]]) -> None:
        if not entries:
            return
        group = ElementTree.SubElement(structure, tag)
        for variable, depends_on in entries:
            places = sorted(model.reference(name) for name in depends_on)
            ElementTree.SubElement(
                group,
                "Unknown",
                index=str(model.reference(variable.signal.name)),
                dependencies=" ".join(map(str, places)),
            )

    add("Outputs", [(v, model.known_later(v)) for v in model.outputs])
    add("Derivatives", [(v, model.known_later(v)) for v in model.derivatives])
    unknown = sorted(
        (v for v in (*model.outputs, *model.derivatives) if not v.settable),
        key=lambda variable: model.reference(variable.signal.name),
    )
    add("InitialUnknowns", [(v, v.depends_on or ()) for v in unknown])
