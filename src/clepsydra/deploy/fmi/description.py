"""The model description, in both versions of the interface, and the build description of 3.0."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cache
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from clepsydra import __version__
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable

#: Shown to the importer as the end of an experiment, in model steps.
_STEPS_SHOWN = 600
#: Of an importer's integrator where the user gives none.
_TOLERANCE = 1e-8
_TYPES = {
    "2.0": {"real": "Real", "integer": "Integer", "boolean": "Boolean"},
    "3.0": {"real": "Float64", "integer": "Int32", "boolean": "Boolean"},
}
#: The type of the annotation that tells which text the model was printed from.
_ANNOTATION = "clepsydra.origin"
#: The independent variable, which version 3.0 describes as well.
_TIME = {
    "name": "time", "valueReference": "0", "description": "time",
    "causality": "independent", "variability": "continuous", "unit": "s",
}  # fmt: skip
#: Dimensions as Pint calls them, to the base units of the standard.
_BASE = {
    "[mass]": "kg", "[length]": "m", "[time]": "s", "[current]": "A", "[temperature]": "K",
    "[substance]": "mol", "[luminosity]": "cd",
}  # fmt: skip
#: Kinds of quantity by unit, in the names that Modelica gives them.
_QUANTITIES = {
    "m": "Length", "m^2": "Area", "m^3": "Volume", "m^3/s": "VolumeFlowRate", "s": "Time",
    "V": "ElectricPotential", "A": "ElectricCurrent", "m/s": "Velocity", "Hz": "Frequency",
    "m/s^2": "Acceleration", "kg/m^3": "Density", "mol/m^3": "Concentration",
    "kg/s": "MassFlowRate",
}  # fmt: skip


def model_description(model: FmuModel, version: str, sources: Sequence[str]) -> str:
    """Return the text of modelDescription.xml, which in 2.0 also names the sources."""
    third = version == "3.0"
    attributes = {
        "fmiVersion": version,
        "modelName": model.name,
        "description": _plain(". ".join([model.title, *model.origin.lines()[1:]])),
        "version": model.digest,
        "generationTool": f"Clepsydra {__version__}",
        "variableNamingConvention": "structured",
        "instantiationToken" if third else "guid": model.token(version),
    }
    if model.exchange and not third:
        attributes["numberOfEventIndicators"] = str(len(model.indicators))
    root = Element("fmiModelDescription", attributes)
    _add_interface(root, model, version, sources)
    signals = [variable.signal for variable in model.variables]
    _add_units(root, [Signal("time", "s"), *signals] if third else signals)
    category = {"name": "error" if third else "logStatusError", "description": "What was refused"}
    SubElement(SubElement(root, "LogCategories"), "Category", category)
    step = model.origin.sampling_period
    experiment = {"startTime": "0.0", "stopTime": _number(_STEPS_SHOWN * step)}
    if model.exchange:
        experiment["tolerance"] = _number(_TOLERANCE)
    SubElement(root, "DefaultExperiment", experiment, stepSize=_number(model.step or step))
    about = model.origin.lines()
    if not third:
        note = SubElement(SubElement(root, "VendorAnnotations"), "Tool", name="Clepsydra")
        SubElement(note, "Origin", text=_plain(" ".join(about)), digest=model.digest)
    _add_variables(root, model, version)
    _add_structure(root, model, version)
    if third:
        note = SubElement(SubElement(root, "Annotations"), "Annotation", type=_ANNOTATION)
        note.text = _plain(" ".join([*about, f"Digest {model.digest}."]))
    return _xml_text(root)


def build_description(model: FmuModel, sources: Sequence[str]) -> str:
    """Return the text of sources/buildDescription.xml: what to compile, and how."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    build = SubElement(root, "BuildConfiguration", modelIdentifier=model.name)
    how = {"language": "C99", "compilerOptions": "-ffp-contract=off"}
    files = SubElement(build, "SourceFileSet", how)
    for name in sources:
        SubElement(files, "SourceFile", name=name)
    return _xml_text(root)


