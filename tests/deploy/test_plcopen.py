"""PLCopen XML: what comes back from it is what was printed."""

import dataclasses
import re
from xml.etree import ElementTree

import pytest
from plants import designed, plant
from refusals import refused
from structured_text_programs import every_kind, plcopen_of

from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.deploy.plcopen.printer import (
    XHTML,
    namespace_of,
    print_plcopen_project,
)
from clepsydra.deploy.printing.declarations import Variable
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.pou import Section, Unit
from clepsydra.deploy.structured_text.printer import function_blocks, print_structured_text
from clepsydra.deploy.structured_text.project import Project, print_test_project

ORIGIN = Origin('Law <1> & "2"', "a tank", "By hand.", 1.0, {"late": "at rest"}, "found by hand")
KINDS = {"functionBlock": "FUNCTION_BLOCK", "function": "FUNCTION", "program": "PROGRAM"}
SECTIONS = {"inputVars": "VAR_INPUT", "outputVars": "VAR_OUTPUT", "localVars": "VAR",
            "tempVars": "VAR_TEMP"}  # fmt: skip
ELEMENTARY = ["BOOL", "DINT", "REAL", "LREAL"]


def read(text: str, dialect: str) -> tuple[ElementTree.Element, str]:
    namespace = namespace_of(dialect)
    return ElementTree.fromstring(text), f"{{{namespace}}}"


def formatted(element: ElementTree.Element, namespace: str, path: str) -> str:
    found = element.find("/".join(f"{namespace}{step}" for step in path.split("/")))
    if found is None:
        return ""
    (inside,) = found
    assert inside.tag in (f"{{{XHTML}}}p", f"{{{XHTML}}}xhtml")
    return inside.text or ""


def variable_of(element: ElementTree.Element, namespace: str) -> Variable:
    (kind,) = element.find(f"{namespace}type")
    length = 0
    if kind.tag == f"{namespace}array":
        dimension, base = kind
        assert dimension.get("lower") == "0"
        length = int(dimension.get("upper")) + 1
        (kind,) = base
    is_block = kind.tag == f"{namespace}derived"
    initial: list[str] = []
    value = element.find(f"{namespace}initialValue")
    if value is not None:
        (value,) = value
        if length:
            for entry in value:
                (simple,) = entry
                initial += [simple.get("value")] * int(entry.get("repetitionValue", "1"))
        else:
            initial.append(value.get("value"))
    name = kind.get("name") if is_block else kind.tag.removeprefix(namespace)
    assert is_block or name in ELEMENTARY
    comment = formatted(element, namespace, "documentation")
    return Variable(element.get("name"), name, tuple(initial), length, comment, is_block)


def unit_of(element: ElementTree.Element, namespace: str) -> Unit:
    """Read a unit back; the titles of groups are in no document."""
    sections = []
    for child in element.find(f"{namespace}interface"):
        tag = child.tag.removeprefix(namespace)
        if tag in SECTIONS:
            qualifier = "".join(q.upper() for q in ("retain", "constant") if child.get(q) == "true")
            entries = tuple(variable_of(entry, namespace) for entry in child)
            sections.append(Section(SECTIONS[tag], qualifier, (("", entries),)))
    kind = KINDS[element.get("pouType")]
    result = element.find(f"{namespace}interface/{namespace}returnType")
    head = formatted(element, namespace, "interface/documentation").split("\n")
    body = formatted(element, namespace, "body/ST").split("\n")
    return Unit(kind, element.get("name"), tuple(head), tuple(sections), tuple(body),
                "" if result is None else result[0].tag.removeprefix(namespace))  # fmt: skip


def without_titles(unit: Unit) -> Unit:
    sections = [
        Section(section.keyword, section.qualifier, (("", tuple(section.variables)),))
        for section in unit.sections
        if list(section.variables)
    ]
    return dataclasses.replace(unit, sections=tuple(sections))


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("dialect", ["codesys", "matiec"])
def test_a_block_comes_back_as_it_was_printed(dialect, precision):
    text = plcopen_of(every_kind(), origin=ORIGIN, dialect=dialect, precision=precision)
    root, namespace = read(text, dialect)
    printed = function_blocks(every_kind(), dialect_of(dialect), precision, ORIGIN)
    assert [unit.name for unit in printed] == ["FC_Min", "FC_Floor", "every_kind"]
    found = [unit_of(element, namespace) for element in root.iter(f"{namespace}pou")]
    assert found == list(map(without_titles, printed))
    assert text.startswith('<?xml version="1.0" encoding="utf-8"?>\n<project xmlns="http://www.plc')


