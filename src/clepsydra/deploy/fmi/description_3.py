"""The model description and the build description of the Functional Mock-up Interface 3.0."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from clepsydra.base.signal import Signal
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

_TYPES = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}
#: The type of the annotation that tells which text the model was printed from.
_ANNOTATION = "clepsydra.origin"


def model_description_3(model: FmuModel) -> str:
    """Return the text of modelDescription.xml, FMI 3.0.

    Examples
    --------
    See `clepsydra.deploy.fmi.write`.
    """
    attributes = root_attributes(model, "3.0")
    attributes["instantiationToken"] = model.token("3.0")
    root = ElementTree.Element("fmiModelDescription", attributes)
    _add_interface(root, model)
    time = Signal("time", "s")
    add_units(root, unit_definitions([time, *(v.signal for v in model.variables)]))
    categories = ElementTree.SubElement(root, "LogCategories")
    ElementTree.SubElement(categories, "Category", name="error", description="What was refused")
    ElementTree.SubElement(root, "DefaultExperiment", experiment(model))
    _add_variables(root, model)
    _add_structure(root, model)
    annotations = ElementTree.SubElement(root, "Annotations")
    note = ElementTree.SubElement(annotations, "Annotation", type=_ANNOTATION)
    note.text = plain(" ".join([*model.origin.lines(), f"Digest {model.digest}."]))
    return xml_text(root)


def build_description_3(model: FmuModel, sources: Sequence[str]) -> str:
    """Return the text of sources/buildDescription.xml: what to compile, and how.

    Examples
    --------
    See `clepsydra.deploy.fmi.write`.
    """
    root = ElementTree.Element("fmiBuildDescription", fmiVersion="3.0")
    build = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=model.name)
    files = ElementTree.SubElement(
        build, "SourceFileSet", language="C99", compilerOptions="-ffp-contract=off"
    )
    for name in sources:
        ElementTree.SubElement(files, "SourceFile", name=name)
    return xml_text(root)


def _add_interface(root: ElementTree.Element, model: FmuModel) -> None:
    attributes = {
        "modelIdentifier": model.name,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
    }
    if model.exchange:
        attributes["needsCompletedIntegratorStep"] = str(bool(model.followed)).lower()
        ElementTree.SubElement(root, "ModelExchange", attributes)
        return
    attributes["canHandleVariableCommunicationStepSize"] = "true"
    if not model.scans:
        attributes["fixedInternalStepSize"] = number(model.step)
    ElementTree.SubElement(root, "CoSimulation", attributes)


def _add_variables(root: ElementTree.Element, model: FmuModel) -> None:
    group, states = ElementTree.SubElement(root, "ModelVariables"), model.states
    time = {
        "name": "time", "valueReference": "0", "description": "time",
        "causality": "independent", "variability": "continuous", "unit": "s",
    }  # fmt: skip
    ElementTree.SubElement(group, "Float64", time)
    for reference, variable in enumerate(model.variables, 1):
        attributes = general_attributes(variable, reference) | value_attributes(variable)
        if variable in states:
            attributes["nominal"] = number(variable.nominal)
        if variable.derivative_of:
            attributes["derivative"] = str(model.reference(variable.derivative_of))
        ElementTree.SubElement(group, _TYPES[variable.signal.kind], attributes)


def _add_structure(root: ElementTree.Element, model: FmuModel) -> None:
    structure = ElementTree.SubElement(root, "ModelStructure")

    def add(tag: str, variable: FmuVariable, depends_on: Sequence[str]) -> None:
        references = sorted(model.reference(name) for name in depends_on)
        ElementTree.SubElement(
            structure,
            tag,
            valueReference=str(model.reference(variable.signal.name)),
            dependencies=" ".join(map(str, references)),
        )

    for variable in model.outputs:
        add("Output", variable, model.known_later(variable))
    for variable in model.derivatives:
        add("ContinuousStateDerivative", variable, model.known_later(variable))
    for variable in (*model.outputs, *model.derivatives):
        if not variable.settable:
            add("InitialUnknown", variable, variable.depends_on or ())
    for name in model.indicators:
        variable = model.variable(name)
        add("EventIndicator", variable, model.known_later(variable))