def _add_interface(root: Element, model: FmuModel, version: str, sources: Sequence[str]) -> None:
    attributes = {"modelIdentifier": model.name}
    if version == "2.0":
        attributes["canNotUseMemoryManagementFunctions"] = "true"
    state = "FMUState" if version == "3.0" else "FMUstate"
    attributes |= {f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"}
    if not model.exchange:
        attributes["canHandleVariableCommunicationStepSize"] = "true"
    elif version == "3.0":
        attributes["needsCompletedIntegratorStep"] = str(bool(model.followed)).lower()
    else:
        attributes["completedIntegratorStepNotNeeded"] = str(not model.followed).lower()
    tag = "ModelExchange" if model.exchange else "CoSimulation"
    interface = SubElement(root, tag, attributes)
    if version == "2.0":
        files = SubElement(interface, "SourceFiles")
        for name in sources:
            SubElement(files, "File", name=name)


def _add_units(root: Element, signals: Sequence[Signal]) -> None:
    """Append the units by name, each with its dimension and the units that a reader sees."""
    shown: dict[str, set[str]] = {}
    for signal in signals:
        if signal.kind == "real":
            shown.setdefault(signal.unit, set()).add(signal.shown_unit)
    if not shown:
        return
    group = SubElement(root, "UnitDefinitions")
    for unit, others in sorted(shown.items()):
        element = SubElement(group, "Unit", name=unit)
        exponents, factor = dimension(unit)
        if exponents is not None:
            powers = {base: str(power) for base, power in exponents.items()}
            if factor != 1.0:
                powers["factor"] = _number(factor)
            SubElement(element, "BaseUnit", powers)
        for other in sorted(others - {unit}):
            SubElement(
                element, "DisplayUnit", name=other, factor=_number(from_si(1.0, unit, other))
            )


@cache
def dimension(unit: str) -> tuple[dict[str, int] | None, float]:
    """Return a unit's exponents of base units, and its factor: value in these = factor × value.

    There are no exponents where Pint does not know it, or they are no whole numbers.

    Examples
    --------
    >>> dimension("V")
    ({'kg': 1, 'm': 2, 's': -3, 'A': -1}, 1.0)
    """
    import pint

    if unit == "1":
        return {}, 1.0
    try:
        base = _registry().Quantity(1.0, unit).to_base_units()
    except (pint.UndefinedUnitError, pint.OffsetUnitCalculusError):
        return None, 1.0
    powers = {_BASE.get(name, name): power for name, power in base.dimensionality.items()}
    if any(name not in _BASE.values() or power != int(power) for name, power in powers.items()):
        return None, 1.0
    exponents = {base: int(powers[base]) for base in _BASE.values() if base in powers}
    return exponents, float(base.magnitude)


@cache
def _registry():  # type: ignore[no-untyped-def]
    import pint

    return pint.UnitRegistry()


def _add_variables(root: Element, model: FmuModel, version: str) -> None:
    group, states, types = SubElement(root, "ModelVariables"), model.states, _TYPES[version]
    if version == "3.0":
        SubElement(group, "Float64", _TIME)
    for reference, variable in enumerate(model.variables, 1):
        general, value = _general_attributes(variable, reference), _value_attributes(variable)
        if variable in states:
            value["nominal"] = _number(variable.nominal)
        if variable.derivative_of:
            # Value references count from 1 as the places of the variables do.
            value["derivative"] = str(model.reference(variable.derivative_of))
        kind = types[variable.signal.kind]
        if version == "3.0":
            SubElement(group, kind, general | value)
        else:
            SubElement(SubElement(group, "ScalarVariable", general), kind, value)


def _general_attributes(variable: FmuVariable, reference: int) -> dict[str, str]:
    """Return name, reference, description, causality, variability and how it starts."""
    found = {"name": variable.name, "valueReference": str(reference)}
    if variable.signal.description:
        found["description"] = _plain(variable.signal.description)
    found |= {"causality": variable.causality, "variability": variable.variability}
    if variable.causality in ("output", "local"):
        found["initial"] = "exact" if variable.settable else "calculated"
    return found


def _value_attributes(variable: FmuVariable) -> dict[str, str]:
    """Return unit, range and start value; a limit that the start value breaks is left out."""
    signal, found = variable.signal, dict[str, str]()
    if signal.kind == "boolean":
        return {"start": str(bool(signal.initial)).lower()} if variable.settable else {}
    if signal.kind == "real":
        if signal.unit in _QUANTITIES:
            found["quantity"] = _QUANTITIES[signal.unit]
        found["unit"] = signal.unit
        if signal.shown_unit != signal.unit:
            found["displayUnit"] = signal.shown_unit
    text = (lambda value: str(int(value))) if signal.kind == "integer" else _number
    start = signal.initial if variable.settable else None
    if math.isfinite(signal.low) and (start is None or start >= signal.low):
        found["min"] = text(signal.low)
    if math.isfinite(signal.high) and (start is None or start <= signal.high):
        found["max"] = text(signal.high)
    return found if start is None else {**found, "start": text(start)}


def _add_structure(root: Element, model: FmuModel, version: str) -> None:
    """Append what results depend on; version 2.0 puts them into a group each."""

    def later(variables: Iterable[FmuVariable]) -> list[tuple[FmuVariable, tuple[str, ...]]]:
        return [(variable, model.known_later(variable)) for variable in variables]

    third = version == "3.0"
    results = [v for v in (*model.outputs, *model.derivatives) if not v.settable]
    if not third:
        results.sort(key=lambda variable: model.reference(variable.signal.name))
    groups = [
        ("Outputs", "Output", later(model.outputs)),
        ("Derivatives", "ContinuousStateDerivative", later(model.derivatives)),
        ("InitialUnknowns", "InitialUnknown", [(v, v.depends_on or ()) for v in results]),
    ]
    if third:
        groups.append(("", "EventIndicator", later(map(model.variable, model.indicators))))
    structure = SubElement(root, "ModelStructure")
    for group, tag, entries in groups:
        parent = structure if third or not entries else SubElement(structure, group)
        for variable, depends_on in entries:
            places = sorted(model.reference(name) for name in depends_on)
            told = {
                "valueReference" if third else "index": str(model.reference(variable.signal.name)),
                "dependencies": " ".join(map(str, places)),
            }
            SubElement(parent, tag if third else "Unknown", told)


def _number(value: float) -> str:
    """Write a number as XML reads it back exactly."""
    if math.isnan(value):
        return "NaN"
    return repr(float(value)) if math.isfinite(value) else "INF" if value > 0 else "-INF"


def _plain(text: str) -> str:
    """Return a text on one line, without what XML cannot hold."""
    return " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())


def _xml_text(root: Element) -> str:
    """Return a document with its declaration, indented."""
    indent(root)
    body = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{body}\n'