def test_the_text_of_the_block_is_in_the_document():
    """Declarations with comments and statements are those of the Structured Text."""
    text = print_structured_text(every_kind(), origin=ORIGIN)
    root, namespace = read(plcopen_of(every_kind(), origin=ORIGIN), "codesys")
    *_, element = root.iter(f"{namespace}pou")
    declared = formatted(element, namespace, "addData/data/InterfaceAsPlainText")
    body = formatted(element, namespace, "body/ST")
    # The text begins with the head of the block, before the functions.
    assert text.endswith(f"{declared.partition(' *)')[2]}\n{body}\nEND_FUNCTION_BLOCK\n")


def test_the_order_of_the_schema():
    """What TC6 demands of the order of elements, and of the attributes."""
    for dialect in ("codesys", "matiec"):
        root, namespace = read(plcopen_of(every_kind(), dialect=dialect), dialect)

        def children(element, namespace=namespace):
            return [child.tag.removeprefix(namespace) for child in element]

        assert children(root) == ["fileHeader", "contentHeader", "types", "instances"]
        header = root.find(f"{namespace}fileHeader")
        required = {"companyName", "productName", "productVersion", "creationDateTime"}
        assert required <= set(header.keys())
        for unit in root.iter(f"{namespace}pou"):
            order = ["interface", "actions", "transitions", "body", "addData", "documentation"]
            assert sorted(children(unit), key=order.index) == children(unit)
            inside = children(unit.find(f"{namespace}interface"))
            expected = set(SECTIONS)
            if unit.get("pouType") == "function":
                assert inside[0] == "returnType"
                expected = {"returnType", "inputVars"}
            assert inside[-1] == "documentation" and set(inside[:-1]) == expected
        for variable in root.iter(f"{namespace}variable"):
            order = ["type", "initialValue", "documentation"]
            assert sorted(children(variable), key=order.index) == children(variable)


@pytest.mark.parametrize("dialect", ["codesys", "matiec"])
def test_the_test_project(dialect):
    controller = with_plant_shell(designed("simc", "quadruple-tank"), 1.0)
    arguments = (
        dataclasses.replace(controller.program(), name="tank_pi"),
        process_program(plant("quadruple-tank").point, 1),
        controller.input_wires | controller.output_wires,
        0.5,
    )
    project = Project(*arguments, origin=ORIGIN, dialect=dialect)
    text = print_plcopen_project(project)
    assert text == print_plcopen_project(dataclasses.replace(project))
    root, namespace = read(text, dialect)
    units = [unit_of(element, namespace) for element in root.iter(f"{namespace}pou")]
    library, units = units[:-3], units[-3:]
    assert "FB_SignalCheck" in [unit.name for unit in library]
    assert [unit.name for unit in units] == ["tank_pi", "quadruple_tank", "tank_pi_test"]
    instances = [v for section in units[2].sections for v in section.variables if v.is_block]
    assert [(v.name, v.type) for v in instances] == [
        ("controller", "tank_pi"), ("plant", "quadruple_tank"),
        ("pump_1_conditions", "ST_OutputConditions"),
        ("pump_2_conditions", "ST_OutputConditions"),
        ("level_1_faceplate", "ST_FaceplatePI"),
        ("level_2_faceplate", "ST_FaceplatePI")]  # fmt: skip
    in_text = print_test_project(project)
    for unit in units:
        assert "\n".join(unit.body) in in_text
    tasks = [task.attrib for task in root.iter(f"{namespace}task")]
    if dialect == "matiec":
        assert tasks == [{"name": "sampling", "priority": "0", "interval": "T#500ms"}]
        (instance,) = root.iter(f"{namespace}pouInstance")
        assert instance.get("typeName") == "tank_pi_test"
        assert re.search(r'<configuration name="Config0">\s*<resource name="Res0">', text)
    else:
        assert not tasks


def test_tia_portal_reads_none():
    with refused(remedy="TIA Portal reads no PLCopen XML"):
        plcopen_of(every_kind(), dialect="scl")
