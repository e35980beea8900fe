"""PLCopen XML of a controller with the simulated process beside it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from xml.etree.ElementTree import Element, indent, tostring

from clepsydra import __version__
from clepsydra.base.errors import InputError
from clepsydra.deploy.printing.declarations import Variable
from clepsydra.deploy.structured_text.dialect import Dialect, dialect_of
from clepsydra.deploy.structured_text.pou import Unit, declaration_lines
from clepsydra.deploy.structured_text.project import CONFIGURATION, RESOURCE, TASK, Project

XHTML = "http://www.w3.org/1999/xhtml"
#: Equal programs make equal files, so a file says nothing of the moment it was written.
_MOMENT = "1970-01-01T00:00:00"
_VARIABLES = {
    "VAR_INPUT": "inputVars",
    "VAR_OUTPUT": "outputVars",
    "VAR": "localVars",
    "VAR_TEMP": "tempVars",
}
_UNITS = {"FUNCTION_BLOCK": "functionBlock", "FUNCTION": "function", "PROGRAM": "program"}
_PLAIN_TEXT = "http://www.3s-software.com/plcopenxml/interfaceasplaintext"
#: Version of the schema that the editors of a dialect read.
_NAMESPACES = {
    "codesys": "http://www.plcopen.org/xml/tc6_0200",
    "matiec": "http://www.plcopen.org/xml/tc6_0201",
}


def namespace_of(dialect: str) -> str:
    """Return the version of the schema that the editors of a dialect read.

    Raises
    ------
    InputError
        They read no PLCopen XML.

    Examples
    --------
    >>> namespace_of("codesys")
    'http://www.plcopen.org/xml/tc6_0200'
    """
    if dialect not in _NAMESPACES:
        raise InputError(
            "PLCopen XML, dialect", dialect, f"one of {', '.join(_NAMESPACES)}",
            "TIA Portal reads no PLCopen XML: give it the SCL text as an external source",
        )  # fmt: skip
    return _NAMESPACES[dialect]


def print_plcopen_project(project: Project) -> str:
    """Print a test project as PLCopen XML.

    The task is part of the document for the editors of OpenPLC and Beremiz; in CODESYS and
    TwinCAT it is made in the device tree.

    Raises
    ------
    InputError
        What `print_test_project` refuses, or a dialect whose editor reads no PLCopen XML.

    References
    ----------
    PLCopen Technical Committee 6, XML Formats for IEC 61131-3, version 2.01.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.process_program import process_program
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> text = print_plcopen_project(Project(
    ...     controller.program(), process_program(plant.point, 1),
    ...     controller.input_wires | controller.output_wires, 1.0, dialect="matiec"))
    >>> 'interval="T#1s"' in text, text.count('pouType="program"')
    (True, 1)
    """
    units = project.units
    return document(units[-1].name, units, dialect_of(project.dialect), project.interval)


def document(name: str, units: Sequence[Unit], dialect: Dialect, interval: str = "") -> str:
    """Return units as the text of a PLCopen XML document.

    Parameters
    ----------
    name : str
        Of the project.
    units : sequence of Unit
    dialect : Dialect
        That the units were made in.
    interval : str
        TIME of the task that runs the last unit, if one does. It is part of the document for
        editors that do not make it in their device tree.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> unit = Unit("PROGRAM", "main", ("Nothing yet.",), (), ())
    >>> document("empty", [unit], dialect_of("matiec")).splitlines()[1]
    '<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml">'
    """
    product = {"companyName": "Clepsydra", "productName": "Clepsydra"}
    scalings = (
        _element(which, _element("scaling", x="1", y="1")) for which in ("fbd", "ld", "sfc")
    )
    tasks = [_task(units[-1].name, interval)] if interval and dialect.configuration else []
    coordinates = _element("coordinateInfo", *scalings)
    records = (_record(unit, dialect) for unit in units if unit.kind == "TYPE")
    pous = _element("pous", *(_unit(unit, dialect) for unit in units if unit.kind != "TYPE"))
    root = _element(
        "project",
        _element("fileHeader", **product, productVersion=__version__, creationDateTime=_MOMENT),
        _element("contentHeader", coordinates, name=name, modificationDateTime=_MOMENT),
        _element("types", _element("dataTypes", *records), pous),
        _element("instances", _element("configurations", *tasks)),
        **{"xmlns": namespace_of(dialect.name), "xmlns:xhtml": XHTML},
    )
    indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{tostring(root, encoding="unicode")}\n'


def _record(unit: Unit, dialect: Dialect) -> Element:
    members = (_variable(e, dialect) for section in unit.sections for e in section.variables)
    return _element("dataType", _element("baseType", _element("struct", *members)), name=unit.name)


def _unit(unit: Unit, dialect: Dialect) -> Element:
    returned = [_element("returnType", _element(unit.result))] if unit.result else []
    sections = []
    for section in unit.sections:
        variables = [_variable(each, dialect) for each in section.variables]
        qualified = {section.qualifier.lower(): "true"} if section.qualifier else {}
        if variables:
            sections.append(_element(_VARIABLES[section.keyword], *variables, **qualified))
    told = _element("documentation", _formatted(unit.head, dialect))
    body = _element("body", _element("ST", _formatted(unit.body, dialect)))
    parts = [_element("interface", *returned, *sections, told), body]
    if dialect.declarations_as_text:
        # The declarations as text, too, with all of their comments.
        plain = _element(
            "InterfaceAsPlainText", _formatted(declaration_lines(unit, dialect), dialect)
        )
        data = _element("data", plain, name=_PLAIN_TEXT, handleUnknown="implementation")
        parts.append(_element("addData", data))
    return _element("pou", *parts, name=unit.name, pouType=_UNITS[unit.kind])


def _variable(entry: Variable, dialect: Dialect) -> Element:
    kind = _element("derived", name=entry.type) if entry.is_block else _element(entry.type)
    values = [_element("simpleValue", value=value) for value in entry.initial[:1]]
    if entry.length:
        dimension = _element("dimension", lower="0", upper=str(entry.length - 1))
        kind = _element("array", dimension, _element("baseType", kind))
        runs = (_run(value, len(list(run))) for value, run in groupby(entry.initial))
        values = [_element("arrayValue", *runs)]
    parts = [_element("type", kind)]
    parts += [_element("initialValue", *values)] if entry.initial else []
    if entry.comment:
        parts.append(_element("documentation", _formatted([entry.comment], dialect)))
    return _element("variable", *parts, name=entry.name)


def _run(value: str, count: int) -> Element:
    repeated = {"repetitionValue": str(count)} if count > 1 else {}
    return _element("value", _element("simpleValue", value=value), **repeated)


def _formatted(lines: Sequence[str], dialect: Dialect) -> Element:
    """Return lines as a paragraph of XHTML, or as a whole document of it."""
    plain = dialect.declarations_as_text
    made = _element("xhtml", xmlns=XHTML) if plain else _element("xhtml:p")
    made.text = "\n".join(lines)
    return made


def _task(program: str, interval: str) -> Element:
    runs = _element("pouInstance", name=f"instance_of_{program}", typeName=program)
    task = _element("task", runs, name=TASK, priority="0", interval=interval)
    return _element("configuration", _element("resource", task, name=RESOURCE), name=CONFIGURATION)


def _element(tag: str, /, *inside: Element, **attributes: str) -> Element:
    made = Element(tag, attributes)
    made.extend(inside)
    return made
