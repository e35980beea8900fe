"""A controller made ready for a plant: what its block does before anything is wired to it."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from clepsydra.base.errors import InputError
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.export import export_structured_text
from clepsydra.deploy.exportable import exportable, exportable_name
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process
from clepsydra.study.designs import DESIGNS

NUMBERS = {"true": "1", "false": "0"}
CASES = [
    ("quadruple-tank", "PI, SIMC"),
    ("equalisation-tank", "PI, arrest time"),
    ("eight-tanks", "Smith predictor, LQ"),
    ("wet-well:start-stop", "Start/stop levels"),
    ("averaging-tank", "Fuzzy PI"),
]


@pytest.fixture(params=CASES, ids=lambda case: case[1])
def ready(request):
    process, name = request.param
    analysis = analyse(load_process(process))
    return exportable(DESIGNS[name](analysis), analysis.operating_point)


def test_a_block_that_nobody_wired_stands_in_manual_at_fail_safe_and_without_sensors(ready):
    inputs = {signal.name: signal.initial for signal in ready.program.inputs}
    values = {signal.name: signal.initial for signal in ready.program.parameters}
    at = ready.point.as_dict()
    assert inputs["time_step"] == 0.0
    for number in range(1, len(ready.controller.manipulated) + 1):
        assert inputs[f"mode_{number}"] == 0.0
        safe = values[f"fail_safe_{number}"]
        assert inputs[f"manual_{number}"] == inputs[f"tracking_{number}"] == safe
    for number in range(1, len(ready.controller.measurements) + 1):
        low, high = (values[f"range_{end}_{number}"] for end in ("low", "high"))
        current = 4.0 + 16.0 * (inputs[f"measurement_{number}"] - low) / (high - low)
        assert current < 3.6 and inputs[f"sensor_{number}"] == 0.0
    for number, name in enumerate(ready.controller.setpoints, start=1):
        assert inputs[f"setpoint_{number}"] == at[name]


def test_every_printer_declares_the_inputs_alike():
    """What stands in the texts, read by plain patterns, is what the signals say."""
    analysis = analyse(load_process("quadruple-tank"))
    ready = exportable(DESIGNS["PI, SIMC"](analysis), analysis.operating_point)
    expected = {signal.name: signal.initial for signal in ready.program.inputs}
    found = {}
    for dialect in DIALECT_NAMES:
        exported = export_structured_text(ready, dialect=dialect).files
        name = f"{ready.program.name}.{'scl' if dialect == 'scl' else 'st'}"
        declared = exported[name].decode().split("VAR_INPUT")[1].split("END_VAR")[0]
        found[dialect] = dict(re.findall(r"(\w+) : \w+ := ([-\w.]+);", declared))
    xml = ElementTree.fromstring(exported_xml(ready))
    tag = xml.tag.partition("}")[0] + "}"
    (block,) = [p for p in xml.iter(f"{tag}pou") if p.get("name") == ready.program.name]
    found["PLCopen"] = {
        variable.get("name"): next(variable.iter(f"{tag}simpleValue")).get("value")
        for variable in block.iter(f"{tag}variable")
        if variable.get("name") in expected
    }
    source = print_c(ready.program).source
    found["C"] = dict(re.findall(r"^  inputs->(\w+) = ([-\w.]+);", source, re.MULTILINE))
    model = controller_model(ready.program, ready.origin)
    found["FMU"] = {name: str(model.variable(name).signal.initial) for name in expected}
    for printer, texts in found.items():
        values = {name: NUMBERS.get(texts[name].lower(), texts[name]) for name in expected}
        assert {name: float(value) for name, value in values.items()} == expected, printer


def exported_xml(ready) -> bytes:
    files = export_structured_text(ready, dialect="codesys").files
    return files[f"{ready.program.name}_test.xml"]


def test_its_outputs_begin_where_its_state_says(ready):
    outputs = {signal.name: signal.initial for signal in ready.program.outputs}
    state = {entry.name: entry for entry in ready.program.state}
    for number in range(1, len(ready.controller.manipulated) + 1):
        assert outputs[f"manipulated_{number}"] == state[f"last_output_{number}"].initial


def test_every_number_has_a_source(ready):
    for entry in (*ready.program.parameters, *ready.program.state):
        assert ready.origin.source_of(entry)


def test_a_name_of_which_no_letter_is_left_is_refused(ready):

    with pytest.raises(InputError, match="a name with a letter"):
        exportable_name(ready.process, replace(ready.controller, name="泵"))
