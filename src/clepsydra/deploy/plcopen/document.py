"""Program organisation units as a PLCopen XML document."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from xml.etree import ElementTree

from clepsydra import __version__
from clepsydra.base.errors import InputError
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.pou import Section, Unit, Variable
from clepsydra.deploy.structured_text.pou_text import declaration_lines

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


@dataclass(frozen=True)
class Flavour:
    """What one family of editors wants of the document.

    Parameters
    ----------
    namespace : str
        Version of the schema.
    paragraph : bool
        Whether formatted text is a paragraph of XHTML, not a whole document of it.
    plain_declarations : bool
        Whether the declarations come as text too, with all of their comments.
    configuration : bool
        Whether the task comes with it; other editors make it in their device tree.

    Examples
    --------
    >>> flavour_of("matiec").namespace
    'http://www.plcopen.org/xml/tc6_0201'
    """

    namespace: str
    paragraph: bool
    plain_declarations: bool
    configuration: bool


_FLAVOURS = {
    "codesys": Flavour("http://www.plcopen.org/xml/tc6_0200", False, True, False),
    "matiec": Flavour("http://www.plcopen.org/xml/tc6_0201", True, False, True),
}


def flavour_of(dialect: str) -> Flavour:
    """Return what the editors of a dialect want.

    Raises
    ------
    InputError
        They read no PLCopen XML.

    Examples
    --------
    >>> flavour_of("codesys").namespace
    'http://www.plcopen.org/xml/tc6_0200'
    """
    if dialect not in _FLAVOURS:
        raise InputError(
            "PLCopen XML, dialect", dialect, f"one of {', '.join(_FLAVOURS)}",
            "TIA Portal reads no PLCopen XML: give it the SCL text as an external source",
        )  # fmt: skip
    return _FLAVOURS[dialect]


@dataclass(frozen=True)
class Task:
    """A cyclic task of a configuration.

    Examples
    --------
    >>> Task("Config0", "Res0", "sampling", "T#1s", "law_test").interval
    'T#1s'
    """

    configuration: str
    resource: str
    name: str
    interval: str
    program: str


def document(
    name: str, units: Sequence[Unit], dialect: Dialect, flavour: Flavour, task: Task | None
) -> str:
    """Return units as the text of a PLCopen XML document.

    Parameters
    ----------
    name : str
        Of the project.
    units : sequence of Unit
    dialect : Dialect
        That the units were made in.
    flavour : Flavour
    task : Task or None
        What runs the last unit.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> unit = Unit("PROGRAM", "main", ("Nothing yet.",), (), ())
    >>> text = document("empty", [unit], dialect_of("matiec"), flavour_of("matiec"), None)
    >>> text.splitlines()[1]
    '<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml">'
    """
    return _Document(dialect, flavour).text(name, units, task)


class _Document:
    def __init__(self, dialect: Dialect, flavour: Flavour) -> None:
        self._dialect, self._flavour = dialect, flavour

    def text(self, name: str, units: Sequence[Unit], task: Task | None) -> str:
        root = ElementTree.Element("project", {"xmlns": self._flavour.namespace})
        root.set("xmlns:xhtml", XHTML)
        header = {
            "companyName": "Clepsydra",
            "productName": "Clepsydra",
            "productVersion": __version__,
            "creationDateTime": _MOMENT,
        }
        _add(root, "fileHeader", **header)
        content = _add(root, "contentHeader", name=name, modificationDateTime=_MOMENT)
        coordinates = _add(content, "coordinateInfo")
        for language in ("fbd", "ld", "sfc"):
            _add(_add(coordinates, language), "scaling", x="1", y="1")
        types = _add(root, "types")
        _add(types, "dataTypes")
        units_at = _add(types, "pous")
        for unit in units:
            self._unit(units_at, unit)
        configurations = _add(_add(root, "instances"), "configurations")
        if task and self._flavour.configuration:
            self._task(configurations, task)
        ElementTree.indent(root)
        body = ElementTree.tostring(root, encoding="unicode")
        return f'<?xml version="1.0" encoding="utf-8"?>\n{body}\n'

    def _unit(self, parent: ElementTree.Element, unit: Unit) -> None:
        found = _add(parent, "pou", name=unit.name, pouType=_UNITS[unit.kind])
        interface = _add(found, "interface")
        if unit.result:
            _add(_add(interface, "returnType"), unit.result)
        for section in unit.sections:
            self._section(interface, section)
        self._formatted(_add(interface, "documentation"), "\n".join(unit.head))
        self._formatted(_add(_add(found, "body"), "ST"), "\n".join(unit.body))
        if self._flavour.plain_declarations:
            data = _add(
                _add(found, "addData"), "data", name=_PLAIN_TEXT, handleUnknown="implementation"
            )
            text = "\n".join(declaration_lines(unit, self._dialect))
            self._formatted(_add(data, "InterfaceAsPlainText"), text)

    def _section(self, parent: ElementTree.Element, section: Section) -> None:
        if not list(section.variables):
            return
        found = _add(parent, _VARIABLES[section.keyword])
        if section.qualifier:
            found.set(section.qualifier.lower(), "true")
        for entry in section.variables:
            self._variable(found, entry)

    def _variable(self, parent: ElementTree.Element, entry: Variable) -> None:
        found = _add(parent, "variable", name=entry.name)
        kind = _add(found, "type")
        if entry.is_array:
            array = _add(kind, "array")
            _add(array, "dimension", lower="0", upper=str(entry.length - 1))
            kind = _add(array, "baseType")
        if entry.is_block:
            _add(kind, "derived", name=entry.type)
        else:
            _add(kind, entry.type)
        if entry.initial:
            value = _add(found, "initialValue")
            if entry.is_array:
                _array_value(value, entry.initial)
            else:
                _add(value, "simpleValue", value=entry.initial[0])
        if entry.comment:
            self._formatted(_add(found, "documentation"), entry.comment)

    def _formatted(self, parent: ElementTree.Element, text: str) -> None:
        if self._flavour.paragraph:
            _add(parent, "xhtml:p").text = text
        else:
            _add(parent, "xhtml", xmlns=XHTML).text = text

    def _task(self, parent: ElementTree.Element, task: Task) -> None:
        configuration = _add(parent, "configuration", name=task.configuration)
        resource = _add(configuration, "resource", name=task.resource)
        found = _add(resource, "task", name=task.name, priority="0", interval=task.interval)
        _add(found, "pouInstance", name=f"instance_of_{task.program}", typeName=task.program)


def _array_value(parent: ElementTree.Element, values: Sequence[str]) -> None:
    array = _add(parent, "arrayValue")
    for value, run in groupby(values):
        count = len(list(run))
        repeated = {"repetitionValue": str(count)} if count > 1 else {}
        _add(_add(array, "value", **repeated), "simpleValue", value=value)


def _add(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, tag, attributes)
